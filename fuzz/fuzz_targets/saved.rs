#![no_main]
//! See `bitgrain_tests::fuzzing::saved`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    bitgrain_tests::fuzzing::saved(data);
});
