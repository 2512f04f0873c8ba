//! `testbed diagnose` on injected physics of another engine: what the truth says is found, and nothing else.

use std::collections::BTreeSet;

use crate::diagnose_made::names;
use crate::support::{Sandbox, root};
use serde_json::Value;

/// What a URDF usually omits; the cases have it on many joints.
const BASELINE: [&str; 3] = ["coulomb_friction", "viscous_friction", "rotor_inertia"];

/// The name that the catalogue has for what the truth calls otherwise.
fn renamed(name: &str) -> &str {
    match name {
        "link_mass_error" => "link_inertial_error",
        "gravity_tilt" => "gravity_misalignment",
        name => name,
    }
}

/// Diagnoses a case, and checks it against its truth.
fn check(case: &str) {
    let shared = root().join("../shared/blind");
    let folder = shared.join(case);
    let path = |name: &str| folder.join(name).to_string_lossy().into_owned();
    let files = ["robot.urdf", "train_1.csv", "train_2.csv", "train_3.csv", "held_out.csv"].map(path);
    let sandbox = Sandbox::new();
    let mut command = vec!["diagnose", "--robot", &files[0], "--train", &files[1], &files[2], &files[3]];
    command.extend(["--held-out", &files[4], "--json", "d.json"]);
    sandbox.succeed(&command);
    let found = sandbox.json("d.json");
    let text = std::fs::read_to_string(shared.join(format!("truth/{case}.json"))).expect("the truth is there");
    let truth: Value = serde_json::from_str(&text).expect("it is JSON");
    compare(case, &truth, &found);
}

/// Checks a diagnosis of `case` against the truth: every injected effect is found, and no other; an effect outside the catalogue is
/// refused on its joint; the error of no joint increases.
pub fn compare(case: &str, truth: &Value, found: &Value) {
    let injected = truth["concealed"].as_array().expect("a list").iter().map(|effect| {
        let name = renamed(effect["effect"].as_str().expect("a name"));
        (name.to_owned(), effect["joint"].as_str().unwrap_or("whole arm").to_owned())
    });
    let (unknown, known): (BTreeSet<_>, BTreeSet<_>) = injected.partition(|(name, _)| name.ends_with("_unknown"));
    let is_special = |(name, _): &&(String, String)| !BASELINE.contains(&name.as_str());
    let list = names(found);
    let named: Vec<_> = list.iter().filter(is_special).collect();
    let hidden: Vec<_> = known.iter().filter(is_special).collect();
    assert_eq!(named, hidden, "{case}");
    let refused = found["unexplained"].as_array().expect("a list");
    for (what, joint) in &unknown {
        assert!(refused.iter().any(|left| left["joint"] == **joint), "{case}: {what} on {joint}");
    }
    assert!(!unknown.is_empty() || refused.is_empty(), "{case}: {refused:?}");
    for (joint, fit) in found["fit"].as_object().expect("a map") {
        let error = |key: &str| fit[key].as_f64().expect("a number");
        let [nominal, augmented] = [error("held_out_nrmse_nominal"), error("held_out_nrmse_augmented")];
        assert!(augmented <= nominal, "{case}: {joint} is worse: {nominal} → {augmented}");
    }
}

#[test]
#[ignore = "needs ../shared"]
fn baseline_friction_alone_is_left_at_that() {
    check("case_024");
}

#[test]
#[ignore = "needs ../shared"]
fn a_spring_on_the_shoulder_is_found() {
    check("case_011");
}

#[test]
#[ignore = "needs ../shared"]
fn a_force_and_a_turned_base_are_found_together() {
    check("case_014");
}

#[test]
#[ignore = "needs ../shared"]
fn a_dead_band_is_refused_on_its_joint() {
    check("case_015");
}
