//! `testbed diagnose` on recordings that the test makes: what is injected is found, modelled and proved; what is not
//! there, or has no name, is not named.

use crate::diagnose_made::{Case, ELBOW, Motion, SHOULDER, TURN, finding, is_found, names, trio};
use crate::support::words;
use serde_json::Value;

/// Coulomb and viscous friction on the shoulder.
fn friction(motion: &Motion, tau: &mut [f64]) {
    let speed = motion.qd[SHOULDER];
    tau[SHOULDER] += 2.5 * speed.signum() + 1.8 * speed;
}

fn pairs<'a>(list: &[(&'a str, &'a str)]) -> Vec<(String, String)> {
    list.iter().map(|(effect, joint)| ((*effect).to_owned(), (*joint).to_owned())).collect()
}

/// The held-out error of a joint, nominal and augmented.
fn held_out(diagnosis: &Value, joint: &str) -> [f64; 2] {
    let fit = &diagnosis["fit"][joint];
    ["held_out_nrmse_nominal", "held_out_nrmse_augmented"].map(|key| fit[key].as_f64().expect("a number"))
}

#[test]
fn friction_is_named_with_its_size_and_proved_on_the_recording_held_out() {
    let case = Case::new(&trio(), &friction);
    let printed = case.diagnose(&["--json", "d.json"]);
    for part in ["viscous friction", "Coulomb friction", "shoulder", "written: d.json"] {
        assert!(printed.contains(part), "\"{part}\" is missing from {printed}");
    }
    let found = case.sandbox.json("d.json");
    assert_eq!(found["verdict"], "explained");
    let expected = pairs(&[("coulomb_friction", "shoulder"), ("viscous_friction", "shoulder")]);
    assert_eq!(names(&found), expected);
    is_found(finding(&found, "coulomb_friction", "shoulder"), "level", 2.5, 0.03);
    is_found(finding(&found, "viscous_friction", "shoulder"), "coefficient", 1.8, 0.03);
    let [nominal, augmented] = held_out(&found, "shoulder");
    assert!(augmented < 0.1 * nominal, "{nominal} → {augmented}");
    for joint in ["turn", "shoulder", "elbow"] {
        let [nominal, augmented] = held_out(&found, joint);
        assert!(augmented <= nominal, "{joint} is worse: {nominal} → {augmented}");
        let rollout = &found["rollout"][joint];
        let [nominal, augmented] = ["nominal_rms_rad", "augmented_rms_rad"].map(|key| rollout[key].as_f64());
        assert!(augmented < nominal, "simulated {joint}: {nominal:?} → {augmented:?}");
    }
}

#[test]
fn the_json_has_the_fields_that_others_read() {
    let case = Case::new(&trio(), &friction);
    let found = case.json(&[]);
    assert_eq!(found["schema"], "testbed.diagnosis/1");
    assert_eq!(found["robot"], "trio");
    assert_eq!(found["recordings"]["train"], serde_json::json!(["a.csv", "b.csv"]));
    assert_eq!(found["recordings"]["held_out"], serde_json::json!(["c.csv"]));
    for list in ["findings", "unexplained", "not_observable"] {
        assert!(found[list].is_array(), "{list}");
    }
    let shoulder = finding(&found, "coulomb_friction", "shoulder");
    for number in ["probability", "share", "held_out_gain"] {
        let value = shoulder[number].as_f64().expect("a number");
        assert!(value > 0.0 && value <= 1.0, "{number} is {value}");
    }
    assert_eq!(shoulder["parameters"]["level"]["unit"], "N m");
    assert!(shoulder["confusable_with"].is_array());
    assert!(shoulder["where"]["time"].is_array());
    for entry in found["not_observable"].as_array().expect("a list") {
        assert!(entry["effect"].is_string() && entry["because"].is_string());
        assert!(entry["would_be_seen_above"].is_object());
    }
    for joint in ["turn", "shoulder", "elbow"] {
        for number in
            ["torque_std", "noise", "held_out_nrmse_nominal", "held_out_nrmse_augmented", "held_out_nrmse_learned"]
        {
            assert!(found["fit"][joint][number].is_f64(), "{number} of {joint}");
        }
    }
    let noise = found["fit"]["elbow"]["noise"].as_f64().expect("a number");
    assert!(noise < 0.03, "the noise of .02 N m is taken for {noise}");
}

#[test]
fn the_corrected_model_is_written_read_back_and_leaves_nothing_to_find() {
    let case = Case::new(&trio(), &friction);
    let found = case.json(&words("--model model.toml --urdf corrected.urdf --report page.html"));
    let model: toml::Table = case.text("model.toml").parse().expect("it is TOML");
    assert_eq!(model["schema"].as_str(), Some("testbed.model/1"));
    assert_eq!(model["robot"].as_str(), Some("trio"));
    let effects = model["effects"].as_array().expect("a list");
    assert_eq!(effects.len(), 2);
    for effect in effects {
        let (parameter, name) = match effect["effect"].as_str() {
            Some("coulomb_friction") => ("level", "coulomb_friction"),
            _ => ("coefficient", "viscous_friction"),
        };
        let said = finding(&found, name, "shoulder")["parameters"][parameter]["value"].as_f64();
        assert_eq!(effect[parameter].as_float(), said);
    }
    let urdf = case.text("corrected.urdf");
    let dynamics = urdf.lines().find(|line| line.contains("<dynamics")).expect("a line of friction");
    assert!(dynamics.contains("damping=\"1.8") || dynamics.contains("damping=\"1.7"), "{dynamics}");
    assert!(dynamics.contains("friction=\"2."), "{dynamics}");
    arm::Arm::from_urdf(case.path("corrected.urdf")).expect("it is an arm still");
    let page = case.text("page.html");
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("Coulomb friction") && page.contains("shoulder"));
    for outside in ["src=\"http", "href=\"http", "<link", "@import", "url(http", "fetch("] {
        assert!(!page.contains(outside), "the page needs {outside}");
    }
    let again = case.json(&["--known", "model.toml"]);
    assert_eq!(names(&again), []);
    assert_eq!(again["verdict"], "no_mismatch");
    // What is known is in the corrected model still.
    case.diagnose(&["--known", "model.toml", "--model", "model2.toml"]);
    assert_eq!(case.text("model2.toml"), case.text("model.toml"));
}

#[test]
fn two_runs_give_the_same_bytes_whatever_the_threads() {
    let case = Case::new(&trio(), &friction);
    let run = |name: &str, jobs: &str| {
        let files = ["json", "html", "toml"].map(|kind| format!("{name}.{kind}"));
        case.diagnose(&["--json", &files[0], "--report", &files[1], "--model", &files[2], "--jobs", jobs]);
        files.map(|file| case.text(&file))
    };
    let first = run("one", "1");
    assert!(first == run("two", "2"), "one thread and two differ");
    assert!(first == run("again", "2"), "two runs differ");
}

#[test]
fn a_spring_is_distinguished_from_gravity() {
    let case = Case::new(&trio(), &|motion, tau| {
        friction(motion, tau);
        tau[ELBOW] += 14.0 * (motion.q[ELBOW] - 0.4) + 0.8 * motion.qd[ELBOW];
    });
    let found = case.json(&[]);
    let expected = [
        ("coulomb_friction", "shoulder"),
        ("spring", "elbow"),
        ("viscous_friction", "elbow"),
        ("viscous_friction", "shoulder"),
    ];
    assert_eq!(names(&found), pairs(&expected));
    let spring = finding(&found, "spring", "elbow");
    is_found(spring, "stiffness", 14.0, 0.04);
    is_found(spring, "rest", 0.4, 0.05);
    let [nominal, augmented] = held_out(&found, "elbow");
    assert!(augmented < 0.1 * nominal, "{nominal} → {augmented}");
}

#[test]
fn a_payload_is_weighed() {
    let tool = trio().tool_frame();
    let payload = arm::Inertia {
        mass: 1.2,
        com: arm::Vector3::new(0.25, 0.0, 0.06),
        tensor: arm::Matrix3::from_diagonal(&arm::Vector3::new(0.004, 0.004, 0.004)),
    };
    assert_eq!(tool.link, Some(ELBOW));
    let case = Case::new(&trio().with_payload(&payload), &friction);
    let found = case.json(&[]);
    let list = names(&found);
    let named = |effect: &str| list.iter().any(|(found, _)| found == effect);
    assert!(named("payload"), "{list:?}");
    assert_eq!(list.len(), 3, "{list:?}");
    let findings = found["findings"].as_array().expect("a list");
    let payload = findings.iter().find(|finding| finding["effect"] == "payload").expect("it is there");
    assert!(payload["joint"].is_null());
    is_found(payload, "mass", 1.2, 0.1);
}

#[test]
fn where_nothing_is_injected_nothing_is_named() {
    let case = Case::new(&trio(), &|_, _| {});
    let found = case.json(&["--model", "model.toml"]);
    assert_eq!(found["verdict"], "no_mismatch");
    assert_eq!(names(&found), []);
    assert_eq!(found["unexplained"], serde_json::json!([]));
    let printed = case.diagnose(&[]);
    assert!(printed.starts_with("The model explains the recordings"), "{printed}");
    let model: toml::Table = case.text("model.toml").parse().expect("it is TOML");
    assert!(model.get("effects").is_none());
}

#[test]
fn what_the_catalogue_lacks_gets_no_name() {
    let case = Case::new(&trio(), &|motion, tau| {
        friction(motion, tau);
        tau[ELBOW] += 2.0 * (3.0 * motion.q[TURN]).cos();
    });
    let found = case.json(&[]);
    assert_eq!(found["verdict"], "partly_explained");
    let expected = pairs(&[("coulomb_friction", "shoulder"), ("viscous_friction", "shoulder")]);
    assert_eq!(names(&found), expected);
    let unexplained = found["unexplained"].as_array().expect("a list");
    assert_eq!(unexplained.len(), 1, "{unexplained:?}");
    assert_eq!(unexplained[0]["joint"], "elbow");
    assert_eq!(unexplained[0]["depends_on"][0], "other_joint:turn");
    assert!(unexplained[0]["share"].as_f64().is_some_and(|share| share > 0.05));
}

#[test]
fn a_few_seconds_are_not_enough() {
    let case = Case::new(&trio(), &friction);
    let text = case.text("a.csv");
    let start: Vec<&str> = text.lines().take(500).collect();
    case.sandbox.write("short.csv", &(start.join("\n") + "\n"));
    let arguments = words("diagnose --robot robot.urdf --train short.csv --json d.json");
    let printed = case.sandbox.succeed(&arguments);
    assert!(printed.contains("not enough data: "), "{printed}");
    let found = case.sandbox.json("d.json");
    assert_eq!(found["verdict"], "not_enough_data");
    assert_eq!(found["unexplained"], serde_json::json!([]));
}
