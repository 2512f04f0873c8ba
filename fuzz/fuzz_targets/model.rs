//! Corrected models (effects as TOML): `targets::model`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| testbed_fuzz::targets::model(bytes));
