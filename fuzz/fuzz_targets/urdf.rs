//! Robots: `targets::urdf`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| testbed_fuzz::targets::urdf(bytes));
