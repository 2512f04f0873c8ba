//! `testbed prove --published`: recordings that the test makes and "publishes" what is in them; and the real ones, where they are.

use crate::diagnose_made::{Motion, SHOULDER, URDF, recording, trio};
use crate::support::{Sandbox, root};
use serde_json::Value;

const PUBLISHED: &str = r#"schema = "testbed.published/1"

[[robots]]
name = "trio"
title = "three joints"
urdf = "robot.urdf"
train = ["a.csv", "b.csv"]
held_out = ["c.csv"]
notes = ["The drag is ours."]

[robots.source]
authors = "nobody"
title = "made up"
url = "https://example.org/trio"
licence = "MIT"
files = "none"
converted = "not at all"

[[robots.says]]
effects = ["coulomb_friction"]
joints = ["shoulder", "elbow"]
parameters.level = { values = [2500.0, 1500.0], unit = "mN m" }
evidence = "number"
where = "table 1"

[[robots.says]]
effects = ["spring", "viscous_friction"]
joints = ["turn"]
evidence = "statement"
where = "chapter 2"

[[robots.denies]]
effects = ["quadratic_drag"]
joints = ["shoulder"]
where = "chapter 3"

[[robots]]
name = "elsewhere"
title = "not here"
urdf = "robot.urdf"
train = ["a.csv"]
held_out = ["b.csv"]
says = []
source = { authors = "a", title = "b", url = "c", licence = "d", files = "e", converted = "f" }
"#;

/// `data/trio`: Coulomb friction and drag on the shoulder, viscous friction on the turn, nothing on the elbow.
fn published() -> Sandbox {
    let sandbox = Sandbox::new();
    std::fs::create_dir_all(sandbox.path("data/trio")).expect("a folder");
    let physics = |motion: &Motion, tau: &mut [f64]| {
        let speed = motion.qd[SHOULDER];
        tau[SHOULDER] += 2.5 * speed.signum() + 4.0 * speed * speed.abs();
        tau[0] += 1.5 * motion.qd[0];
    };
    for (variant, file, seconds) in [(0, "a", 16.0), (1, "b", 16.0), (2, "c", 10.0)] {
        let text = recording(&trio(), variant, seconds, &physics);
        sandbox.write(&format!("data/trio/{file}.csv"), &text);
    }
    sandbox.write("data/trio/robot.urdf", URDF);
    sandbox.write("published.toml", PUBLISHED);
    sandbox
}

const COMMAND: [&str; 7] = ["prove", "--published", "published.toml", "--recordings", "data", "--out", "proof"];

fn bytes(sandbox: &Sandbox, name: &str) -> Vec<u8> {
    std::fs::read(sandbox.path(name)).expect("the file is there")
}

#[test]
fn recordings_are_sealed_diagnosed_and_held_against_what_is_published() {
    let sandbox = published();
    let command = [&COMMAND[..], &["--markdown", "real.md"]].concat();
    let printed = sandbox.succeed(&command);
    assert!(printed.contains("trio"), "{printed}");
    let proof = sandbox.json("proof/score.json");
    let score = &proof["robots"][0]["score"];
    let fates: Vec<&Value> = score["said"].as_array().expect("a list").iter().map(|said| &said["fate"]).collect();
    assert_eq!(fates[0], "named", "{score:#}");
    // Nothing is on the elbow: a statement about it is missed, or declared not to show.
    assert!(fates[1] == "missed" || fates[1] == "not_observable", "{score:#}");
    assert_eq!(fates[2], "named");
    let number = &score["said"][0]["numbers"][0];
    assert_eq!((&number["published"], &number["unit"]), (&2.5.into(), &"N m".into()));
    let difference = number["difference"].as_f64().expect("a number");
    assert!(difference.abs() < 0.05, "{difference}");
    // Viscous friction by name; the drag is there, but it is denied.
    let besides = score["besides"].as_array().expect("a list");
    let drag = besides.iter().find(|name| name["name"][0] == "quadratic_drag");
    assert_eq!(drag.expect("it is named")["contradicted_by"], "chapter 3");
    let errors = &score["held_out"]["shoulder"];
    for model in ["nominal", "diagnosed", "said", "learned"] {
        assert!(errors[model].is_f64(), "{model}: {errors}");
    }
    assert!(errors["diagnosed"].as_f64() < errors["said"].as_f64(), "{errors}");
    assert_eq!(proof["absent"], serde_json::json!(["elsewhere"]));
    let [page, markdown] =
        ["proof/report.html", "real.md"].map(|name| String::from_utf8(bytes(&sandbox, name)).expect("text"));
    let recording = proof["seal"]["cases"][0]["files"]["train_a.csv"].as_str().expect("a hash");
    for text in [&page, &markdown] {
        for needed in [
            "elsewhere",
            "https://example.org/trio",
            "The drag is ours.",
            "chapter 3",
            recording,
            "for only 1 of all (effect, joint) pairs",
            "are named; of the other 2, 1.",
            "--published published.toml --recordings data",
        ] {
            assert!(text.contains(needed), "there is no {needed}");
        }
        assert!(!text.contains("NaN"));
    }
    // Again: nothing is done anew, and the bytes are the same.
    let names = ["proof/score.json", "proof/report.html", "real.md"];
    let before = names.map(|name| bytes(&sandbox, name));
    sandbox.succeed(&[&command[..], &["--jobs", "1"]].concat());
    assert!(before == names.map(|name| bytes(&sandbox, name)), "the bytes differ");
    // Neither a recording nor a published value may change under seal.
    sandbox.write("published.toml", &PUBLISHED.replace("2500.0", "2600.0"));
    let refused = sandbox.refuse(&COMMAND);
    assert!(refused.contains("sealed file was changed"), "{refused}");
    sandbox.write("published.toml", PUBLISHED);
    sandbox.write("data/trio/c.csv", "t,q_turn,tau_turn\n0,0,0\n");
    let refused = sandbox.refuse(&COMMAND);
    assert!(refused.contains("data/trio/c.csv: differs from the copy"), "{refused}");
}

#[test]
fn a_robot_that_cannot_be_diagnosed_is_reported_and_all_of_it_missed() {
    let sandbox = published();
    sandbox.write("data/trio/c.csv", "t,q_turn,tau_turn\n0,nothing,0\n");
    sandbox.succeed(&[&COMMAND[..], &["--markdown", "real.md"]].concat());
    let robot = &sandbox.json("proof/score.json")["robots"][0];
    let error = robot["error"].as_str().expect("a reason");
    assert!(error.contains("c.csv"), "{error}");
    let said = robot["score"]["said"].as_array().expect("a list");
    assert!(said.iter().all(|said| said["fate"] == "missed"), "{said:?}");
    let markdown = String::from_utf8(bytes(&sandbox, "real.md")).expect("text");
    assert!(markdown.contains("There is no diagnosis: "), "{markdown}");
}

#[test]
fn what_cannot_be_is_refused_with_line_and_remedy() {
    let sandbox = published();
    let cases = [
        (
            "\"shoulder\", \"elbow\"",
            "\"shoulder\", \"elbo\"",
            "published.toml:21: the URDF has no joint \"elbo\"; did you mean \"elbow\"?",
        ),
        (
            "[\"coulomb_friction\"]",
            "[\"columb_friction\"]",
            "published.toml:20: there is no effect \"columb_friction\"; did you mean \"coulomb_friction\"?",
        ),
        (
            "\"mN m\"",
            "\"kg\"",
            "published.toml:22: \"kg\" is no unit of coulomb_friction\u{2019}s level here; give N m or mN m or kN m",
        ),
        ("[2500.0, 1500.0]", "[2500.0]", "published.toml:22: there are 1 values; give 2, one per joint"),
        ("parameters.level", "parameters.stiffness", "coulomb_friction has no \"stiffness\" to compare; it has level"),
        ("joints = [\"turn\"]\n", "", "spring is on a joint; add joints"),
        (
            "train = [\"a.csv\", \"b.csv\"]",
            "train = [\"a.csv\", \"d.csv\"]",
            "data/trio/d.csv: does not exist, and robot \"trio\" needs it; get it from https://example.org/trio",
        ),
        ("train = [\"a.csv\", \"b.csv\"]", "train = [\"a.csv\", \"c.csv\"]", "\"c.csv\" is given twice"),
        (
            "train = [\"a.csv\", \"b.csv\"]",
            "train = [\"a.csv\", \"b.txt\"]",
            "published.toml:3: recording \"b.txt\" does not end in .csv, and would be neither sealed nor fitted; rename it",
        ),
        ("testbed.published/1", "testbed.published/2", "published.toml:1: the schema is \"testbed.published/2\""),
        ("licence = \"MIT\"", "license = \"MIT\"", "unknown key `license`; did you mean `licence`?"),
    ];
    for (from, to, reason) in cases {
        assert!(PUBLISHED.contains(from), "{from}");
        sandbox.write("published.toml", &PUBLISHED.replacen(from, to, 1));
        let refused = sandbox.refuse(&COMMAND);
        assert!(refused.contains(reason), "{refused} is not {reason}");
        assert_eq!(refused.lines().count(), 1, "{refused}");
        assert!(!sandbox.path("proof").exists(), "a folder is left");
    }
    sandbox.write("published.toml", PUBLISHED);
    std::fs::create_dir_all(sandbox.path("empty")).expect("a folder");
    let refused = sandbox.refuse(&["prove", "--published", "published.toml", "--recordings", "empty"]);
    assert!(refused.contains("--recordings empty: has none of the folders trio, elsewhere"), "{refused}");
}

/// The repository's own file is read, whatever is beside the repository.
#[test]
fn the_real_recordings_file_is_read() {
    let sandbox = Sandbox::new();
    let file = root().join("docs/published.toml");
    let file = file.to_string_lossy();
    std::fs::create_dir_all(sandbox.path("data")).expect("a folder");
    let command = ["prove", "--published", &file, "--recordings", "data", "--out", "proof"];
    let refused = sandbox.refuse(&command);
    assert!(
        refused.contains("--recordings data: has none of the folders emps, tx40, kr300, iiwa14, gen3"),
        "{refused}"
    );
}

#[test]
#[ignore = "needs ../shared"]
fn the_real_linear_axis_has_the_friction_that_is_published() {
    let sandbox = Sandbox::new();
    let file = root().join("docs/published.toml");
    let file = file.to_string_lossy();
    let command = ["prove", "--published", &file, "--recordings", "data", "--out", "proof"];
    let shared = root().join("../shared/recordings/emps");
    std::fs::create_dir_all(sandbox.path("data/emps")).expect("a folder");
    for name in ["robot.urdf", "tracking.csv", "tracking_with_pulses.csv"] {
        std::fs::copy(shared.join(name), sandbox.path(&format!("data/emps/{name}"))).expect("it can be copied");
    }
    sandbox.succeed(&command);
    let proof = sandbox.json("proof/score.json");
    let said = proof["robots"][0]["score"]["said"].as_array().expect("a list");
    for (k, fate) in ["named", "same_torque", "same_torque"].into_iter().enumerate() {
        assert_eq!(said[k]["fate"], fate, "{:#}", said[k]);
        let difference = said[k]["numbers"][0]["difference"].as_f64().expect("a number");
        assert!(difference.abs() < 0.05, "{difference}");
    }
    assert_eq!(proof["absent"].as_array().map(Vec::len), Some(4));
}
