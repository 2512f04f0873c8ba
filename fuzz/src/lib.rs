//! What is done with bytes that nobody vouches for. `tests/untrusted` replays the corpus through the same functions without a nightly
//! toolchain.

pub mod targets;
