//! The commands of the README and of the documentation on the recordings that come with testbed, and the answers shown below them.
//!
//! `UPDATE_DOCS=1` writes the answers of diagnoses anew. Law: what a page shows below a command is what the command prints, byte for byte; of a run, numbers may differ by rounding.

use std::path::Path;
use std::process::Command;

use crate::support::{Sandbox, root};

/// A block of commands, and the block of text right below it.
struct Example {
    commands: Vec<String>,
    answer: Option<String>,
}

/// The examples of a page, in order. Commands may go on over lines that end with a backslash; comments are left out.
fn examples(page: &str) -> Vec<Example> {
    let text = std::fs::read_to_string(root().join(page)).expect("the page can be read");
    let mut blocks: Vec<(String, String, String)> = Vec::new();
    let mut between = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        match line.strip_prefix("```") {
            None => between += line,
            Some(kind) => {
                let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
                blocks.push((kind.to_owned(), block.join("\n") + "\n", std::mem::take(&mut between)));
            }
        }
    }
    let mut list = Vec::new();
    for (k, (kind, block, _)) in blocks.iter().enumerate() {
        if kind != "sh" {
            continue;
        }
        let joined = block.replace("\\\n", " ");
        let commands = joined.lines().filter(|line| !line.starts_with('#')).map(str::to_owned);
        let answer = blocks.get(k + 1).filter(|(kind, ..)| kind == "text");
        list.push(Example { commands: commands.collect(), answer: answer.map(|(_, block, _)| block.clone()) });
    }
    list
}

/// A folder with the examples in it, as a clone has them.
fn clone() -> Sandbox {
    let sandbox = Sandbox::new();
    copy(&root().join("examples"), &sandbox.path("examples"));
    sandbox
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir(to).expect("the folder can be made");
    for entry in std::fs::read_dir(from).expect("the folder can be read").flatten() {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).expect("the file can be copied");
        }
    }
}

/// Runs a command line with the built program in the sandbox; what it printed.
fn run(sandbox: &Sandbox, line: &str) -> String {
    let program = Path::new(env!("CARGO_BIN_EXE_testbed"));
    let folder = program.parent().expect("it is in a folder").to_path_buf();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::iter::once(folder).chain(std::env::split_paths(&path));
    let output = Command::new("sh")
        .args(["-c", line])
        .env("PATH", std::env::join_paths(paths).expect("paths can be joined"))
        .current_dir(sandbox.path(""))
        .output()
        .expect("a shell starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {error}");
    String::from_utf8(output.stdout).expect("the output is UTF-8")
}

/// Runs the commands of a page that read the recordings that come with testbed, and compares the answers, or writes them anew.
fn check(page: &str) -> usize {
    let sandbox = clone();
    let mut answers = 0;
    for example in examples(page) {
        let own = |line: &&String| line.starts_with("testbed ") && line.contains("examples/");
        let mut printed = String::new();
        for line in example.commands.iter().filter(own) {
            printed += &run(&sandbox, line);
        }
        if let (false, Some(answer)) = (printed.is_empty(), &example.answer) {
            if std::env::var_os("UPDATE_DOCS").is_some() {
                let path = root().join(page);
                let text = std::fs::read_to_string(&path).expect("the page can be read");
                let block = |answer: &str| format!("```text\n{answer}```");
                std::fs::write(&path, text.replace(&block(answer), &block(&printed))).expect("the page can be written");
                answers += 1;
                continue;
            }
            assert_eq!(&printed, answer, "{page} shows another answer");
            answers += 1;
        }
    }
    answers
}

#[test]
fn the_readme_shows_the_answer() {
    assert_eq!(check("README.md"), 1);
}

#[test]
fn the_documentation_shows_the_answers() {
    assert_eq!(check("docs/diagnose.md"), 2);
    for page in ["docs/record.md", "docs/export.md"] {
        check(page);
    }
}

/// The cells of the rows of a table of joints.
fn joints(text: &str) -> Vec<Vec<&str>> {
    let rows = text.lines().filter(|line| line.trim_start().starts_with("joint"));
    rows.map(|line| line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect()).collect()
}

#[test]
fn the_documentation_shows_task_d() {
    let main_job = |line: &String| line == "testbed --scenario taskD";
    let all = examples("docs/track.md");
    let example = all.iter().find(|example| example.commands.iter().any(main_job));
    let shown = example.and_then(|example| example.answer.as_ref()).expect("it has an answer");
    let printed = Sandbox::new().succeed(&["--scenario", "taskD", "--rerun", "off"]);
    assert_eq!(shown.lines().next(), printed.lines().next());
    let (shown, printed) = (joints(shown), joints(&printed));
    assert_eq!((shown.len(), shown[0][0]), (7, "joint"));
    assert_eq!(shown[0], printed[0]);
    for (shown, printed) in shown.iter().zip(&printed).skip(1) {
        assert_eq!(shown[0], printed[0]);
        // The torque error is rounding noise; the tracking error is not.
        for cell in [1, 2] {
            let value = |cell: &str| cell.split(' ').next().and_then(|text| text.parse::<f64>().ok());
            let (a, b) = (value(shown[cell]).expect("a number"), value(printed[cell]).expect("a number"));
            assert!((a / b - 1.0).abs() < 0.1, "{shown:?} {printed:?}");
        }
    }
}

/// The recordings with injected faults are made by the command that their page gives.
#[test]
fn the_concealed_example_can_be_made_again() {
    let sandbox = clone();
    let all = examples("examples/README.md");
    let line = &all[0].commands[0];
    assert!(line.starts_with("testbed conceal "), "{line}");
    run(&sandbox, line);
    for (made, kept) in [
        ("concealed/case_000/robot.urdf", "examples/concealed/robot.urdf"),
        ("concealed/truth/case_000.json", "examples/concealed/truth.json"),
    ] {
        let read = |path: &str| std::fs::read(sandbox.path(path)).expect("the file is there");
        assert!(read(made) == read(kept), "{made} is not {kept}");
    }
    let size: u64 = ["concealed", "double_pendulum"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(root().join("examples").join(folder)).expect("the folder is there"))
        .map(|entry| entry.and_then(|entry| entry.metadata()).expect("a file").len())
        .sum();
    assert!(size <= 2_000_000, "{size} bytes");
}

/// What a diagnosis calls explained, the diagnosis with its own model, or with the corrected URDF, calls no mismatch.
#[test]
fn a_robot_is_explained_by_its_own_corrected_model() {
    let sandbox = clone();
    let line = |robot: &str, further: &str| {
        format!(
            "testbed diagnose --robot {robot} --train examples/concealed/train_*.csv.gz --held-out \
             examples/concealed/held_out.csv.gz --torques-only {further}"
        )
    };
    let robot = "examples/concealed/robot.urdf";
    let outputs = "--json first.json --model model.toml --urdf corrected.urdf";
    run(&sandbox, &line(robot, outputs));
    assert_eq!(sandbox.json("first.json")["verdict"], "explained");
    // These fail if the verdict is another than no_mismatch.
    run(&sandbox, &line(robot, "--known model.toml --fail-on-mismatch"));
    run(&sandbox, &line("corrected.urdf", "--fail-on-mismatch"));
}

/// Law: a stretch of time ends with its recording at the latest, and a detectable size is one that a robot can have.
#[test]
fn what_a_diagnosis_says_can_be() {
    let sandbox = clone();
    let line = "testbed diagnose --robot examples/concealed/robot.urdf --train examples/concealed/train_*.csv.gz \
                --held-out examples/concealed/held_out.csv.gz --torques-only --json out.json";
    run(&sandbox, line);
    let report = sandbox.json("out.json");
    let mut cut_short = 0;
    for located in report["located"].as_array().expect("a list") {
        for window in located["time"].as_array().expect("a list") {
            let recording = window["recording"].as_str().expect("a name");
            // One clock, with 5 s between recordings of 25 s.
            let names = ["train_1", "train_2", "held_out"];
            let number = names.iter().position(|name| recording.contains(name)).expect("a recording");
            let ends = [30.0 * number as f64, 30.0 * number as f64 + 24.992];
            let [from, to] = ["start", "end"].map(|key| window[key].as_f64().expect("a time"));
            assert!(ends[0] <= from && from < to && to <= ends[1], "{window}");
            cut_short += usize::from(to > ends[1] - 0.3);
        }
    }
    assert!(cut_short > 0, "no stretch is near the end of its recording: this test says nothing");
    let mut stated = 0;
    for entry in report["not_observable"].as_array().expect("a list") {
        let above = |key: &str| entry["would_be_seen_above"][key].as_f64();
        assert!(above("offset").is_none_or(|offset| offset < 0.2), "{entry}");
        assert!(above("gain").is_none_or(|gain| gain < 1.0), "{entry}");
        stated += usize::from(above("offset").or(above("gain")).is_some());
    }
    assert!(stated > 0, "no size is stated: this test says nothing");
}
