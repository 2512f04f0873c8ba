//! Effects against their nearest rivals: each is found where it is, and not named where the rival is.

mod support;

use arm::{Matrix6xX, Workspace};
use diagnosis::{Options, diagnose};
use recording::RegularRecording;
use support::{
    Concealed, ELBOW, Motion, SHOULDER, TURN, baseline_friction, diagnosed, inputs, recorded, regular, sentences, trio,
};

/// What was found beside baseline friction of the expected sizes: effects and joints.
fn names(diagnosis: &diagnosis::Diagnosis) -> Vec<(&str, &str)> {
    let place = |(effect, joint): (_, Option<_>)| (effect, joint.unwrap_or("the whole arm"));
    support::named(diagnosis).into_iter().map(place).collect()
}

/// What is found of `concealed` must be these names, and nothing may stay unexplained; the diagnosis.
fn check(concealed: Concealed<'_>, expected: &[(&str, &str)]) -> diagnosis::Diagnosis {
    let diagnosis = diagnosed(&trio(), &trio(), concealed, Vec::new());
    let unexplained = &diagnosis.report.unexplained;
    assert_eq!(names(&diagnosis), expected, "{:?}", sentences(&diagnosis));
    assert!(unexplained.is_empty(), "{unexplained:#?}");
    diagnosis
}

/// Checks that a parameter of the finding of `effect` is within a part `tolerance` of the truth.
fn is_sized(diagnosis: &diagnosis::Diagnosis, effect: &str, truth: &[(&str, f64)], tolerance: f64) {
    let mut findings = diagnosis.report.findings.iter();
    let finding = findings.find(|finding| finding.effect == effect).expect("it is found");
    for (key, truth) in truth {
        let found = &finding.parameters[key];
        assert!(
            (found.value / truth - 1.0).abs() < tolerance,
            "{key}: {found:?} instead of {truth}"
        );
    }
}

/// A counterbalance of the shoulder, which carries half of its weight.
#[test]
fn gravity_compensator() {
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] += 14.0 * (motion.q[SHOULDER] + 1.5).sin();
    };
    let diagnosis = check(&concealed, &[("gravity_compensator", "shoulder")]);
    is_sized(
        &diagnosis,
        "gravity_compensator",
        &[("amplitude", 14.0), ("angle", -1.5)],
        0.05,
    );
}

/// A straight spring that pulls the same way stays a spring.
#[test]
fn a_spring_against_the_weight_is_no_gravity_compensator() {
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] += 9.0 * (motion.q[SHOULDER] + 1.5);
    };
    let diagnosis = check(&concealed, &[("spring", "shoulder")]);
    is_sized(&diagnosis, "spring", &[("stiffness", 9.0)], 0.06);
}

/// A body at the tool is weight, too, and is none of the shoulder's alone.
#[test]
fn a_payload_is_no_gravity_compensator() {
    let body = arm::Inertia {
        mass: 1.0,
        com: arm::Vector3::new(0.05, 0.0, 0.02),
        tensor: arm::Matrix3::identity() * 2e-3,
    };
    let loaded = trio().with_payload(&body);
    let diagnosis = diagnosed(
        &trio(),
        &loaded,
        &|motion, tau| baseline_friction(motion, tau),
        Vec::new(),
    );
    let found = names(&diagnosis);
    assert!(
        found.contains(&("payload", "the whole arm")),
        "{:?}",
        sentences(&diagnosis)
    );
    assert!(found.iter().all(|(effect, _)| *effect != "gravity_compensator"));
}

/// Recordings that follow each other closely, as a drive that warms up needs: 16 s of every 20.
fn in_a_row(concealed: impl Fn(f64, &mut Motion, &mut [f64])) -> diagnosis::Diagnosis {
    let arm = trio();
    let one = |variant: usize| -> RegularRecording {
        let begins = 20.0 * variant as f64;
        let at = |motion: &mut Motion, tau: &mut [f64]| concealed(begins + motion.time, motion, tau);
        let mut recording = recorded(&arm, variant, 16.0, &at);
        for time in &mut recording.time {
            *time -= support::start(variant) - begins;
        }
        regular(&recording)
    };
    let recordings: Vec<RegularRecording> = (0..4).map(one).collect();
    diagnose(&arm, &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed")
}

#[test]
fn thermal_drift() {
    let diagnosis = in_a_row(|time, motion, tau| {
        baseline_friction(motion, tau);
        tau[SHOULDER] += 2.0 * (1.0 + 1.2 * (-time / 25.0).exp()) * motion.qd[SHOULDER].signum();
    });
    assert_eq!(
        names(&diagnosis),
        [("thermal_drift", "shoulder")],
        "{:?}",
        sentences(&diagnosis)
    );
    // With the baseline 0.6 N m beneath.
    is_sized(
        &diagnosis,
        "thermal_drift",
        &[("coulomb", 2.6), ("amplitude", 2.4 / 2.6), ("time_constant", 25.0)],
        0.15,
    );
}

/// Dry friction that is as large when warm is no warming of a drive.
#[test]
fn dry_friction_that_stays_is_no_thermal_drift() {
    let diagnosis = in_a_row(|_, motion, tau| {
        baseline_friction(motion, tau);
        tau[SHOULDER] += 3.0 * motion.qd[SHOULDER].signum();
    });
    assert!(names(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));
}

/// What is recorded is commanded. Where the drive gives no more than −`limit`, a position loop asks for far more than the motion
/// needs.
fn wind_up(tau: &mut f64, limit: f64) {
    let missing = *tau + limit;
    if missing < 0.0 {
        *tau = 20.0 * missing - limit;
    }
}

#[test]
fn torque_saturation() {
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        wind_up(&mut tau[SHOULDER], 30.0);
    };
    let diagnosis = check(&concealed, &[("torque_saturation", "shoulder")]);
    is_sized(&diagnosis, "torque_saturation", &[("limit", 30.0)], 0.05);
}

/// The limit is reached for less than a second, and hardly at another time, so that neither the held-out recording nor every other
/// piece of two seconds tests it.
#[test]
fn a_torque_limit_that_is_hardly_reached() {
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        let begins = [10.0, 1006.0].iter();
        if begins.clone().any(|from| (0.0..2.0).contains(&(motion.clock - from))) {
            wind_up(&mut tau[SHOULDER], 32.0);
        }
    };
    let diagnosis = check(&concealed, &[("torque_saturation", "shoulder")]);
    is_sized(&diagnosis, "torque_saturation", &[("limit", 32.0)], 0.02);
}

/// A constant in the torque is no friction that depends on the direction, unless it is large beside the friction.
#[test]
fn a_small_torque_offset_is_no_asymmetric_friction() {
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[TURN] += 3.0 * motion.qd[TURN].signum() + 0.3;
    };
    check(&concealed, &[("torque_offset", "turn")]);
}

/// A torque that is reported too large is so at all sizes: no limit.
#[test]
fn a_scale_is_no_torque_saturation() {
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] *= 1.3;
    };
    check(&concealed, &[("torque_scale", "shoulder")]);
}

/// A spring between drive and link gives way without a gap. (A gap needs a simulated drive: `tests/cases/backlash` has one.)
#[test]
fn a_spring_in_the_drive_is_no_backlash() {
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        motion.q[ELBOW] += tau[ELBOW] / 250.0;
        baseline_friction(motion, tau);
    };
    check(&concealed, &[("joint_elasticity", "elbow")]);
}

/// From 6 s to 7.5 s in the first recording, a force of 5, 2 and 8 N on the tool.
#[test]
fn external_contact() {
    let arm = trio();
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        if (6.0..7.5).contains(&motion.clock) {
            let mut jacobian = Matrix6xX::zeros(3);
            arm.jacobian(&mut Workspace::new(&arm), &motion.q, &arm.tool_frame(), &mut jacobian);
            for (joint, tau) in tau.iter_mut().enumerate() {
                let velocity = jacobian.fixed_view::<3, 1>(3, joint);
                *tau -= velocity.dot(&arm::Vector3::new(5.0, 2.0, 8.0));
            }
        }
        baseline_friction(motion, tau);
    };
    let diagnosis = check(&concealed, &[("external_contact", "the whole arm")]);
    is_sized(
        &diagnosis,
        "external_contact",
        &[("start", 6.0), ("duration", 1.5), ("force_x", 5.0), ("force_z", 8.0)],
        0.1,
    );
}

/// A constant that sets in on one joint is no force on the tool, which all joints would feel.
#[test]
fn a_torque_offset_that_sets_in_is_no_external_contact() {
    let concealed = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        if motion.clock >= 1006.0 {
            tau[ELBOW] += 1.5;
        }
    };
    check(&concealed, &[("torque_offset", "elbow")]);
}

/// In motion, a constant beside dry friction is dry friction that differs by direction: whichever is named, the other stands beside
/// it, however much it explains.
#[test]
fn a_large_constant_beside_friction_has_its_alternative() {
    let diagnosis = diagnosed(
        &trio(),
        &trio(),
        &|motion, tau| {
            baseline_friction(motion, tau);
            tau[TURN] += 2.5 * motion.qd[TURN].signum() + 1.5;
        },
        Vec::new(),
    );
    let pair = ["friction_asymmetry", "torque_offset"];
    let mut findings = diagnosis.report.findings.iter();
    let finding = findings.find(|finding| finding.joint.as_deref() == Some("turn") && pair.contains(&finding.effect));
    let finding = finding.unwrap_or_else(|| panic!("{:?}", sentences(&diagnosis)));
    let rivals: Vec<&str> = finding.confusable_with.iter().map(|rival| rival.effect).collect();
    assert!(
        pair.iter()
            .any(|&name| name != finding.effect && rivals.contains(&name)),
        "{} {rivals:?}",
        finding.effect
    );
}

/// Every drive has a little more friction in one direction; that is named from 0.7 % of the torque on.
#[test]
fn a_small_difference_of_the_directions_is_friction() {
    for (difference, is_named) in [(0.004, false), (0.05, true)] {
        let spread = 3.0;
        let diagnosis = diagnosed(
            &trio(),
            &trio(),
            &|motion, tau| {
                baseline_friction(motion, tau);
                tau[TURN] += difference * spread;
            },
            Vec::new(),
        );
        let found = names(&diagnosis);
        assert_eq!(
            found.iter().any(|(_, joint)| *joint == "turn"),
            is_named,
            "{difference} {:?}",
            sentences(&diagnosis)
        );
    }
}
