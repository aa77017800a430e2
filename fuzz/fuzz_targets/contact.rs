#![no_main]
//! See `bitgrain_tests::fuzzing::contact`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    bitgrain_tests::fuzzing::contact(data);
});
