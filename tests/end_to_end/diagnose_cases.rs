//! `testbed diagnose` on the cases that come with the repository (`tests/cases`): what the truth says is found, and nothing else.

use serde_json::Value;

use crate::diagnose_blind::compare;
use crate::support::{Sandbox, root};

/// The path of a file of the cases.
fn path(name: &str) -> String {
    root().join("tests/cases").join(name).to_string_lossy().into_owned()
}

/// Diagnoses a case, and checks it against its truth; the diagnosis.
fn check(case: &str) -> Value {
    let robot = path("arm.urdf");
    let [train, held_out, truth] =
        ["train_1.csv", "held_out.csv", "truth.json"].map(|name| path(&format!("{case}/{name}")));
    let sandbox = Sandbox::new();
    let inputs = ["diagnose", "--robot", &robot, "--train", &train, "--held-out", &held_out];
    sandbox.succeed(&[&inputs[..], &["--torques-only", "--json", "d.json"]].concat());
    let found = sandbox.json("d.json");
    let text = std::fs::read_to_string(truth).expect("the truth is there");
    compare(case, &serde_json::from_str(&text).expect("it is JSON"), &found);
    found
}

/// Checks that parameters are within a part `tolerance` of the truth.
fn is_sized(found: &Value, effect: &str, truth: &[(&str, f64)], tolerance: f64) {
    let mut findings = found["findings"].as_array().expect("a list").iter();
    let finding = findings.find(|finding| finding["effect"] == effect).expect("it is there");
    for (key, truth) in truth {
        let value = finding["parameters"][key]["value"].as_f64().expect("a number");
        assert!((value / truth - 1.0).abs() < tolerance, "{key}: {value} instead of {truth}");
    }
}

/// Checks that the 95 % interval of a parameter contains the true value and not zero, and is no wider than three quarters of it to either side:
/// where the background acts, the interval allows a URDF that is unevenly wrong.
fn holds(found: &Value, effect: &str, key: &str, truth: f64) {
    let mut findings = found["findings"].as_array().expect("a list").iter();
    let finding = findings.find(|finding| finding["effect"] == effect).expect("it is there");
    let end = |k: usize| finding["parameters"][key]["ci95"][k].as_f64().expect("a number");
    assert!(
        end(0) < truth && truth < end(1) && end(0) * truth > 0.0 && end(1) - end(0) < 1.5 * truth.abs(),
        "{key}: from {} to {} instead of {truth}",
        end(0),
        end(1)
    );
}

#[test]
fn baseline_friction_is_all_that_there_is() {
    let found = check("friction");
    assert_eq!(found["findings"].as_array().map(Vec::len), Some(6));
}

#[test]
fn a_spring_and_a_payload_are_found_together() {
    let found = check("spring_and_payload");
    is_sized(&found, "spring", &[("stiffness", 6.0)], 0.1);
    // The motion determines the payload's first moments better than its mass.
    holds(&found, "payload", "mass", 1.0);
}

#[test]
fn a_push_has_its_time() {
    let found = check("contact");
    is_sized(&found, "external_contact", &[("start", 12.0), ("duration", 1.5)], 0.1);
}

#[test]
fn a_gap_has_its_size() {
    let found = check("backlash");
    is_sized(&found, "backlash", &[("halfgap", 0.012)], 0.15);
}

#[test]
fn friction_that_fades_is_warming() {
    let found = check("warming");
    is_sized(&found, "thermal_drift", &[("coulomb", 2.0), ("amplitude", 1.5)], 0.2);
}

#[test]
fn what_is_outside_the_catalogue_gets_no_name() {
    check("outside_the_catalogue");
}

/// Recordings of two cases with different loads: the answer begins with it, and names the folders that distinguish the files.
#[test]
fn recordings_with_another_load_come_first() {
    let [robot, loaded, train, held_out] =
        ["arm.urdf", "spring_and_payload/train_1.csv", "friction/train_1.csv", "friction/held_out.csv"].map(path);
    let sandbox = Sandbox::new();
    let inputs = ["diagnose", "--robot", &robot, "--train", &loaded, &train, "--held-out", &held_out];
    let text = sandbox.succeed(&[&inputs[..], &["--torques-only", "--json", "d.json"]].concat());
    let load = &sandbox.json("d.json")["different_load"];
    assert_eq!(load["recordings"], serde_json::json!([loaded]));
    let end = |k: usize| load["more_than_others"]["ci95"][k].as_f64().expect("a number");
    assert!(end(0) < 1.0 && 1.0 < end(1), "{load}");
    assert!(text.starts_with("spring_and_payload/train_1.csv was made with"), "{text}");
}

/// What changed since the recordings from before is told in the first sentence, in both directions, and the corrected model of today
/// explains the recordings of today: it has what is new, without an onset, and not what is gone.
#[test]
fn the_corrected_model_is_that_of_today() {
    let robot = path("arm.urdf");
    for (before, today, phrase, change, has_payload) in [
        ("friction", "spring_and_payload", "absent in the recordings from", "added", true),
        ("spring_and_payload", "friction", "in the recordings from before", "removed", false),
    ] {
        let [before, train, held_out] =
            [format!("{before}/train_1.csv"), format!("{today}/train_1.csv"), format!("{today}/held_out.csv")]
                .map(|name| path(&name));
        let sandbox = Sandbox::new();
        let inputs = ["--robot", &robot, "--train", &train, "--held-out", &held_out, "--torques-only"];
        let run = |further: &[&str]| sandbox.succeed(&[&["diagnose"], &inputs[..], further].concat());
        let told = run(&["--before", &before, "--json", "d.json", "--model", "m.toml"]);
        let told = told.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(told.starts_with("Changed since the recordings from before:"), "{told}");
        assert!(told.contains(phrase), "{told}");
        let found = sandbox.json("d.json");
        let changed: Vec<&str> = found["findings"]
            .as_array()
            .expect("a list")
            .iter()
            .filter(|finding| finding["change"] == change)
            .filter_map(|finding| finding["effect"].as_str())
            .collect();
        assert_eq!(changed, ["spring", "payload"], "{told}");
        let model = std::fs::read_to_string(sandbox.path("m.toml")).expect("it is written");
        assert_eq!(model.contains("\"payload\""), has_payload, "{model}");
        assert_eq!(model.contains("\"spring\""), has_payload, "{model}");
        assert!(!model.contains("onset"), "{model}");
        let again = run(&["--known", "m.toml"]);
        assert!(again.contains("no unmodelled effect is detectable"), "{again}");
    }
}
