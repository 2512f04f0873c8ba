//! Files of any format of recordings, by their content: `targets::recording`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    testbed_fuzz::forgive_parquet();
    testbed_fuzz::targets::recording(bytes);
});
