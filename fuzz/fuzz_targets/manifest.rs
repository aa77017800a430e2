#![no_main]
//! See `bitgrain_tests::fuzzing::manifest`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    bitgrain_tests::fuzzing::manifest(data);
});
