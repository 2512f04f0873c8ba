//! Column maps, and a file that they describe: `targets::column_map`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| testbed_fuzz::targets::column_map(bytes));
