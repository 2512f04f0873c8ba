//! The thresholds that can be varied decide on names.

mod support;

use diagnosis::Options;
use support::{Motion, SHOULDER, baseline_friction, diagnosed_with, named, trio};

/// A spring that is named by default is not named if it must bring more evidence beyond a constant torque than there is.
#[test]
fn a_name_needs_the_evidence_of_the_thresholds() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] += 9.0 * (motion.q[SHOULDER] + 1.5);
    };
    let is_named = |factor: f64| {
        let mut options = Options::default();
        options.thresholds.least_beyond *= factor;
        let diagnosis = diagnosed_with(&trio(), &trio(), &injected, &options).expect("it can be diagnosed");
        named(&diagnosis).contains(&("spring", Some("shoulder")))
    };
    assert!(is_named(1.0));
    assert!(!is_named(1e4));
}
