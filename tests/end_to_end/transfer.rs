//! `testbed transfer` through the built program: every training set, errors with their predictions, and refusals.

use crate::support::{Sandbox, words};

#[test]
fn every_training_set_is_tested_on_every_other_task() {
    let sandbox = Sandbox::new();
    let asked = words("transfer --train taskA,taskC --model hybrid --json t.json --samples samples");
    let printed = sandbox.succeed(&asked);
    let report = sandbox.json("t.json");
    let rows = report["rows"].as_array().expect("rows");
    let names: Vec<String> =
        rows.iter().map(|row| format!("{} {}", row["train"], row["test"]).replace("task", "")).collect();
    let expected = [r#"["A"] "C""#, r#"["A"] "D""#, r#"["C"] "A""#, r#"["C"] "D""#, r#"["A","C"] "D""#];
    assert_eq!(names, expected);
    for row in rows {
        for key in ["error", "rigid", "predicted", "likelihood"] {
            let values = row[key].as_array().expect("one a joint");
            assert_eq!(values.len(), 6);
            assert!(values.iter().all(serde_json::Value::is_f64), "{key}: {values:?}");
        }
    }
    // Both tasks together are worth more to D than A alone, whose torque error the paper's table has.
    let error = |row: usize| rows[row]["error"][1].as_f64().expect("a number");
    assert!(error(4) < error(1), "{} and {}", error(4), error(1));
    assert!((error(1).powi(2) - 5.86).abs() < 0.2, "{}", error(1));
    for word in ["A, C", "likelihood", "Rank correlation"] {
        assert!(printed.contains(word), "no {word} in\n{printed}");
    }
    assert_eq!(sandbox.list("samples"), ["A.csv", "C.csv", "D.csv"]);
    let samples = std::fs::read_to_string(sandbox.path("samples/C.csv")).expect("it is there");
    assert_eq!(samples.lines().count(), 481);
    assert!(samples.starts_with("q_1,") && samples.lines().all(|line| line.split(',').count() == 30));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let message = Sandbox::new().refuse(&["transfer", "--train", "taskA"]);
    assert!(message.contains("--train names 1 task; 2 to 6"), "{message}");
    let message = Sandbox::new().refuse(&["transfer", "--model", "rigid-body"]);
    assert!(message.contains("not trained"), "{message}");
    let message = Sandbox::new().refuse(&["transfer", "--train", "taskA,taskB,taskA"]);
    assert!(message.contains("--train names taskA twice"), "{message}");
}

/// Two files of one name have their paths in the table, and an exact rigid body a dash, whose error nothing is divided by. A task that is
/// also the scenario is tested where it is left out.
#[test]
fn files_of_one_name_are_told_apart_and_nothing_is_divided_by_zero() {
    let sandbox = Sandbox::new();
    let task = |frequency: f64| {
        format!(
            "robot = \"puma560\"\nduration = 0.5\n[reference]\namplitude = 0.5\nfrequency_1 = {frequency}\nfrequency_2 = 0.7\n"
        )
    };
    for (folder, frequency) in [("a", 0.4), ("b", 0.9)] {
        std::fs::create_dir(sandbox.path(folder)).expect("it can be made");
        sandbox.write(&format!("{folder}/x.toml"), &task(frequency));
    }
    let asked = "transfer --train a/x.toml,b/x.toml --test a/x.toml --model hybrid --json t.json --samples samples";
    let printed = sandbox.succeed(&words(asked));
    assert!(printed.contains("a/x.toml   b/x.toml") && printed.contains('–'), "{printed}");
    assert!(!printed.contains("inf") && !printed.contains("NaN"), "{printed}");
    assert_eq!(sandbox.list("samples"), ["a-x.toml.csv", "b-x.toml.csv"]);
    assert_eq!(sandbox.json("t.json")["rows"].as_array().map(Vec::len), Some(2));
}
