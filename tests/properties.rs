//! How many random cases the tests of properties draw, and from which seed: the same for every crate.

use proptest::prelude::ProptestConfig;
use proptest::test_runner::RngSeed;

/// As many cases as a few seconds take in an unoptimised test, and the same ones each time.
pub fn config() -> ProptestConfig {
    let asked = ProptestConfig::default();
    ProptestConfig {
        cases: if std::env::var_os("PROPTEST_CASES").is_some() { asked.cases } else { 64 },
        rng_seed: match asked.rng_seed {
            RngSeed::Random => RngSeed::Fixed(1),
            seed => seed,
        },
        failure_persistence: None,
        ..asked
    }
}
