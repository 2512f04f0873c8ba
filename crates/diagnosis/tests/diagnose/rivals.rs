//! Effects and their nearest rivals: each is found if it is injected, and not named if the rival is injected.

use crate::support::{
    ELBOW, Injected, Motion, SHOULDER, TURN, baseline_friction, diagnosed, inputs, recorded, regular, sentences, start,
    trio,
};
use arm::{Arm, Matrix6xX, Workspace};
use diagnosis::{Options, diagnose};
use effects::Effect;
use effects::drive::{ACTUATION_DELAY, BACKLASH, TORQUE_SATURATION};
use recording::RegularRecording;

/// The findings beside baseline friction of the expected sizes: effects and joints.
fn names(diagnosis: &diagnosis::Diagnosis) -> Vec<(&str, &str)> {
    let place = |(effect, joint): (_, Option<_>)| (effect, joint.unwrap_or("the whole arm"));
    crate::support::named(diagnosis).into_iter().map(place).collect()
}

/// Checks that the findings of the diagnosis of `injected` are `expected` and nothing is unexplained; returns the
/// diagnosis.
fn check(injected: Injected<'_>, expected: &[(&str, &str)]) -> diagnosis::Diagnosis {
    let diagnosis = diagnosed(&trio(), &trio(), injected, Vec::new());
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
        assert!((found.value / truth - 1.0).abs() < tolerance, "{key}: {found:?} instead of {truth}");
    }
}

/// A counterbalance of the shoulder, which carries half of its weight.
#[test]
fn gravity_compensator() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] += 14.0 * (motion.q[SHOULDER] + 1.5).sin();
    };
    let diagnosis = check(&injected, &[("gravity_compensator", "shoulder")]);
    is_sized(&diagnosis, "gravity_compensator", &[("amplitude", 14.0), ("angle", -1.5)], 0.05);
}

/// A linear spring that carries a part of the weight is named as a spring.
#[test]
fn a_spring_against_the_weight_is_not_a_gravity_compensator() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] += 9.0 * (motion.q[SHOULDER] + 1.5);
    };
    let diagnosis = check(&injected, &[("spring", "shoulder")]);
    is_sized(&diagnosis, "spring", &[("stiffness", 9.0)], 0.06);
}

/// A body at the tool is also a weight, but not one of the shoulder alone.
#[test]
fn a_payload_is_not_a_gravity_compensator() {
    let body =
        arm::Inertia { mass: 1.0, com: arm::Vector3::new(0.05, 0.0, 0.02), tensor: arm::Matrix3::identity() * 2e-3 };
    let loaded = trio().with_payload(&body);
    let diagnosis = diagnosed(&trio(), &loaded, &|motion, tau| baseline_friction(motion, tau), Vec::new());
    let found = names(&diagnosis);
    assert!(found.contains(&("payload", "the whole arm")), "{:?}", sentences(&diagnosis));
    assert!(found.iter().all(|(effect, _)| *effect != "gravity_compensator"));
}

/// Recordings that follow each other closely, as a drive that warms up needs: 16 s of every 20.
fn in_a_row(injected: impl Fn(f64, &mut Motion, &mut [f64])) -> diagnosis::Diagnosis {
    let arm = trio();
    let one = |variant: usize| -> RegularRecording {
        let begins = 20.0 * variant as f64;
        let at = |motion: &mut Motion, tau: &mut [f64]| injected(begins + motion.time, motion, tau);
        let mut recording = recorded(&arm, variant, 16.0, &at);
        for time in &mut recording.time {
            *time -= start(variant) - begins;
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
    assert_eq!(names(&diagnosis), [("thermal_drift", "shoulder")], "{:?}", sentences(&diagnosis));
    // The level contains the baseline of 0.6 N m.
    is_sized(&diagnosis, "thermal_drift", &[("coulomb", 2.6), ("amplitude", 2.4 / 2.6), ("time_constant", 25.0)], 0.15);
}

/// Dry friction that does not change with time is not a thermal drift, even if it is by chance a little less in each recording.
#[test]
fn dry_friction_that_differs_between_recordings_is_not_a_thermal_drift() {
    for level in [[3.0; 4], [3.12, 3.06, 3.02, 3.0]] {
        let diagnosis = in_a_row(|time, motion, tau| {
            baseline_friction(motion, tau);
            tau[SHOULDER] += level[(time / 20.0) as usize] * motion.qd[SHOULDER].signum();
        });
        assert!(names(&diagnosis).is_empty(), "{level:?}: {:?}", sentences(&diagnosis));
    }
}

/// The commanded torque is recorded. While the drive is limited to −`limit`, a position loop commands far more than the
/// motion needs.
fn wind_up(tau: &mut f64, limit: f64) {
    let missing = *tau + limit;
    if missing < 0.0 {
        *tau = 20.0 * missing - limit;
    }
}

#[test]
fn torque_saturation() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        wind_up(&mut tau[SHOULDER], 30.0);
    };
    let diagnosis = check(&injected, &[("torque_saturation", "shoulder")]);
    is_sized(&diagnosis, "torque_saturation", &[("limit", 30.0)], 0.05);
}

/// The limit is reached for less than a second, so that neither the held-out recording nor every other piece of two seconds
/// tests it.
#[test]
fn a_torque_limit_that_is_hardly_reached() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        let begins = [10.0, 1006.0].iter();
        if begins.clone().any(|from| (0.0..2.0).contains(&(motion.clock - from))) {
            wind_up(&mut tau[SHOULDER], 32.0);
        }
    };
    let diagnosis = check(&injected, &[("torque_saturation", "shoulder")]);
    is_sized(&diagnosis, "torque_saturation", &[("limit", 32.0)], 0.02);
}

/// A constant torque is named as friction that depends on the direction only if it is large in comparison with the
/// friction. No motion distinguishes the two, so that the other one is its alternative.
#[test]
fn a_small_torque_offset_is_not_asymmetric_friction() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[TURN] += 3.0 * motion.qd[TURN].signum() + 0.3;
    };
    let diagnosis = check(&injected, &[("torque_offset", "turn")]);
    let mut findings = diagnosis.report.findings.iter();
    let offset = findings.find(|finding| finding.effect == "torque_offset");
    let rivals = offset.map(|offset| &offset.confusable_with).expect("it is named");
    assert!(rivals.iter().any(|rival| rival.effect == "friction_asymmetry"), "{rivals:?}");
}

/// A torque scale acts at all sizes of the torque, and a limit does not.
#[test]
fn a_scale_is_not_a_torque_saturation() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[SHOULDER] *= 1.3;
    };
    check(&injected, &[("torque_scale", "shoulder")]);
}

/// A gap in the elbow's gear: the link lies against one side of it or the other, by the sign of the torque that it needs.
/// (`tests/cases/backlash` has a simulated drive.)
#[test]
fn backlash() {
    // Gears have gaps of a few milliradians.
    for half in [0.01, 0.002] {
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            motion.q[ELBOW] += half * (tau[ELBOW] / 0.05).tanh();
            baseline_friction(motion, tau);
        };
        let diagnosis = check(&injected, &[("backlash", "elbow")]);
        is_sized(&diagnosis, "backlash", &[("halfgap", half)], 0.1);
    }
}

/// A known gap can only be found again. If it is not, or with another size, that is said.
#[test]
fn a_known_gap_is_compared_with_the_recordings() {
    let gap = |joint: &str, half: f64| Effect::of(&BACKLASH).on(joint.to_owned()).with("halfgap", half);
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        motion.q[ELBOW] += 0.01 * (tau[ELBOW] / 0.05).tanh();
        baseline_friction(motion, tau);
    };
    let known = vec![gap("elbow", 0.01), gap("shoulder", 0.01)];
    let diagnosis = diagnosed(&trio(), &trio(), &injected, known);
    assert!(
        diagnosis.report.findings.iter().all(|finding| finding.effect != "backlash"),
        "{:?}",
        sentences(&diagnosis)
    );
    let remarks = diagnosis.remarks.join("\n");
    assert!(remarks.contains("the known backlash on shoulder is not found"), "{remarks}");
    assert!(!remarks.contains("the known backlash on elbow"), "{remarks}");

    let diagnosis = diagnosed(&trio(), &trio(), &injected, vec![gap("elbow", 0.1)]);
    let remarks = diagnosis.remarks.join("\n");
    assert!(remarks.contains("the known backlash on elbow has another size"), "{remarks}");
}

/// Known effects on the commanded torque act one after the other: of two limits the lower one counts, and delays add up.
#[test]
fn several_known_effects_on_the_commanded_torque_act_one_after_the_other() {
    let limit = |limit: f64| Effect::of(&TORQUE_SATURATION).on("shoulder").with("limit", limit);
    let late = |delay: f64| Effect::of(&ACTUATION_DELAY).on("shoulder").with("delay", delay);
    let wound_up = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        wind_up(&mut tau[SHOULDER], 8.0);
    };
    let nominal = |known: Vec<Effect>| {
        let diagnosis = diagnosed(&trio(), &trio(), &wound_up, known);
        diagnosis.report.fit["shoulder"].held_out_nrmse_nominal.expect("it is moved")
    };
    let one = nominal(vec![limit(8.0)]);
    for known in [vec![limit(8.0), limit(9.0)], vec![limit(9.0), limit(8.0)]] {
        let two = nominal(known);
        assert!((one - two).abs() < 1e-9, "{one} with one limit, {two} with two");
    }
    let both = nominal(vec![limit(8.0), late(0.008)]);
    for known in [vec![late(0.008), limit(8.0)], vec![limit(8.0), late(0.004), late(0.004)]] {
        let other = nominal(known);
        assert!((both - other).abs() < 1e-9, "{both} and {other}");
    }
}

/// A spring between drive and link gives way without a gap, and without a delay.
#[test]
fn a_spring_in_the_drive_is_neither_backlash_nor_a_delay() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        motion.q[ELBOW] += tau[ELBOW] / 250.0;
        baseline_friction(motion, tau);
    };
    check(&injected, &[("joint_elasticity", "elbow")]);
}

/// A force of 5, 2 and 8 N on the tool, for 1.5 s from the time `start` (s) on.
fn pushed_from(arm: &Arm, start: f64, motion: &mut Motion, tau: &mut [f64]) {
    if (start..start + 1.5).contains(&motion.clock) {
        let mut jacobian = Matrix6xX::zeros(3);
        arm.jacobian(&mut Workspace::new(arm), &motion.q, &arm.tool_frame(), &mut jacobian);
        for (joint, tau) in tau.iter_mut().enumerate() {
            let velocity = jacobian.fixed_view::<3, 1>(3, joint);
            *tau -= velocity.dot(&arm::Vector3::new(5.0, 2.0, 8.0));
        }
    }
    baseline_friction(motion, tau);
}

const PUSH: [(&str, f64); 4] = [("start", 6.0), ("duration", 1.5), ("force_x", 5.0), ("force_z", 8.0)];

#[test]
fn external_contact() {
    let arm = trio();
    let injected = |motion: &mut Motion, tau: &mut [f64]| pushed_from(&arm, 6.0, motion, tau);
    let diagnosis = check(&injected, &[("external_contact", "the whole arm")]);
    is_sized(&diagnosis, "external_contact", &PUSH, 0.1);
}

/// If each recording has a clock of its own, the time of a contact is on that of its recording, which the sentence names.
#[test]
fn a_contact_is_on_the_clock_of_its_recording() {
    let arm = trio();
    let injected = |motion: &mut Motion, tau: &mut [f64]| pushed_from(&arm, start(1) + 6.0, motion, tau);
    let recordings: Vec<RegularRecording> = [16.0, 16.0, 10.0]
        .into_iter()
        .enumerate()
        .map(|(variant, seconds)| {
            let mut recording = recorded(&arm, variant, seconds, &injected);
            recording.time.iter_mut().for_each(|time| *time -= start(variant));
            regular(&recording)
        })
        .collect();
    let diagnosis = diagnose(&arm, &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed");
    is_sized(&diagnosis, "external_contact", &PUSH, 0.1);
    let said = sentences(&diagnosis);
    assert!(said.iter().any(|sentence| sentence.contains(" s on, in b")), "{said:?}");
}

/// A constant with an onset on one joint is not a force on the tool, which would act on all joints.
#[test]
fn a_torque_offset_with_an_onset_is_not_an_external_contact() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        if motion.clock >= 1006.0 {
            tau[ELBOW] += 1.5;
        }
    };
    check(&injected, &[("torque_offset", "elbow")]);
}

/// In motion, a constant beside dry friction equals dry friction that differs by direction: whichever is named, the other
/// is listed as an alternative, even if the finding explains much.
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
    assert!(pair.iter().any(|&name| name != finding.effect && rivals.contains(&name)), "{} {rivals:?}", finding.effect);
}

/// Every drive has slightly more friction in one direction; it is named from 0.7 % of the torque on.
#[test]
fn a_small_difference_between_directions_is_friction() {
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
