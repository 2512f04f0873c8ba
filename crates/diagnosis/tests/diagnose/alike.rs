//! What resembles an effect of the catalogue most keeps its own name, and is not taken for that effect.

use crate::support::{ELBOW, Injected, Motion, SHOULDER, baseline_friction, diagnosed, named, sentences, trio};
use arm::{Arm, Vector3};
use diagnosis::Dependence;
use effects::Regressor;

/// Checks that the findings beside plain friction on recordings of `robot` are `expected`; `None` is the whole arm. Returns what every
/// unexplained residual depends on, with its joint.
fn check(robot: &Arm, injected: Injected<'_>, expected: &[(&str, Option<&str>)]) -> Vec<(String, Vec<Dependence>)> {
    let diagnosis = diagnosed(&trio(), robot, injected, Vec::new());
    assert_eq!(named(&diagnosis), expected, "{:?}", sentences(&diagnosis));
    let unexplained = diagnosis.report.unexplained.into_iter();
    unexplained.map(|open| (open.joint, open.depends_on)).collect()
}

/// A torque that repeats in time does not repeat with the joint's angle.
#[test]
fn an_oscillation_in_time_is_not_a_torque_ripple() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[ELBOW] += (14.0 * motion.clock).sin();
    };
    let open = check(&trio(), &injected, &[]);
    assert_eq!(open, [("elbow".to_owned(), vec![Regressor::Time.into()])]);
}

/// A delay is a part of the torque's derivative, to which viscous friction and a rotor's inertia also contribute.
#[test]
fn a_rotor_and_viscous_friction_are_not_a_delay() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] += 3.0 * motion.qd[SHOULDER] + 0.5 * motion.qdd[SHOULDER];
    };
    let open = check(&trio(), &injected, &[("rotor_inertia", Some("shoulder"))]);
    assert!(open.is_empty(), "{open:?}");
}

/// Friction of two drives, each of its own speed, is not that of gears that turn them together.
#[test]
fn friction_of_two_drives_is_not_a_transmission_coupling() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        for joint in [SHOULDER, ELBOW] {
            tau[joint] += 2.0 * motion.qd[joint].signum() + 3.0 * motion.qd[joint];
        }
    };
    let open = check(&trio(), &injected, &[]);
    assert!(open.is_empty(), "{open:?}");
}

/// A torque on one joint by another's speed, without that of the other joint, is not a coupling either: gears act on both.
#[test]
fn a_torque_by_the_speed_of_another_joint_is_not_a_transmission_coupling() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[ELBOW] += 1.2 * motion.qd[SHOULDER];
    };
    let open = check(&trio(), &injected, &[]);
    let behind = Dependence { on: Regressor::OtherJoint, joint: Some("shoulder".to_owned()) };
    assert_eq!(open, [("elbow".to_owned(), vec![behind])]);
}

/// A base that is turned about the axis of the shoulder turns gravity for all joints, and not the zero of one.
#[test]
fn a_turned_base_is_not_an_encoder_offset() {
    let robot = trio().with_turned_base(Vector3::new(0.0, 1.0, 0.0), 0.1);
    let open = check(&robot, &|motion, tau| baseline_friction(motion, tau), &[("gravity_misalignment", None)]);
    assert!(open.is_empty(), "{open:?}");
}

/// Friction that grows in proportion to the speed does not grow with its square.
#[test]
fn viscous_friction_is_not_a_quadratic_drag() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] += 3.0 * motion.qd[SHOULDER];
    };
    let open = check(&trio(), &injected, &[]);
    assert!(open.is_empty(), "{open:?}");
}

/// Links that are all too light by one factor are not wrong one by one.
#[test]
fn a_common_factor_of_all_masses_is_not_a_link_inertial_error() {
    let robot = (0..3).fold(trio(), |arm, link| arm.with_scaled_link(link, 1.3));
    let open = check(&robot, &|motion, tau| baseline_friction(motion, tau), &[("inertial_scale", None)]);
    assert!(open.is_empty(), "{open:?}");
}
