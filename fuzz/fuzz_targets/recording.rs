#![no_main]
//! See `bitgrain_tests::fuzzing::recording`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    bitgrain_tests::fuzzing::recording(data);
});
