//! `testbed prove` on two cases that the test makes: sealed, diagnosed, opened and scored; resumed without loss; nothing
//! changed under seal.

use crate::diagnose_made::{Motion, SHOULDER, URDF, recording, trio};
use crate::support::{Sandbox, words};
use serde_json::{Value, json};

/// The folders `given/case_a` (friction and drag on the shoulder), `given/case_b` (nothing), and their truths.
fn cases() -> Sandbox {
    let sandbox = Sandbox::new();
    let drag = |motion: &Motion, tau: &mut [f64]| {
        let speed = motion.qd[SHOULDER];
        tau[SHOULDER] += 2.5 * speed.signum() + 4.0 * speed * speed.abs();
    };
    let injected = json!([
        {"effect": "coulomb_friction", "joint": "shoulder", "level": 2.5},
        {"effect": "quadratic_drag", "joint": "shoulder", "coefficient": 4.0, "expressed_share": 0.1},
    ]);
    let nothing = |_: &Motion, _: &mut [f64]| {};
    for (name, physics, injected) in
        [("case_a", &drag as &dyn Fn(&Motion, &mut [f64]), injected), ("case_b", &nothing, json!([]))]
    {
        std::fs::create_dir_all(sandbox.path(&format!("given/{name}"))).expect("a folder");
        std::fs::create_dir_all(sandbox.path("given/truth")).expect("a folder");
        sandbox.write(&format!("given/{name}/robot.urdf"), URDF);
        for (variant, file, seconds) in [(0, "train_1", 16.0), (1, "train_2", 16.0), (2, "held_out", 10.0)] {
            let text = recording(&trio(), variant, seconds, physics);
            sandbox.write(&format!("given/{name}/{file}.csv"), &text);
        }
        let truth = json!({"case": name, "robot": "trio", "seed": 1, "concealed": injected,
            "background_friction": false, "torque_noise": [0.02, 0.02, 0.02]});
        sandbox.write(&format!("given/truth/{name}.json"), &truth.to_string());
    }
    sandbox
}

const COMMAND: [&str; 5] = ["prove", "--cases-from", "given", "--out", "proof"];

fn bytes(sandbox: &Sandbox, name: &str) -> Vec<u8> {
    std::fs::read(sandbox.path(name)).expect("the file is there")
}

fn target<'a>(proof: &'a Value, what: &str) -> &'a Value {
    let targets = proof["score"]["targets"].as_array().expect("a list");
    targets
        .iter()
        .find(|target| target["what"].as_str().is_some_and(|name| name.starts_with(what)))
        .expect("the target is there")
}

#[test]
fn cases_are_sealed_diagnosed_opened_and_scored_and_nothing_is_done_twice() {
    let sandbox = cases();
    let printed = sandbox.succeed(&[&COMMAND[..], &["--markdown", "proof.md"]].concat());
    assert!(printed.contains("macro F1"), "{printed}");
    let proof = sandbox.json("proof/score.json");
    assert_eq!(proof["schema"], "testbed.proof/1");
    assert_eq!(proof["score"]["cases"], 2);
    assert_eq!(target(&proof, "macro F1")["figure"], 1.0, "{:#}", proof["score"]["concealed"]);
    assert_eq!(target(&proof, "empty")["reached"], true);
    let error = proof["score"]["main_parameters"]["median"].as_f64().expect("a number");
    assert!(error < 0.03, "{error}");
    for model in ["nominal", "diagnosed", "true_terms", "wrong_term", "learned"] {
        assert!(proof["score"]["held_out"][0][model].is_f64(), "{model}");
    }
    let over = target(&proof, "held-out error over the true terms’, median")["figure"].as_f64();
    assert!(over.is_some_and(|over| over < 1.05), "{over:?}");
    // The seal is what sha256sum says.
    let sums = String::from_utf8(bytes(&sandbox, "proof/SHA256SUMS")).expect("text");
    assert_eq!(sums.lines().count(), 1 + 2 * 5);
    assert_eq!(proof["seal"], sandbox.json("proof/seal.json"));
    let page = String::from_utf8(bytes(&sandbox, "proof/report.html")).expect("text");
    let markdown = String::from_utf8(bytes(&sandbox, "proof.md")).expect("text");
    for text in [&page, &markdown] {
        assert!(text.contains(proof["seal"]["whole"].as_str().expect("a hash")));
        assert!(!text.contains("NaN"));
    }
    for foreign in ["http:", "https:", "src=", "url(", "<script", "<link"] {
        assert!(!page.contains(foreign), "the page has {foreign}");
    }
    // Again: nothing is done anew, and the result is the same. One diagnosis lost is made again.
    let outputs = ["proof/score.json", "proof/report.html", "proof.md"].map(|name| bytes(&sandbox, name));
    std::fs::remove_file(sandbox.path("proof/diagnoses/case_a.json")).expect("it is there");
    let modified = |name: &str| {
        let file = std::fs::metadata(sandbox.path(name)).expect("it is there");
        file.modified().expect("a time")
    };
    let before = modified("proof/diagnoses/case_b.json");
    sandbox.succeed(&[&COMMAND[..], &["--markdown", "proof.md", "--jobs", "1"]].concat());
    assert_eq!(modified("proof/diagnoses/case_b.json"), before);
    let again = ["proof/score.json", "proof/report.html", "proof.md"].map(|name| bytes(&sandbox, name));
    assert!(outputs == again, "the same cases give the same bytes");
    // What is under seal may not change.
    let truth = String::from_utf8(bytes(&sandbox, "given/truth/case_b.json")).expect("text");
    sandbox.write("given/truth/case_b.json", &truth.replace("\"seed\":1", "\"seed\":2"));
    let refused = sandbox.refuse(&COMMAND);
    assert!(refused.contains("sealed file was changed"), "{refused}");
    sandbox.write("given/truth/case_b.json", &truth);
    let answer = String::from_utf8(bytes(&sandbox, "proof/diagnoses/case_b.json")).expect("text");
    sandbox.write("proof/diagnoses/case_b.json", &answer.replace("trio", "duo"));
    // A diagnosis that was touched is made again.
    sandbox.succeed(&COMMAND);
    assert_eq!(bytes(&sandbox, "proof/diagnoses/case_b.json"), answer.as_bytes());
}

#[test]
fn a_case_that_cannot_be_diagnosed_is_an_answer_that_is_missing() {
    let sandbox = cases();
    sandbox.write("given/case_b/train_2.csv", "t,q_turn\n0,nothing\n");
    sandbox.succeed(&COMMAND);
    let proof = sandbox.json("proof/score.json");
    assert_eq!(proof["score"]["unanswered"], json!(["case_b"]));
    assert_eq!(proof["answers"]["case_b"], Value::Null);
    // The report states it at the start, and the empty case does not count as one without false names.
    let page = String::from_utf8(bytes(&sandbox, "proof/report.html")).expect("text");
    assert!(page.contains("Cases without an answer: 1 (case_b)"));
    assert_eq!(target(&proof, "empty")["reached"], Value::Null);
    assert_eq!(proof["score"]["empty"], 1);
}

#[test]
fn cases_without_truths_are_refused() {
    let sandbox = cases();
    let refused = sandbox.refuse(&words("prove --cases-from given --truth given/case_a --out proof"));
    assert!(refused.contains("--truth"), "{refused}");
}

#[test]
fn shares_merged_are_the_whole() {
    let sandbox = cases();
    sandbox.succeed(&COMMAND);
    let share = |number: &'static str| [&COMMAND[..3], &["--out", "shares", "--shard", number]].concat();
    sandbox.succeed(&share("2/2"));
    let merge = ["prove", "--merge", "shares", "--out", "merged"];
    let refused = sandbox.refuse(&merge);
    assert!(refused.contains("parts 1 of 2 are missing"), "{refused}");
    sandbox.succeed(&share("1/2"));
    sandbox.succeed(&merge);
    for name in ["score.json", "report.html"] {
        let [whole, merged] = ["proof", "merged"].map(|folder| bytes(&sandbox, &format!("{folder}/{name}")));
        assert!(whole == merged, "{name} differs");
    }
}

#[test]
fn a_truth_that_cannot_be_read_is_reported_before_anything_is_diagnosed() {
    let sandbox = cases();
    sandbox.write("given/truth/case_b.json", "{\"case\": \"case_b\"}");
    let refused = sandbox.refuse(&COMMAND);
    assert!(refused.contains("case_b.json") && refused.contains("missing field"), "{refused}");
    assert_eq!(sandbox.list("proof/diagnoses"), [""; 0]);
}

#[test]
fn a_truth_that_cannot_be_right_is_reported_before_anything_is_diagnosed() {
    let sandbox = cases();
    let mut truth = sandbox.json("given/truth/case_b.json");
    truth["concealed"] = serde_json::json!([{"effect": "torque_offset", "joint": "elbov", "offset": 1.0}]);
    sandbox.write("given/truth/case_b.json", &truth.to_string());
    let refused = sandbox.refuse(&COMMAND);
    let says = ["case_b.json", "entry 1 of \"concealed\"", "the URDF has no joint \"elbov\""];
    assert!(says.iter().all(|part| refused.contains(part)), "{refused}");
    assert_eq!(sandbox.list("proof/diagnoses"), [""; 0]);
}

#[test]
fn a_folder_begun_for_another_campaign_is_refused() {
    let sandbox = cases();
    sandbox.succeed(&COMMAND);
    let before = bytes(&sandbox, "proof/score.json");
    let refused = sandbox.refuse(&["prove", "--cases", "1", "--seed", "3", "--out", "proof"]);
    assert!(refused.contains("was begun for cases that were given"), "{refused}");
    assert!(refused.contains("give another --out"), "{refused}");
    assert_eq!(bytes(&sandbox, "proof/score.json"), before);
    assert_eq!(sandbox.list("proof/cases"), [""; 0]);
}
