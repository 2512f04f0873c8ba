//! What each of the thresholds that can be varied decides: moved far enough, it takes a name from an effect that has one with its
//! default, or the dependence from an unexplained residual.

use crate::support::{ELBOW, Motion, SHOULDER, baseline_friction, diagnosed_with, trio};
use diagnosis::{Options, Report, Thresholds};

/// A spring on the shoulder.
fn spring(motion: &mut Motion, tau: &mut [f64]) {
    baseline_friction(motion, tau);
    tau[SHOULDER] += 9.0 * (motion.q[SHOULDER] + 1.5);
}

/// A small ripple beside the spring.
fn spring_and_ripple(motion: &mut Motion, tau: &mut [f64]) {
    spring(motion, tau);
    tau[SHOULDER] += 0.6 * (17.0 * motion.q[SHOULDER]).sin();
}

/// A small ripple beside a wrong torque constant, an effect of certain form.
fn scale_and_ripple(motion: &mut Motion, tau: &mut [f64]) {
    baseline_friction(motion, tau);
    tau[SHOULDER] *= 1.3;
    tau[SHOULDER] += 0.8 * (13.0 * motion.q[SHOULDER]).sin();
}

/// A constant torque from the middle of the second recording on.
fn onset(motion: &mut Motion, tau: &mut [f64]) {
    baseline_friction(motion, tau);
    if motion.clock >= 1006.0 {
        tau[ELBOW] += 1.5;
    }
}

/// A spring between the elbow's drive and its link, whose coefficient is one at the right stiffness.
fn elastic(motion: &mut Motion, tau: &mut [f64]) {
    motion.q[ELBOW] += tau[ELBOW] / 250.0;
    baseline_friction(motion, tau);
}

/// Viscous friction that grows with the position, which is no effect of the catalogue.
fn unmodelled(motion: &mut Motion, tau: &mut [f64]) {
    baseline_friction(motion, tau);
    tau[ELBOW] += 3.0 * motion.q[ELBOW] * motion.qd[ELBOW];
}

/// A ripple beside it.
fn unmodelled_and_ripple(motion: &mut Motion, tau: &mut [f64]) {
    unmodelled(motion, tau);
    tau[ELBOW] += 2.0 * (17.0 * motion.q[ELBOW]).sin();
}

/// A field, the factor on it, what is injected, and the name or the dependence that is lost with that factor.
type Row = (&'static str, f64, fn(&mut Motion, &mut [f64]), (&'static str, &'static str));

/// One row for each field. Factors are a tenth, ten or a thousand: it is shown that the field decides, and not where its edge is.
const ROWS: [Row; 14] = [
    ("tolerance", 10.0, elastic, ("joint_elasticity", "elbow")),
    ("per_coefficient", 10.0, unmodelled, ("own_position_times_speed", "elbow")),
    ("per_onset", 1e3, onset, ("torque_offset", "elbow")),
    ("unit_spread", 0.1, elastic, ("joint_elasticity", "elbow")),
    ("predicted", 1e3, unmodelled, ("own_position_times_speed", "elbow")),
    ("held_out", 10.0, unmodelled, ("own_position_times_speed", "elbow")),
    ("least_share", 10.0, spring_and_ripple, ("torque_ripple", "shoulder")),
    ("least_evidence", 1e3, spring_and_ripple, ("torque_ripple", "shoulder")),
    ("least_beyond", 1e3, spring, ("spring", "shoulder")),
    ("beside_a_larger", 10.0, spring_and_ripple, ("torque_ripple", "shoulder")),
    ("beside_a_certain", 1e3, scale_and_ripple, ("torque_ripple", "shoulder")),
    ("least_unmodelled_share", 1e3, unmodelled, ("own_position_times_speed", "elbow")),
    ("least_unmodelled_evidence", 1e3, unmodelled, ("own_position_times_speed", "elbow")),
    ("beside_unmodelled", 1e3, unmodelled_and_ripple, ("torque_ripple", "elbow")),
];

/// Whether a report has a finding, or an unexplained residual that depends on something, on a joint.
fn has(report: &Report, (what, joint): (&str, &str)) -> bool {
    let mut findings = report.findings.iter();
    let mut unexplained = report.unexplained.iter();
    findings.any(|finding| finding.effect == what && finding.joint.as_deref() == Some(joint))
        || unexplained.any(|open| open.joint == joint && open.depends_on.iter().any(|on| on.to_string() == what))
}

#[test]
fn each_threshold_decides_on_a_name() {
    let fields: Vec<&str> = ROWS.iter().map(|row| row.0).collect();
    assert_eq!(fields, Thresholds::NAMES, "one row for each field");
    for (field, factor, injected, what) in ROWS {
        let report = |factor: f64| {
            let mut options = Options::default();
            *options.thresholds.named(field).expect("it is a field") *= factor;
            let diagnosis = diagnosed_with(&trio(), &trio(), &injected, &options);
            diagnosis.expect("it can be diagnosed").report
        };
        assert!(has(&report(1.0), what), "{field}: {what:?} is there by default");
        assert!(!has(&report(factor), what), "{field} × {factor}: {what:?} is still there");
    }
}
