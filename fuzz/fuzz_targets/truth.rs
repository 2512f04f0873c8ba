//! Ground truths (JSON): `targets::truth`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| testbed_fuzz::targets::truth(bytes));
