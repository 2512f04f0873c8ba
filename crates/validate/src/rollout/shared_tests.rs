//! Rollouts of simulated cases that another physics engine made (`../shared`).

use std::path::{Path, PathBuf};

use super::*;
use effects::drive::ROTOR_INERTIA;
use recording::Recording;

fn blind() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/blind")
}

/// The injected effect in the terms of the catalogue; `None` if it is not in the catalogue.
fn injected(truth: &Path) -> Option<Vec<Effect>> {
    let text = std::fs::read_to_string(truth).expect("the truth can be read");
    let truth: serde_json::Value = serde_json::from_str(&text).expect("the truth is JSON");
    let mut effects = Vec::new();
    for item in truth["concealed"].as_array().expect("there is a list") {
        let mut item = item.as_object().expect("an effect is an object").clone();
        for extra in ["expressed_share", "rec"] {
            item.remove(extra);
        }
        if item["effect"] == "payload" || item["effect"] == "external_contact" {
            item.remove("joint");
        }
        if item["effect"] == "link_mass_error" {
            item.insert("effect".into(), "link_inertial_error".into());
        }
        if let Some(rotor) = item.remove("rotor") {
            effects.push(
                Effect::of(&ROTOR_INERTIA)
                    .on(item["joint"].as_str().expect("it has a joint"))
                    .with("inertia", rotor.as_f64().expect("it is a number")),
            );
        }
        effects.push(serde_json::from_value(item.into()).ok()?);
    }
    Some(effects)
}

/// With the ground truth, the plant moves as the arm of the other engine: elasticity, saturation, backlash, asymmetric,
/// Stribeck and load-dependent friction, torque scale.
#[test]
#[ignore = "needs ../shared"]
fn the_plant_with_the_injected_faults_moves_as_the_other_engine() {
    let folder = blind();
    for case in [2, 3, 9, 13, 17, 26] {
        let effects = injected(&folder.join(format!("truth/case_{case:03}.json"))).expect("it is in the catalogue");
        let files = folder.join(format!("case_{case:03}"));
        let arm = Arm::from_urdf(files.join("robot.urdf")).expect("it is an arm");
        let recording = Recording::read(&files.join("held_out.csv")).expect("it is read");
        let recording = recording.regular().expect("it has a clock").0;
        let result = rollout(&arm, &[], &effects, &recording, &RolloutOptions::default()).expect("it runs");
        assert_eq!(result.runaway_augmented, 0);
        assert!(result.remarks.is_empty(), "{:?}", result.remarks);
        for (joint, found) in arm.joints().iter().zip(&result.joints) {
            let (nominal, augmented) = (found.nominal_rms_rad, found.augmented_rms_rad);
            println!("case {case} {}: {nominal:.4} → {augmented:.4}", joint.name);
            assert!(nominal < 2e-3 || augmented < 0.25 * nominal, "{nominal} → {augmented}");
        }
    }
}

/// A delay alone changes the motion little.
#[test]
#[ignore = "needs ../shared"]
fn a_delay_shows_on_its_joint() {
    let folder = blind();
    let effects = injected(&folder.join("truth/case_001.json")).expect("it is in the catalogue");
    let files = folder.join("case_001");
    let arm = Arm::from_urdf(files.join("robot.urdf")).expect("it is an arm");
    let recording = Recording::read(&files.join("train_1.csv")).expect("it is read");
    let recording = recording.regular().expect("it has a clock").0;
    let found = &rollout(&arm, &[], &effects, &recording, &RolloutOptions::default()).expect("it runs").joints[0];
    assert!(found.augmented_rms_rad < 0.4 * found.nominal_rms_rad, "{found:?}");
}
