//! `testbed conceal` through the program: cases that a diagnosis reads, and what is refused.

use crate::support::{Sandbox, words};

/// A spring that is no straight line, on an arm that the user brings.
const EFFECTS: &str = r#"schema = "testbed.model/1"

[[effects]]
effect = "spring"
joint = "elbow"
stiffness = 4.0
rest = 0.1
form = "hardening"

[[effects]]
effect = "payload"
mass = 1.0
com = [0.0, 0.0, 0.1]
onset = 12.0
"#;

/// The diagnosis of the first case.
fn diagnosed(sandbox: &Sandbox) -> serde_json::Value {
    let file = |name: &str| format!("cases/case_000/{name}");
    let (robot, held_out) = (file("robot.urdf"), file("held_out.csv"));
    let train: Vec<String> = (1..=3).map(|k| file(&format!("train_{k}.csv"))).collect();
    sandbox.succeed(&[
        "diagnose",
        "--robot",
        &robot,
        "--train",
        &train[0],
        &train[1],
        &train[2],
        "--held-out",
        &held_out,
        "--json",
        "out.json",
    ]);
    sandbox.json("out.json")
}

#[test]
fn what_is_injected_is_found() {
    let sandbox = Sandbox::new();
    sandbox.write("trio.urdf", crate::diagnose_made::URDF);
    let text = EFFECTS.split("\n[[effects]]\neffect = \"payload\"").next().unwrap_or(EFFECTS);
    sandbox.write("spring.toml", text);
    let arguments = words("conceal --robot trio.urdf --effects spring.toml --out cases");
    let printed = sandbox.succeed(&arguments);
    assert!(printed.contains("cases/truth/case_000.json"), "{printed}");
    assert_eq!(
        sandbox.list("cases/case_000"),
        ["held_out.csv", "robot.urdf", "train_1.csv", "train_2.csv", "train_3.csv"]
    );
    let truth = sandbox.json("cases/truth/case_000.json");
    let spring = &truth["concealed"][0];
    assert_eq!((&spring["effect"], &spring["form"]), (&"spring".into(), &"hardening".into()));
    assert!(spring["expressed_share"].as_f64().is_some_and(|share| share > 0.03), "{spring}");

    // A second time nothing is touched.
    let refused = sandbox.refuse(&arguments);
    assert!(refused.contains("nothing is overwritten"), "{refused}");

    let found = diagnosed(&sandbox);
    let findings = found["findings"].as_array().expect("there is a list");
    let named: Vec<String> =
        findings.iter().map(|finding| format!("{} {}", finding["effect"], finding["joint"])).collect();
    assert_eq!(named, ["\"spring\" \"elbow\""], "{found}");
}

#[test]
fn the_same_seed_makes_the_same_bytes() {
    let sandbox = Sandbox::new();
    sandbox.write("trio.urdf", crate::diagnose_made::URDF);
    for (out, jobs) in [("one", "1"), ("two", "2")] {
        sandbox.succeed(&words(&format!("conceal --robot trio.urdf --seed 2 --cases 2 --jobs {jobs} --out {out}")));
    }
    let read = |path: &str| std::fs::read(sandbox.path(path)).expect("the file is there");
    for case in sandbox.list("one/truth") {
        assert_eq!(read(&format!("one/truth/{case}")), read(&format!("two/truth/{case}")));
        let name = case.trim_end_matches(".json");
        for file in sandbox.list(&format!("one/{name}")) {
            assert_eq!(read(&format!("one/{name}/{file}")), read(&format!("two/{name}/{file}")), "{name}/{file}");
        }
    }
    assert_eq!(sandbox.list("one").len(), 3);
}

#[test]
fn what_cannot_be_concealed_is_refused_with_its_line() {
    let sandbox = Sandbox::new();
    let refuse = |text: &str, part: &str| {
        sandbox.write("effects.toml", text);
        let error = sandbox.refuse(&words("conceal --robot seven_axis --effects effects.toml --out cases"));
        assert!(error.contains(part), "{error}");
    };
    refuse(&EFFECTS.replace("elbow", "axis9"), "effects.toml:5");
    refuse(&EFFECTS.replace("elbow", "axis4").replace("hardening", "air spring"), "gas spring, hardening, knee");
    refuse(&EFFECTS.replace("elbow", "axis4").replace("mass = 1.0\n", ""), "mass");
    refuse(&EFFECTS.replace("stiffness", "stifness"), "effects.toml:6");
    let onset = |time: &str| EFFECTS.replace("elbow", "axis4").replace("12.0", time);
    refuse(&onset("nan"), "onset is nan; give a number");
    refuse(&onset("1e9"), "the recordings are from 0 to 115 s");
    refuse(&onset("-1.0"), "the recordings are from 0 to 115 s");
    let offset = "\n[[effects]]\neffect = \"torque_offset\"\njoint = \"axis2\"\noffset = 1.0\n";
    refuse(&(onset("12.0") + offset + offset), "given twice");
    let power = "\n[[effects]]\neffect = \"viscous_friction\"\njoint = \"axis2\"\ncoefficient = 1.0\nexponent = 0.5\n";
    refuse(&(onset("12.0") + power), "exponent belongs to a form");
    let error = sandbox.refuse(&["conceal", "--out", "cases"]);
    assert!(error.contains("--seed") || error.contains("--effects"), "{error}");
    let error = sandbox.refuse(&["conceal", "--robot", "puma650", "--seed", "1", "--out", "cases"]);
    assert!(error.contains("did you mean \"puma560\""), "{error}");
    assert!(sandbox.list("cases").is_empty());
}

#[test]
fn without_effects_or_seed_both_are_offered() {
    let message = Sandbox::new().refuse(&["conceal", "--out", "made"]);
    assert!(message.contains("--seed N") && message.contains("--effects FILE"), "{message}");
}

/// Where all links are wrong, a mass at the wrist's centre, which the last joints do not feel, may be any link's before them: it was
/// called a payload of 1.5 kg.
#[test]
fn a_wrong_link_before_the_wrist_is_no_payload() {
    let sandbox = Sandbox::new();
    let friction = "schema = \"testbed.model/1\"\n\n[[effects]]\neffect = \"viscous_friction\"\njoint = \"joint4\"\ncoefficient = 0.05\n";
    sandbox.write("friction.toml", friction);
    sandbox.succeed(&words(
        "conceal --robot puma560 --effects friction.toml --urdf-error 0.3 --friction --seed 3 --out cases",
    ));
    let diagnosis = diagnosed(&sandbox);
    let findings = diagnosis["findings"].as_array().expect("there are findings");
    let names: Vec<&str> = findings.iter().filter_map(|finding| finding["effect"].as_str()).collect();
    assert!(names.contains(&"inertial_parameters"), "{names:?}");
    assert!(!names.contains(&"payload"), "{names:?}");
}

/// A constant torque on an arm whose URDF is wrong by 20 %: the search exchanges a payload for links that explain hardly more, and the final
/// fit drops these.
#[test]
fn an_effect_that_was_exchanged_is_tried_again_once() {
    let sandbox = Sandbox::new();
    sandbox.write("trio.urdf", crate::diagnose_made::URDF);
    let offset =
        "schema = \"testbed.model/1\"\n[[effects]]\neffect = \"torque_offset\"\njoint = \"turn\"\noffset = 0.25\n";
    sandbox.write("offset.toml", offset);
    let made = "conceal --robot trio.urdf --effects offset.toml --seed 109 --friction --urdf-error 0.2 --out cases";
    sandbox.succeed(&words(made));
    let case = |name: &str| format!("cases/case_000/{name}");
    let [robot, one, two, three, held_out] =
        ["robot.urdf", "train_1.csv", "train_2.csv", "train_3.csv", "held_out.csv"].map(case);
    let train = ["--train", &one, &two, &three, "--held-out", &held_out];
    sandbox
        .succeed(&[&["diagnose", "--robot", &robot][..], &train, &["--torques-only", "--trace", "trace.csv"]].concat());
    let trace = std::fs::read_to_string(sandbox.path("trace.csv")).expect("it was written");
    let taken = trace.lines().filter(|line| line.contains("the effect that had taken its place is dropped")).count();
    assert_eq!(taken, 1, "{trace}");
}

/// A hand whose centre of mass is 3 cm from the URDF's: the search puts a payload in the place of this error, which no body can be in the
/// end. The hand is named nevertheless.
#[test]
fn a_wrong_hand_is_named_though_a_payload_took_its_place() {
    let sandbox = Sandbox::new();
    let friction =
        "schema = \"testbed.model/1\"\n[[effects]]\neffect = \"coulomb_friction\"\njoint = \"axis7\"\nlevel = 0.02\n";
    sandbox.write("friction.toml", friction);
    sandbox.succeed(&words("conceal --robot seven_axis --effects friction.toml --seed 1 --friction --out cases"));
    let urdf = std::fs::read_to_string(sandbox.path("cases/case_000/robot.urdf")).expect("it was written");
    let moved = urdf.replace("\"0.012 -0.008 0.055\"", "\"0.02301 -0.00155 0.02785\"");
    assert_ne!(moved, urdf, "the hand has another centre of mass");
    sandbox.write("cases/case_000/robot.urdf", &moved);
    let found = diagnosed(&sandbox);
    let findings = found["findings"].as_array().expect("a list");
    let friction = ["coulomb_friction", "viscous_friction"];
    let special: Vec<(&str, Option<&str>)> = findings
        .iter()
        .map(|finding| (finding["effect"].as_str().unwrap_or_default(), finding["joint"].as_str()))
        .filter(|(effect, _)| !friction.contains(effect))
        .collect();
    assert_eq!(special, [("inertial_parameters", Some("axis7"))], "{found}");
}
