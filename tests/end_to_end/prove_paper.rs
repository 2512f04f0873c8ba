//! The paper's own disturbance as a case of `testbed prove`: one cause, its aliases, and a torque error that is rounding.

use crate::support::{Sandbox, words};
use serde_json::{Value, json};

#[test]
fn a_heavy_model_is_one_cause_and_its_correction_errs_by_rounding() {
    let sandbox = Sandbox::new();
    let command = words("prove --cases 0 --out proof --markdown proof.md --jobs 2");
    let printed = sandbox.succeed(&command);
    assert!(printed.contains("inertial_scale × 0.8333"), "{printed}");
    let proof = sandbox.json("proof/score.json");
    assert_eq!(proof["score"]["cases"], 0, "the score leaves it out");
    let sealed = &proof["seal"]["cases"];
    assert_eq!(sealed.as_array().map(Vec::len), Some(1));
    assert_eq!(sealed[0]["case"], "paper");
    assert!(proof["answers"]["paper"].is_string());

    let paper = &proof["paper"];
    assert_eq!(paper["findings"], json!([{"effect": "inertial_scale", "joint": null}]));
    assert_eq!(paper["is_one_finding"], true);
    let alias = |joint: usize| json!({"effect": "torque_scale", "joint": format!("joint{joint}")});
    let mut aliases = paper["aliases"].as_array().expect("a list").clone();
    aliases.sort_by_key(|alias| alias["joint"].to_string());
    assert_eq!(aliases, (1..=6).map(alias).collect::<Vec<Value>>());
    assert_eq!(paper["aliases_are_all_torque_scales"], true);
    let off = paper["factor"]["off"].as_f64().expect("a number");
    assert!(off.abs() < 2e-5, "{off}");
    assert_eq!(paper["factor"]["is_covered"], true);
    let mean = |errors: &Value| errors["mean"].as_f64().expect("a number");
    assert!(mean(&paper["diagnosed"]) < 1e-6, "{}", paper["diagnosed"]);
    assert_eq!(paper["is_rounding"], true);
    let others = paper["others"].as_array().expect("a list");
    assert_eq!(others.len(), 6);
    assert!(others.iter().all(|model| mean(model) > 1e4 * mean(&paper["diagnosed"])));

    // A robot's logger knows no parts of the torque, and a URDF does not say what is wrong with it.
    let recording = std::fs::read_to_string(sandbox.path("proof/cases/paper/train_1.csv")).expect("it is there");
    let header = recording.lines().next().expect("a header");
    assert!(header.split(',').all(|name| {
        ["t", "q_joint", "qd_joint", "tau_joint"].contains(&name.trim_end_matches(|end: char| end.is_ascii_digit()))
    }));
    let urdf = std::fs::read_to_string(sandbox.path("proof/cases/paper/robot.urdf")).expect("it is there");
    assert!(!urdf.contains("Corrected"));
    for name in ["proof/report.html", "proof.md"] {
        let text = std::fs::read_to_string(sandbox.path(name)).expect("it is there");
        assert!(text.contains("own disturbance") && !text.contains("NaN"), "{name}");
    }

    // A share has it as any case, and merged it is the whole.
    sandbox.succeed(&["prove", "--cases", "0", "--out", "shares", "--shard", "1/1"]);
    sandbox.succeed(&["prove", "--merge", "shares", "--out", "merged"]);
    for name in ["score.json", "report.html"] {
        let [whole, merged] = ["proof", "merged"].map(|folder| {
            let path = sandbox.path(&format!("{folder}/{name}"));
            std::fs::read(path).expect("the file is there")
        });
        assert!(whole == merged, "{name} differs");
    }
}
