//! Friction curves as drives have them: neither their form nor their change between recordings is another effect.

mod support;

use support::{Motion, baseline_friction, diagnosed, sentences, trio};

/// Friction that only reaches its level at some speed is not larger at standstill.
#[test]
fn friction_that_grows_gradually_is_no_stribeck_friction() {
    for (reached, level) in [(0.2, 0.5), (0.3, 1.0), (0.4, 0.5)] {
        // Linear up to the speed at which it slides.
        let concealed = |motion: &mut Motion, tau: &mut [f64]| {
            for (tau, &speed) in tau.iter_mut().zip(&motion.qd) {
                *tau += level * (speed / reached).clamp(-1.0, 1.0) + 0.15 * level * speed;
            }
        };
        let diagnosis = diagnosed(&trio(), &trio(), &concealed, Vec::new());
        let is_stribeck = |finding: &diagnosis::Finding| finding.effect == "stribeck_friction";
        assert!(
            !diagnosis.report.findings.iter().any(is_stribeck),
            "{reached} rad/s: {:?}",
            sentences(&diagnosis)
        );
    }
}

/// Friction that is larger throughout the held-out recording is no burst in it.
#[test]
fn more_friction_in_the_held_out_recording_is_no_burst() {
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        if motion.clock >= support::start(2) {
            for (tau, &speed) in tau.iter_mut().zip(&motion.qd) {
                *tau += 0.1 * (0.6 * speed.signum() + 0.4 * speed * speed.abs());
            }
        }
    };
    let diagnosis = diagnosed(&trio(), &trio(), &concealed, Vec::new());
    let left = &diagnosis.report.unexplained;
    assert!(left.iter().all(|left| left.time.is_empty()), "{left:?}");
}
