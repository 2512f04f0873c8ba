//! Each effect of the catalogue, injected alone beside small friction, is named on its joint with its size, and no other
//! effect is named.

use std::collections::BTreeSet;

use crate::support::{
    ELBOW, Injected, Motion, SHOULDER, baseline_friction, delayed_on, diagnosed, exports_what_it_reports, sentences,
    trio,
};
use arm::{Arm, Vector3};
use diagnosis::{Diagnosis, Verdict};

/// Checks that `effect` on `joint` is the only finding beside plain friction, with parameters within the relative
/// `tolerance` of the truth.
fn check(
    robot: &Arm,
    injected: Injected<'_>,
    effect: &str,
    joint: Option<&str>,
    truth: &[(&str, f64)],
    tolerance: f64,
) -> Diagnosis {
    let diagnosis = diagnosed(&trio(), robot, injected, Vec::new());
    let report = &diagnosis.report;
    let plain = ["viscous_friction", "coulomb_friction"];
    let special: Vec<_> = report
        .findings
        .iter()
        .filter(|finding| !plain.contains(&finding.effect) || finding.effect == effect)
        .map(|finding| (finding.effect, finding.joint.as_deref()))
        .collect();
    assert_eq!(special, [(effect, joint)], "{:?} {:#?}", sentences(&diagnosis), report.unexplained);
    assert_eq!(report.verdict, Verdict::Explained, "{:?}", report.unexplained);
    let finding = report.findings.iter().find(|finding| finding.effect == effect).expect("it is there");
    for (name, truth) in truth {
        let found = finding.parameters[name];
        assert!((found.value / truth - 1.0).abs() < tolerance, "{name}: {found:?} instead of {truth}");
    }
    assert!(finding.held_out_gain.is_some_and(|gain| gain > 0.05), "{:?}", finding.held_out_gain);
    // With the findings as known effects, nothing is found.
    let again = diagnosed(&trio(), robot, injected, diagnosis.effects.clone());
    assert!(again.report.findings.is_empty(), "known: {:?}", sentences(&again));
    for (joint, fit) in &again.report.fit {
        assert_eq!(fit.torque_std, report.fit[joint].torque_std, "errors are over the measured torque");
    }
    exports_what_it_reports(&diagnosis, &again, 0.4);
    for (joint, fit) in &report.fit {
        let (nominal, augmented) = (fit.held_out_nrmse_nominal, fit.held_out_nrmse_augmented);
        assert!(augmented < nominal, "{joint}: {nominal:?} → {augmented:?}");
    }
    diagnosis
}

/// Beside a torque scale, friction and the other effects on the joint are stated in true newton metres, which the scale
/// multiplies.
#[test]
fn a_torque_scale_multiplies_the_friction_beside_it() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[ELBOW] += 1.5 * motion.qd[ELBOW].signum() + 1.1 * motion.qd[ELBOW];
        tau[ELBOW] *= 1.3;
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    let parameter = |effect: &str, name: &str| {
        let is_wanted = |f: &&diagnosis::Finding| f.effect == effect && f.joint.as_deref() == Some("elbow");
        let finding = diagnosis.report.findings.iter().find(is_wanted);
        finding.unwrap_or_else(|| panic!("{:?}", sentences(&diagnosis))).parameters[name].value
    };
    let is_near = |found: f64, truth: f64| assert!((found / truth - 1.0).abs() < 0.05, "{found} instead of {truth}");
    is_near(parameter("torque_scale", "factor"), 1.3);
    is_near(parameter("coulomb_friction", "level"), 2.1);
    is_near(parameter("viscous_friction", "coefficient"), 1.5);
    let again = diagnosed(&trio(), &trio(), &injected, diagnosis.effects.clone());
    exports_what_it_reports(&diagnosis, &again, 0.4);
}

/// An effect that adds a torque to one joint.
fn added(effect: &str, joint: usize, torque: impl Fn(&Motion) -> f64, truth: &[(&str, f64)], tolerance: f64) {
    let arm = trio();
    let name = arm.joints()[joint].name.clone();
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[joint] += torque(motion);
    };
    check(&arm, &injected, effect, Some(&name), truth, tolerance);
}

#[test]
fn quadratic_drag() {
    added("quadratic_drag", ELBOW, |m| 1.2 * m.qd[ELBOW] * m.qd[ELBOW].abs(), &[("coefficient", 1.2)], 0.05);
}

#[test]
fn rotor_inertia() {
    added("rotor_inertia", ELBOW, |m| 0.3 * m.qdd[ELBOW], &[("inertia", 0.3)], 0.05);
}

#[test]
fn torque_offset() {
    added("torque_offset", ELBOW, |_| 1.5, &[("offset", 1.5)], 0.05);
}

#[test]
fn torque_ripple() {
    let ripple = |m: &Motion| 1.2 * (17.0 * m.q[ELBOW] + 0.6).sin();
    added("torque_ripple", ELBOW, ripple, &[("amplitude", 1.2), ("periods", 17.0)], 0.05);
}

#[test]
fn friction_asymmetry() {
    let law = |m: &Motion| if m.qd[ELBOW] > 0.0 { 3.0 } else { -1.0 };
    added("friction_asymmetry", ELBOW, law, &[("positive", 3.6), ("negative", 1.6)], 0.05);
}

#[test]
fn stribeck_friction() {
    let law = |m: &Motion| 3.0 * (-(m.qd[ELBOW] / 0.12).powi(2)).exp() * m.qd[ELBOW].signum();
    added("stribeck_friction", ELBOW, law, &[("coulomb", 0.6), ("velocity", 0.12)], 0.25);
}

#[test]
fn spring() {
    let law = |m: &Motion| 9.0 * (m.q[SHOULDER] - 0.3);
    added("spring", SHOULDER, law, &[("stiffness", 9.0), ("rest", 0.3)], 0.06);
}

#[test]
fn load_dependent_friction() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        let load = tau[SHOULDER].abs();
        baseline_friction(motion, tau);
        tau[SHOULDER] += 0.15 * load * motion.qd[SHOULDER].signum();
    };
    check(&trio(), &injected, "load_dependent_friction", Some("shoulder"), &[("gain", 0.15)], 0.06);
}

/// Gears that turn the elbow's drive and another's together act on both.
fn coupled(other: usize) {
    let injected = move |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[ELBOW] += 1.1 * motion.qd[other] + 0.12 * motion.qdd[other];
        tau[other] += 1.1 * motion.qd[ELBOW] + 0.12 * motion.qdd[ELBOW];
    };
    let truth = [("viscous", 1.1), ("inertia", 0.12)];
    check(&trio(), &injected, "transmission_coupling", Some("elbow"), &truth, 0.1);
}

#[test]
fn transmission_coupling() {
    coupled(SHOULDER);
}

#[test]
fn transmission_coupling_of_joints_one_apart() {
    coupled(0);
}

#[test]
fn torque_scale() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] *= 1.15;
    };
    check(&trio(), &injected, "torque_scale", Some("shoulder"), &[("factor", 1.15)], 0.03);
}

#[test]
fn actuation_delay() {
    check(&trio(), &delayed_on(SHOULDER, 0.012, 0.0), "actuation_delay", Some("shoulder"), &[], 0.0);
}

#[test]
fn actuation_delay_has_its_size() {
    for delay in [0.006, 0.012] {
        let truth = [("delay", delay)];
        check(&trio(), &delayed_on(SHOULDER, delay, 0.0), "actuation_delay", Some("shoulder"), &truth, 0.1);
    }
}

#[test]
fn encoder_offset() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        motion.q[ELBOW] += 0.06;
    };
    check(&trio(), &injected, "encoder_offset", Some("elbow"), &[("offset", 0.06)], 0.1);
}

#[test]
fn link_inertial_error() {
    let robot = trio().with_scaled_link(SHOULDER, 1.2);
    check(
        &robot,
        &|m, tau| baseline_friction(m, tau),
        "link_inertial_error",
        Some("shoulder"),
        &[("relative", 0.2)],
        0.1,
    );
}

#[test]
fn gravity_misalignment() {
    let robot = trio().with_turned_base(Vector3::new(1.0, 0.0, 0.0), 0.08);
    check(&robot, &|m, tau| baseline_friction(m, tau), "gravity_misalignment", None, &[("angle", 0.08)], 0.1);
}

#[test]
fn joint_elasticity() {
    // The link follows the motion. The drive, whose position the encoder reports, leads by the spring's deflection.
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        motion.q[ELBOW] += tau[ELBOW] / 250.0;
        baseline_friction(motion, tau);
    };
    let diagnosis = check(&trio(), &injected, "joint_elasticity", Some("elbow"), &[("stiffness", 250.0)], 0.15);
    // The spring has no damping: what the fit gives it is an upper bound.
    let is_spring = |finding: &&diagnosis::Finding| finding.effect == "joint_elasticity";
    let mut springs = diagnosis.report.findings.iter().filter(is_spring);
    let damping = springs.next().expect("it is named").parameters["damping"];
    assert_eq!(damping.ci95[0], 0.0, "{damping:?}");
}

/// A drive that turns with two joints loads the elastic gear of one of them, whose links' motion it also feels.
#[test]
fn an_elastic_joint_carries_the_coupling_with_its_link() {
    let (viscous, inertia) = (1.0, 0.3);
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        for (joint, other) in [(SHOULDER, ELBOW), (ELBOW, SHOULDER)] {
            tau[joint] += viscous * motion.qd[other] + inertia * motion.qdd[other];
        }
        motion.q[ELBOW] += tau[ELBOW] / 120.0;
        baseline_friction(motion, tau);
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    let others = ["viscous_friction", "coulomb_friction", "rotor_inertia"];
    let findings: Vec<_> = diagnosis.report.findings.iter().filter(|f| !others.contains(&f.effect)).collect();
    let named: BTreeSet<_> = findings.iter().map(|f| (f.effect, f.joint.as_deref())).collect();
    let expected = BTreeSet::from([("joint_elasticity", Some("elbow")), ("transmission_coupling", Some("elbow"))]);
    assert_eq!(named, expected, "{:?}", sentences(&diagnosis));
    for (effect, parameter, truth) in [
        ("joint_elasticity", "stiffness", 120.0),
        ("transmission_coupling", "viscous", viscous),
        ("transmission_coupling", "inertia", inertia),
    ] {
        let found = findings.iter().find(|f| f.effect == effect).expect("it is named").parameters[parameter];
        assert!((found.value / truth - 1.0).abs() < 0.1, "{effect}: {parameter} {found:?} instead of {truth}");
    }
}

#[test]
fn plain_friction_on_every_joint_and_nothing_else() {
    let diagnosis = diagnosed(&trio(), &trio(), &|m, tau| baseline_friction(m, tau), Vec::new());
    let report = &diagnosis.report;
    assert_eq!(report.findings.len(), 6, "{:?}", sentences(&diagnosis));
    for finding in &report.findings {
        let (parameter, truth) = match finding.effect {
            "coulomb_friction" => ("level", 0.6),
            _ => ("coefficient", 0.4),
        };
        let [low, high] = finding.parameters[parameter].ci95;
        assert!(low < truth && truth < high, "{}", finding.sentence);
    }
    assert_eq!(report.verdict, Verdict::Explained);
}

/// A dead channel is omitted and does not affect the other joints.
#[test]
fn a_dead_channel_is_omitted() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[ELBOW] = 0.3;
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    let report = &diagnosis.report;
    for finding in &report.findings {
        assert_ne!(finding.joint.as_deref(), Some("elbow"), "{}", finding.sentence);
        assert!(finding.share < 1.0, "{}", finding.sentence);
    }
    assert!(!report.fit.contains_key("elbow"), "{:?}", report.fit["elbow"]);
    let not_diagnosed: Vec<_> = report.not_diagnosed.iter().map(|group| &group.joints[..]).collect();
    assert_eq!(not_diagnosed, [["elbow"]]);
    assert!(report.fit["turn"].held_out_nrmse_augmented.is_some_and(|error| error < 0.03));
}

/// Torques that do not depend on the motion are not named.
#[test]
fn unrelated_torques_are_not_named() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        for (joint, tau) in tau.iter_mut().enumerate() {
            // A hash of the time, which neither the model nor the catalogue explains.
            let phase = (motion.time * 1e4 + joint as f64 * 0.37).sin() * 43_758.545_3;
            *tau = 8.0 * (phase - phase.floor() - 0.5);
        }
    };
    let report = diagnosed(&trio(), &trio(), &injected, Vec::new()).report;
    let named: Vec<&str> = report.findings.iter().map(|finding| finding.sentence.as_str()).collect();
    assert!(named.is_empty(), "{named:?}");
    assert_eq!(report.verdict, Verdict::Unexplained);
}
