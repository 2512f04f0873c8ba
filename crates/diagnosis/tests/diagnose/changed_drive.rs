//! Inertias of drives that changed, of which bodies may be the cause.

use std::f64::consts::TAU;

use crate::changes::{is_after, with};
use crate::support::{ELBOW, Motion, SHOULDER, baseline_friction, sentences};
use diagnosis::Finding;

/// Torques that no effect of the catalogue explains: several sines, with other phases in each recording.
fn unexplained(motion: &Motion, size: f64) -> f64 {
    let sine = |hertz: f64| (TAU * hertz * motion.time + 1e-3 * hertz * motion.clock).sin();
    size * [1.31, 1.97, 2.63, 3.37].into_iter().map(sine).sum::<f64>()
}

/// A body on the link has the same torque on its joint. Only the shoulder tells, and most of its torque may be unexplained.
#[test]
fn an_inertia_of_a_drive_that_changed_needs_the_joints_before_it() {
    for (size, is_named) in [(0.0, true), (3.0, false)] {
        let diagnosis = with(&|motion, tau| {
            baseline_friction(motion, tau);
            if is_after(motion) {
                tau[ELBOW] += 0.15 * motion.qdd[ELBOW];
            }
            tau[SHOULDER] += unexplained(motion, size);
        });
        let is_it = |finding: &Finding| {
            (finding.effect, finding.joint.as_deref()) == ("rotor_inertia", Some("elbow")) && finding.change.is_some()
        };
        assert_eq!(diagnosis.report.findings.iter().any(is_it), is_named, "{:?}", sentences(&diagnosis));
        let refused = diagnosis.trace.iter().any(|row| row.rule.starts_with("a body on its link explains as much"));
        assert_eq!(refused, !is_named);
    }
}
