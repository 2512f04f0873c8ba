//! Small constant torques on all joints, as real torque sensors have them.

use crate::support::{Motion, SHOULDER, baseline_friction, inputs, named, recorded, regular, sentences, trio};
use diagnosis::{Diagnosis, Options, diagnose};
use effects::Effect;

/// The diagnosis of four recordings of 16 s in which the joints have the constant torques `constants` (N m), the third held out.
fn diagnosed(constants: [f64; 3], known: &[Effect]) -> Diagnosis {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        let mut friction = [0.0; 3];
        baseline_friction(motion, &mut friction);
        for joint in 0..3 {
            tau[joint] += friction[joint] + constants[joint];
        }
    };
    let recordings: Vec<_> = (0..4).map(|variant| regular(&recorded(&trio(), variant, 16.0, &injected))).collect();
    let options = Options { known: known.to_vec(), ..Options::default() };
    diagnose(&trio(), &inputs(&recordings), &options, &|_| {}).expect("it can be diagnosed")
}

/// Checks that the constants of exactly these `joints` are corrected, and within their intervals.
#[track_caller]
fn assert_constants(diagnosis: &Diagnosis, joints: &[(&str, f64)]) {
    let found = &diagnosis.report.constant_torques;
    assert_eq!(found.len(), joints.len(), "{found:?}");
    for &(joint, constant) in joints {
        let [low, high] = found[joint].ci95;
        assert!(low <= constant && constant <= high, "{joint}: {:?}", found[joint]);
        assert!((found[joint].value - constant).abs() < 0.004, "{joint}: {:?}", found[joint]);
    }
}

/// They are too small for names, and the corrected model contains them: as known effects, they leave nothing.
#[test]
fn small_constants_of_all_joints_are_corrected_without_names() {
    let diagnosis = diagnosed([0.026, -0.05, 0.015], &[]);
    assert!(named(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));
    assert_constants(&diagnosis, &[("turn", 0.026), ("shoulder", -0.05), ("elbow", 0.015)]);
    let is_reported = |remark: &String| remark.contains("turn 0.0") && remark.contains("elbow 0.0");
    assert!(diagnosis.remarks.iter().any(is_reported), "{:?}", diagnosis.remarks);

    let again = diagnosed([0.026, -0.05, 0.015], &diagnosis.effects);
    assert!(again.report.constant_torques.is_empty() && again.report.findings.is_empty());
    for (joint, fit) in &diagnosis.report.fit {
        let exported = fit.held_out_nrmse_exported.expect("it is moved");
        let known = again.report.fit[joint].held_out_nrmse_nominal.expect("it is moved");
        assert!((exported - known).abs() < 1e-3, "{joint}: {exported} reported, {known} with the effects");
    }
}

/// A large constant is named, and the background then has none on its joint.
#[test]
fn a_large_constant_has_a_name() {
    let diagnosis = diagnosed([0.5, -0.05, 0.015], &[]);
    assert_eq!(named(&diagnosis), [("torque_offset", Some("turn"))], "{:?}", sentences(&diagnosis));
    assert_constants(&diagnosis, &[("shoulder", -0.05), ("elbow", 0.015)]);
}

/// A constant of an eighth of the joint's torque has a name where the other joints have small constants, too.
#[test]
fn a_constant_far_larger_than_those_of_the_other_joints_has_a_name() {
    let diagnosis = diagnosed([0.05, 0.8, 0.05], &[]);
    assert_eq!(named(&diagnosis), [("torque_offset", Some("shoulder"))], "{:?}", sentences(&diagnosis));
    assert_constants(&diagnosis, &[("turn", 0.05), ("elbow", 0.05)]);
}

/// A constant of 3 % beside constants of the other joints is no friction that depends on the direction.
#[test]
fn a_constant_like_those_of_the_other_joints_is_no_asymmetric_friction() {
    let diagnosis = diagnosed([0.026, 0.2, 0.015], &[]);
    assert!(named(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));
    assert_constants(&diagnosis, &[("turn", 0.026), ("shoulder", 0.2), ("elbow", 0.015)]);
}

#[test]
fn exact_torques_need_no_constants() {
    let diagnosis = diagnosed([0.0; 3], &[]);
    assert!(diagnosis.report.constant_torques.is_empty());
    assert!(named(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));
}

/// The torque of one joint is in another unit, or on the other side of a gear.
#[test]
fn one_torque_in_another_unit_is_a_scale_of_any_size() {
    for factor in [0.1, 8.0, 1000.0] {
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            baseline_friction(motion, tau);
            tau[SHOULDER] *= factor;
        };
        let diagnosis = crate::support::diagnosed(&trio(), &trio(), &injected, Vec::new());
        assert_eq!(named(&diagnosis), [("torque_scale", Some("shoulder"))], "{factor}: {:?}", sentences(&diagnosis));
        let mut findings = diagnosis.report.findings.iter();
        let found = findings.find(|finding| finding.effect == "torque_scale").expect("it is named");
        assert!((found.parameters["factor"].value / factor - 1.0).abs() < 0.03, "{:?}", found.parameters);
    }
}
