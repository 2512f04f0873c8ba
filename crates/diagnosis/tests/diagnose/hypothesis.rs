//! Requested effects are fitted as they are, right ones well and wrong ones badly, and no other effect is named.

use crate::support::{ELBOW, Motion, SHOULDER, baseline_friction, diagnosed_with, trio};
use diagnosis::{Diagnosis, DiagnosisError, Options, Wanted};

/// Friction on the shoulder, a stiction curve on the elbow, and a ripple there.
fn injected(motion: &mut Motion, tau: &mut [f64]) {
    let speed = motion.qd[SHOULDER];
    tau[SHOULDER] += 2.5 * speed.signum() + 1.8 * speed;
    let speed = motion.qd[ELBOW];
    tau[ELBOW] += (1.0 + 1.5 * (-(speed / 0.15).powi(2)).exp()) * speed.signum();
    tau[ELBOW] += 0.8 * (23.0 * motion.q[ELBOW] + 0.4).sin();
}

fn wanted(list: &[(&str, Option<&str>)]) -> Vec<Wanted> {
    list.iter()
        .map(|(effect, joint)| Wanted {
            effect: (*effect).to_owned(),
            joint: joint.map(str::to_owned),
            ..Wanted::default()
        })
        .collect()
}

fn tried(list: &[(&str, Option<&str>)]) -> Result<Diagnosis, DiagnosisError> {
    let options = Options { only: Some(wanted(list)), ..Options::default() };
    diagnosed_with(&trio(), &trio(), &injected, &options)
}

fn error(diagnosis: &Diagnosis, joint: &str) -> [f64; 2] {
    let fit = &diagnosis.report.fit[joint];
    [fit.held_out_nrmse_nominal, fit.held_out_nrmse_augmented].map(|error| error.expect("a recording is held out"))
}

#[test]
fn the_right_effects_explain_the_recordings_with_their_sizes() {
    let right = [
        ("torque_ripple", Some("elbow")),
        ("coulomb_friction", Some("shoulder")),
        ("viscous_friction", Some("shoulder")),
        ("stribeck_friction", Some("elbow")),
    ];
    let diagnosis = tried(&right).expect("it can be fitted");
    let mut found: Vec<_> = diagnosis.report.findings.iter().map(|f| (f.effect, f.joint.as_deref())).collect();
    let mut right = right;
    found.sort_unstable();
    right.sort_unstable();
    assert_eq!(found, right);
    for (effect, parameter, truth) in [
        ("coulomb_friction", "level", 2.5),
        ("viscous_friction", "coefficient", 1.8),
        ("stribeck_friction", "breakaway", 2.5),
        ("torque_ripple", "amplitude", 0.8),
        ("torque_ripple", "periods", 23.0),
    ] {
        let finding = diagnosis.report.findings.iter().find(|f| f.effect == effect).expect("it is there");
        let value = finding.parameters[parameter].value;
        assert!((value / truth - 1.0).abs() < 0.05, "{effect} {parameter}: {value} instead of {truth}");
    }
    for joint in ["shoulder", "elbow"] {
        let [nominal, augmented] = error(&diagnosis, joint);
        assert!(augmented < 0.1 * nominal, "{joint}: {nominal} → {augmented}");
    }
}

#[test]
fn wrong_effects_are_fitted_too_and_explain_little() {
    let wrong = [("quadratic_drag", Some("shoulder")), ("payload", None)];
    let diagnosis = tried(&wrong).expect("it can be fitted");
    assert_eq!(diagnosis.report.findings.len(), 2);
    let [nominal, augmented] = error(&diagnosis, "shoulder");
    assert!(augmented > 0.3 * nominal, "{nominal} → {augmented}");
}

#[test]
fn an_empty_hypothesis_is_the_nominal_model() {
    let diagnosis = tried(&[]).expect("it can be fitted");
    assert!(diagnosis.report.findings.is_empty());
    let [nominal, augmented] = error(&diagnosis, "shoulder");
    assert!((nominal / augmented - 1.0).abs() < 1e-9);
}

#[test]
fn unknown_effects_and_joints_are_refused() {
    for (list, part) in [
        (
            vec![("stiction", Some("elbow"))],
            "stiction on elbow: no such effect is in the catalogue, which has viscous_friction, ",
        ),
        (vec![("coulomb_fricton", Some("elbow"))], "did you mean coulomb_friction?"),
        (vec![("Coulomb friction", Some("elbow"))], "did you mean coulomb_friction?"),
        (
            vec![("spring", Some("elbw"))],
            "the robot has no joint \"elbw\"; did you mean \"elbow\"? its joints are turn, shoulder, elbow",
        ),
        (vec![("spring", None)], "acts on a joint; give spring:JOINT"),
        (vec![("payload", Some("elbow"))], "acts on the whole arm"),
        (vec![("spring", Some("elbow")), ("spring", Some("elbow"))], "given twice"),
    ] {
        let error = tried(&list).expect_err("it is refused").to_string();
        assert!(error.contains(part), "{error}");
    }
}

/// Another body of one link can be requested, also where friction that is not requested remains; where the URDF's is right, nothing is fitted, and a note says so.
#[test]
fn another_body_of_a_link_can_be_requested() {
    let options = Options { only: Some(wanted(&[("inertial_parameters", Some("elbow"))])), ..Options::default() };
    for (factor, is_found) in [(1.5, true), (1.0, false)] {
        let heavier = trio().with_scaled_link(ELBOW, factor);
        let friction = |motion: &mut Motion, tau: &mut [f64]| {
            if is_found {
                baseline_friction(motion, tau);
            }
        };
        let diagnosis = diagnosed_with(&trio(), &heavier, &friction, &options).expect("it can be requested");
        let found: Vec<_> = diagnosis.report.findings.iter().map(|finding| finding.joint.as_deref()).collect();
        assert_eq!(found, if is_found { vec![Some("elbow")] } else { vec![] }, "{factor}");
        let notes = diagnosis.remarks.join("; ");
        assert_eq!(notes.contains("as likely with the URDF's bodies"), !is_found, "{factor}: {notes}");
    }
}
