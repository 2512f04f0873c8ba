//! Tracking with each model on machines with known effects.

use effects::Effect;
use effects::drive::{ACTUATION_DELAY, JOINT_ELASTICITY, ROTOR_INERTIA};
use effects::friction::QUADRATIC_DRAG;
use effects::sensor::{ENCODER_OFFSET, TORQUE_SCALE};
use faults::{Injected, Settings, conceal_effects, write_case};

use super::*;

/// Injects `effects` into the PUMA 560, and tracks the task with `named` as the diagnosed effects.
fn tracked(effects: &[Injected], named: &[Effect]) -> CaseTracking {
    let robots = crate::conceal::robots(&["puma560".to_owned()], &crate::cli::ChainArgs::default())
        .expect("it comes with the program");
    let settings = Settings { training: 1, ..Settings::default() };
    let concealment = conceal_effects(&robots[0], "case_000", effects, &settings).expect("they can be concealed");
    let folder = tempfile::tempdir().expect("a folder");
    let case = write_case(&concealment, folder.path(), &folder.path().join("truth")).expect("it can be written");
    let joints = robots[0].arm().joints().iter().zip(robots[0].rotor_inertias());
    let drives =
        joints.map(|(joint, &inertia)| Effect::of(&ROTOR_INERTIA).on(joint.name.clone()).with("inertia", inertia));
    let file = EffectFile { robot: None, effects: drives.chain(named.iter().cloned()).collect() };
    let case = Case {
        robot: &robots[0],
        folder: &case,
        truth: &concealment.truth,
        named: Some(&file.to_text().expect("effects can be written")),
    };
    case.track(String::new(), None).expect("it can be tracked")
}

/// The errors without the lag of the velocity filter, which is an error with every model.
fn errors(tracking: &CaseTracking) -> [f64; 5] {
    Model::ALL.map(|model| tracking.error_without_lag(model).expect("no loop is lost"))
}

/// The model with the true effect is as good as the exact model, and both are far better than the model without it.
#[test]
fn a_true_name_tracks_as_the_exact_model_does() {
    let joint = || "joint2".to_owned();
    let drag = Injected::new("quadratic_drag", Some("joint2")).with("coefficient", 40.0);
    let named = Effect::of(&QUADRATIC_DRAG).on(joint()).with("coefficient", 40.0).with("exponent", 2.0);
    let tracking = tracked(&[drag], &[named]);
    let [nominal, diagnosed, learned, _, exact] = errors(&tracking);
    assert!(exact < 0.01 * nominal && learned > 10.0 * exact, "{exact} {learned} {nominal}");
    assert!((diagnosed / exact - 1.0).abs() < 0.05, "{diagnosed} {exact}");
    assert_eq!(tracking.start, 60.0);
    assert!(tracking.over_exact().is_some_and(|over| over < 1.05));
}

/// Effects that are not torques: a delayed drive is commanded earlier, and the references of an encoder with an offset and
/// of a rotor behind a spring are shifted.
#[test]
fn delays_offsets_and_deflections_are_compensated() {
    let on = |name: &str| Some(format!("joint{name}"));
    let effects = [
        Injected::new("actuation_delay", on("1").as_deref()).with("delay", 0.0085),
        Injected::new("encoder_offset", on("2").as_deref()).with("offset", 0.03),
        Injected::new("joint_elasticity", on("3").as_deref()).with("stiffness", 900.0).with("damping", 2.0),
        Injected::new("torque_scale", on("5").as_deref()).with("factor", 1.3),
    ];
    let joint = |name: &str| format!("joint{name}");
    let named = [
        Effect::of(&ACTUATION_DELAY).on(joint("1")).with("delay", 0.0085),
        Effect::of(&ENCODER_OFFSET).on(joint("2")).with("offset", 0.03),
        Effect::of(&JOINT_ELASTICITY).on(joint("3")).with("stiffness", 900.0).with("damping", 2.0),
        Effect::of(&TORQUE_SCALE).on(joint("5")).with("factor", 1.3),
    ];
    let tracking = tracked(&effects, &named);
    let [nominal, diagnosed, learned, _, exact] = errors(&tracking);
    // A learned torque cannot correct the reference of an encoder.
    assert!(learned.min(nominal) > 0.9 * 0.03 / 6_f64.sqrt(), "{learned} {nominal}");
    assert!(exact < 0.05 * nominal, "{exact} {nominal}");
    assert!((diagnosed / exact - 1.0).abs() < 0.1, "{diagnosed} {exact}");
}
