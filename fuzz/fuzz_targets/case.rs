#![no_main]
//! See `bitgrain_tests::fuzzing::case`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    bitgrain_tests::fuzzing::case(data);
});
