#![no_main]
//! See `bitgrain_tests::fuzzing::summary`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    bitgrain_tests::fuzzing::summary(data);
});
