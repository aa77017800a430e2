#![no_main]
//! See `bitgrain_tests::fuzzing::scenario`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    bitgrain_tests::fuzzing::scenario(data);
});
