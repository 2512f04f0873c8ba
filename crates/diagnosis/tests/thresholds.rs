//! The thresholds that can be varied decide on names.

mod support;

use diagnosis::Options;
use support::{Motion, SHOULDER, baseline_friction, diagnosed_with, named, trio};

/// A spring that has its name by default has none where it must bring more evidence over a constant torque than there is.
#[test]
fn a_name_needs_the_evidence_that_the_thresholds_ask_for() {
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] += 9.0 * (motion.q[SHOULDER] + 1.5);
    };
    let is_named = |factor: f64| {
        let mut options = Options::default();
        options.thresholds.least_beyond *= factor;
        let diagnosis = diagnosed_with(&trio(), &trio(), &concealed, &options).expect("it can be diagnosed");
        named(&diagnosis).contains(&("spring", Some("shoulder")))
    };
    assert!(is_named(1.0));
    assert!(!is_named(1e4));
}
