//! A residual without findings is located, and is a mismatch only beyond the limits of an explained one.

use crate::support::{
    ELBOW, Motion, SHOULDER, TRIO, TURN, baseline_friction, diagnosed, effects_on, inputs, named, recorded, regular,
    sentences, start, trio,
};
use arm::{Arm, Vector3, Workspace};
use diagnosis::{Axis, Options, Report, Verdict, diagnose};
use effects::Regressor;
use nalgebra::Matrix6xX;

/// Torque constants that are wrong on all joints, each by another part, are reported although no finding names them.
#[test]
fn torques_that_only_the_background_explains_are_reported() {
    let factors = [1.16, 1.2, 1.13];
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau.iter_mut().zip(factors).for_each(|(tau, factor)| *tau *= factor);
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    let is_named = |joint: &str| {
        let findings = &diagnosis.report.findings;
        findings.iter().any(|finding| finding.effect == "torque_scale" && finding.joint.as_deref() == Some(joint))
            || findings.iter().any(|finding| finding.joint.is_none())
    };
    let remarks = diagnosis.remarks.join("\n");
    for joint in ["turn", "shoulder", "elbow"] {
        assert!(is_named(joint) || remarks.contains(&format!("{joint} ×")), "{joint}: {remarks}");
    }
}

/// A joint without a torque, whose link the URDF gives no mass: its channel is zero, or holds the rounding of a model. The other joints
/// are diagnosed nevertheless.
#[test]
fn a_channel_of_rounding_beside_a_link_without_mass_is_left_out() {
    let (before, last) = TRIO.rsplit_once("<inertial>").expect("links have masses");
    let (_, after) = last.split_once("</inertial>").expect("the element ends");
    let arm = Arm::from_urdf_text(&format!("{before}{after}"), "massless.urdf").expect("it is an arm");
    for size in [0.0, 3e-19] {
        let recordings = [0, 1, 2].map(|variant| {
            let mut recording = recorded(&arm, variant, 16.0, &|motion, tau| baseline_friction(motion, tau));
            let sines = (0..recording.tau[ELBOW].len()).map(|k| size * (0.1 * k as f64).sin());
            recording.tau[ELBOW] = sines.collect();
            regular(&recording)
        });
        let diagnosis =
            diagnose(&arm, &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed");
        for joint in ["turn", "shoulder"] {
            assert!(effects_on(&diagnosis, joint).contains(&"coulomb_friction"), "{size}: {diagnosis:?}");
        }
        assert!(effects_on(&diagnosis, "elbow").is_empty(), "{size}: {diagnosis:?}");
        let [group] = &diagnosis.report.not_diagnosed[..] else {
            panic!("{:?}", diagnosis.report.not_diagnosed);
        };
        assert_eq!(group.joints, ["elbow"]);
        assert!(group.because.starts_with("the measured torque is almost constant"));
    }
}

/// A torque of up to `size` (N m) in a part of the elbow's range depends on three joints at once, and no regressor predicts it.
fn with_unpredictable_torque(size: f64) -> Report {
    let injected = move |motion: &mut Motion, tau: &mut [f64]| {
        let phase = 5.0 * motion.qd[TURN] * motion.q[SHOULDER] + 4.0 * motion.q[ELBOW] * motion.qd[SHOULDER];
        if motion.q[ELBOW] > 1.0 {
            tau[ELBOW] += size * phase.sin();
        }
    };
    diagnosed(&trio(), &trio(), &injected, Vec::new()).report
}

/// With effects, a residual of this size counts as explained.
#[test]
fn a_small_residual_is_no_mismatch_and_is_located() {
    let report = with_unpredictable_torque(0.12);
    assert!(report.findings.is_empty(), "{:?}", report.findings);
    assert_eq!(report.verdict, Verdict::NoMismatch, "{:?}", report.unexplained);
    assert!(report.located.iter().any(|located| located.joint == "elbow"));
}

/// The list of unexplained residuals is not empty if the verdict is unexplained.
#[test]
fn an_unpredictable_residual_has_its_joint_its_place_and_an_experiment() {
    let report = with_unpredictable_torque(1.5);
    assert_eq!(report.verdict, Verdict::Unexplained, "{:?}", report.findings);
    let [open] = report.unexplained.as_slice() else {
        panic!("{:?}", report.unexplained);
    };
    assert_eq!(open.joint, "elbow");
    assert!(open.share > 0.35 && open.share < 0.6, "{open:?}");
    assert_eq!(open.depends_on.first(), Some(&Regressor::OwnPosition.into()), "{open:?}");
    assert!(open.next.contains("sweep elbow slowly over its whole range"), "{open:?}");
    let located = report.located.iter().find(|located| located.joint == "elbow").expect("it is located");
    let region = located.regions.iter().find(|region| region.axis == Axis::Angle).expect("it stands out");
    assert!(region.range[0] > 0.8, "{region:?}");
    assert!(!open.time.is_empty() && open.time == located.time, "{open:?}");
}

/// The held-out recording does not show what is unexplained, because it does not reach the states in which it arises.
#[test]
fn what_only_training_recordings_show_is_unexplained() {
    let recordings: Vec<_> = (0..4)
        .map(|variant| {
            let injected = |motion: &mut Motion, tau: &mut [f64]| {
                baseline_friction(motion, tau);
                let phase = 2.5 * motion.qd[TURN] * motion.q[SHOULDER] + 2.0 * motion.q[ELBOW] * motion.qd[SHOULDER];
                if variant != 2 && motion.q[ELBOW] > 1.0 {
                    tau[ELBOW] += 0.8 * phase.sin();
                }
            };
            regular(&recorded(&trio(), variant, 16.0, &injected))
        })
        .collect();
    let diagnosis = diagnose(&trio(), &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed");
    let report = &diagnosis.report;
    let fit = &report.fit["elbow"];
    let held_out = fit.held_out_nrmse_augmented.expect("it is moved");
    assert!(fit.train_nrmse_augmented > 0.12 && held_out < 0.06, "{fit:?}");
    assert_eq!(report.verdict, Verdict::PartlyExplained, "{fit:?}");
    let [open] = report.unexplained.as_slice() else {
        panic!("{:?}", report.unexplained);
    };
    assert_eq!(open.joint, "elbow");
    assert!((open.share - fit.train_nrmse_augmented).abs() < 0.02, "{open:?}");
    assert!(open.depends_on.contains(&Regressor::OwnPosition.into()), "{open:?}");
}

/// A part of the shoulder's torque in the elbow's sensor has a mean, which is no offset of the elbow's sensor: beside what is unexplained on
/// the same joint, it has no name. The corrected model contains it.
#[test]
fn a_constant_beside_an_unexplained_residual_has_no_name() {
    for gain in [0.05, 0.1] {
        let injected = move |motion: &mut Motion, tau: &mut [f64]| {
            baseline_friction(motion, tau);
            tau[ELBOW] += gain * tau[SHOULDER];
        };
        let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
        let report = &diagnosis.report;
        assert!(named(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));
        assert_eq!(report.unexplained[0].joint, "elbow");
        let constant = report.constant_torques["elbow"];
        assert!(constant.value.abs() > 3.0 * gain, "{constant:?}");
        let fit = &report.fit["elbow"];
        let nominal = fit.held_out_nrmse_nominal.expect("it is moved");
        assert!(fit.error() < 0.4 * nominal, "{fit:?}");
        let is_constant =
            |effect: &effects::Effect| effect.name() == "torque_offset" && effect.joint() == Some("elbow");
        assert!(diagnosis.effects.iter().any(is_constant));
    }
}

/// A torque sensor whose output rises faster than the torque is not called a torque constant if that leaves a residual on the joint.
#[test]
fn a_factor_beside_an_unexplained_residual_has_no_name() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[TURN] *= 1.0 + 0.4 * (tau[TURN] / 4.0).powi(2);
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    assert_eq!(diagnosis.report.unexplained[0].joint, "turn");
    let names = effects_on(&diagnosis, "turn");
    assert!(!names.contains(&"torque_scale"), "{:?}", sentences(&diagnosis));
}

/// An arm that is released when its recording begins may shake; later, the same force is a contact.
#[test]
fn a_contact_at_the_beginning_of_a_recording_is_not_named() {
    let arm = trio();
    let pushed_at = |begin: f64| {
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            baseline_friction(motion, tau);
            let since = motion.clock - start(1) - begin;
            if (0.0..0.4).contains(&since) {
                let mut jacobian = Matrix6xX::zeros(3);
                arm.jacobian(&mut Workspace::new(&arm), &motion.q, &arm.tool_frame(), &mut jacobian);
                for (joint, tau) in tau.iter_mut().enumerate() {
                    *tau -= jacobian.fixed_view::<3, 1>(3, joint).dot(&Vector3::new(15.0, 6.0, 24.0));
                }
            }
        };
        let diagnosis = diagnosed(&arm, &arm, &injected, Vec::new());
        named(&diagnosis).contains(&("external_contact", None))
    };
    assert!(pushed_at(6.0));
    assert!(!pushed_at(0.02));
}

/// What shakes two joints for a moment in the held-out recording, and is no force on the tool, is looked for there.
#[test]
fn a_moment_that_is_unexplained_is_repeated() {
    let recordings: Vec<_> = (0..3)
        .map(|variant| {
            let injected = |motion: &mut Motion, tau: &mut [f64]| {
                baseline_friction(motion, tau);
                if variant == 2 && (6.0..6.4).contains(&motion.time) {
                    tau[TURN] += 9.0 * (31.0 * motion.time).sin();
                    tau[ELBOW] += 9.0 * (47.0 * motion.time).cos();
                }
            };
            regular(&recorded(&trio(), variant, 16.0, &injected))
        })
        .collect();
    let diagnosis = diagnose(&trio(), &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed");
    let open = &diagnosis.report.unexplained[0];
    assert_eq!(open.joint, "elbow");
    // The recording has a clock of its own, which begins at 2000 s.
    assert!(open.time.iter().all(|window| window.start > 2005.5 && window.end < 2007.0), "{open:?}");
    assert!(open.next.starts_with("repeat the motion at "), "{open:?}");
}

/// A torque that depends on the position and repeats less than three times within the motion of the joint is no ripple; one that repeats
/// more often is.
#[test]
fn a_ripple_repeats_within_the_motion() {
    let is_ripple = |periods: f64| {
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            baseline_friction(motion, tau);
            tau[TURN] += 0.4 * (periods * motion.q[TURN] + 0.5).sin();
        };
        effects_on(&diagnosed(&trio(), &trio(), &injected, Vec::new()), "turn").contains(&"torque_ripple")
    };
    assert!(is_ripple(14.0));
    assert!(!is_ripple(9.0));
}
