//! What goes wrong around the program: it is killed or interrupted, or two runs want one folder.
//! `tests/faults/kill` kills it a hundred times.

use std::collections::BTreeMap;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::support::{Sandbox, root, words};

/// A short run.
pub const SCENARIO: &str =
    "robot = \"puma560\"\nduration = 2\n[reference]\namplitude = 0.5\nfrequency_1 = 0.4\nfrequency_2 = 0.7\n";
/// The files of [`diagnose`].
pub const OUTPUTS: [&str; 7] = ["d.json", "p.html", "m.toml", "u.urdf", "m.xml", "p.md", "r.csv"];

/// A diagnosis of a case of the repository with every output.
pub fn diagnose(folder: &str) -> Vec<String> {
    let case = |name: &str| root().join("tests/cases").join(name).display().to_string();
    let mut list = vec!["diagnose".to_owned(), "--robot".into(), case("arm.urdf")];
    list.extend(["--train".into(), case("friction/train_1.csv"), "--held-out".into(), case("friction/held_out.csv")]);
    list.push("--torques-only".into());
    let options = ["--json", "--report", "--model", "--urdf", "--mjcf", "--markdown", "--residuals"];
    for (option, name) in options.iter().zip(OUTPUTS) {
        list.extend([(*option).to_owned(), format!("{folder}{name}")]);
    }
    list
}

/// A run of the scenario file `scenario` into the folder `out`.
pub fn run_of(scenario: &str, out: &str) -> Vec<String> {
    strings(&words(&format!("--scenario {scenario} --model true --rerun off --out {out}")))
}

/// Starts the program, whose words nobody hears.
pub fn start(sandbox: &Sandbox, arguments: &[String]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_testbed"))
        .args(arguments)
        .current_dir(sandbox.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts")
}

/// Starts the program and kills it (as `kill -9` does) after `wait`, unless it has ended.
fn killed(sandbox: &Sandbox, arguments: &[String], wait: Duration) {
    let mut child = start(sandbox, arguments);
    std::thread::sleep(wait);
    child.kill().expect("it can be killed");
    child.wait().expect("it ends");
}

/// The files of a folder by name, without its folders; what a killed program had not finished begins with `.partial-`.
pub fn files(sandbox: &Sandbox, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let path = |name: &String| sandbox.path(folder).join(name);
    let mut names = sandbox.list(folder);
    names.retain(|name| path(name).is_file() && !name.starts_with(".partial-"));
    let read = |name: String| (std::fs::read(path(&name)).expect("it can be read"), name);
    names.into_iter().map(read).map(|(bytes, name)| (name, bytes)).collect()
}

/// Owned texts.
pub fn strings(list: &[&str]) -> Vec<String> {
    list.iter().map(|text| (*text).to_owned()).collect()
}

#[test]
fn a_killed_diagnosis_leaves_whole_files_or_none() {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("whole")).expect("a folder");
    let started = std::time::Instant::now();
    assert!(start(&sandbox, &diagnose("whole/")).wait().expect("it ends").success());
    let whole = files(&sandbox, "whole");
    assert_eq!(whole.len(), OUTPUTS.len());
    let longest = started.elapsed();
    for k in 1..=6 {
        let folder = format!("killed_{k}");
        std::fs::create_dir(sandbox.path(&folder)).expect("a folder");
        killed(&sandbox, &diagnose(&format!("{folder}/")), longest * k / 6);
        for (name, bytes) in files(&sandbox, &folder) {
            assert!(whole[&name] == bytes, "{name} is not whole");
        }
    }
}

#[test]
fn a_killed_run_leaves_whole_files_or_none() {
    let sandbox = Sandbox::new();
    sandbox.write("s.toml", SCENARIO);
    let started = std::time::Instant::now();
    assert!(start(&sandbox, &run_of("s.toml", "whole")).wait().expect("it ends").success());
    let longest = started.elapsed();
    let whole = files(&sandbox, "whole");
    for k in 1..=5 {
        let out = format!("killed_{k}");
        killed(&sandbox, &run_of("s.toml", &out), longest * k / 5);
        for (name, bytes) in files(&sandbox, &out) {
            // The summary has computing times, which differ.
            let is_json = name == "summary.json" && serde_json::from_slice::<serde_json::Value>(&bytes).is_ok();
            assert!(is_json || whole[&name] == bytes, "{name} is not whole");
        }
    }
}

#[test]
fn a_killed_proof_goes_on_to_the_same_bytes() {
    let sandbox = Sandbox::new();
    std::fs::create_dir_all(sandbox.path("given/case_a")).expect("a folder");
    std::fs::create_dir_all(sandbox.path("given/truth")).expect("a folder");
    let cases = root().join("tests/cases");
    let copy = |from: &str, to: &str| std::fs::copy(cases.join(from), sandbox.path(to)).expect("it is copied");
    copy("arm.urdf", "given/case_a/robot.urdf");
    copy("backlash/train_1.csv", "given/case_a/train_1.csv");
    copy("backlash/held_out.csv", "given/case_a/held_out.csv");
    let truth = std::fs::read_to_string(cases.join("backlash/truth.json")).expect("it is there");
    sandbox.write("given/truth/case_a.json", &truth.replace("case_000", "case_a"));
    let prove = |out: &str| strings(&["prove", "--cases-from", "given", "--out", out]);
    let started = std::time::Instant::now();
    assert!(start(&sandbox, &prove("whole")).wait().expect("it ends").success());
    let longest = started.elapsed();
    for k in 1..=4 {
        killed(&sandbox, &prove("killed"), longest * k / 5);
    }
    assert!(start(&sandbox, &prove("killed")).wait().expect("it ends").success());
    for folder in ["", "/diagnoses", "/controls"] {
        let [mut whole, mut killed] = ["whole", "killed"].map(|out| files(&sandbox, &format!("{out}{folder}")));
        // Computing times.
        whole.remove("times.json");
        killed.remove("times.json");
        assert!(whole.keys().eq(killed.keys()), "{:?} {:?}", whole.keys(), killed.keys());
        for (name, bytes) in &whole {
            assert!(killed[name] == *bytes, "{folder}/{name} differs");
        }
    }
}

/// Of two runs into one folder at a time, the second is refused; without `--out`, each has its own.
#[test]
fn two_runs_do_not_share_a_folder() {
    let sandbox = Sandbox::new();
    sandbox.write("long.toml", &SCENARIO.replace("duration = 2", "duration = 2000"));
    sandbox.write("s.toml", SCENARIO);
    let run = |scenario: &str| run_of(scenario, "run");
    let mut first = start(&sandbox, &run("long.toml"));
    while !sandbox.path("run").exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(100));
    let second = run("s.toml");
    let list: Vec<&str> = second.iter().map(String::as_str).collect();
    let error = sandbox.refuse(&list);
    first.kill().expect("it can be killed");
    first.wait().expect("it ends");
    assert!(error.contains("another testbed is writing into this folder"), "{error}");
    // What was killed holds nothing.
    sandbox.succeed(&list);
}

/// After Ctrl-C, the program states which files exist.
#[test]
fn an_interrupted_program_says_what_was_kept() {
    let sandbox = Sandbox::new();
    sandbox.write("s.toml", &SCENARIO.replace("duration = 2", "duration = 2000"));
    let interrupted = |arguments: &[String], begun: &dyn Fn()| {
        let child = Command::new(env!("CARGO_BIN_EXE_testbed"))
            .args(arguments)
            .current_dir(sandbox.path(""))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        begun();
        let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(kill.expect("it is sent").success());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let run = run_of("s.toml", "run");
    let error = interrupted(&run, &|| {
        while !sandbox.path("run").exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
    });
    assert!(error.contains("interrupted") && error.contains("nothing was written"), "{error}");
    assert!(sandbox.list("run").is_empty());
    // A recording that never ends: the writer's end opens when the program has opened the reader's.
    let pipe = sandbox.path("pipe.csv");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("it is made").success());
    let mut arguments = diagnose("");
    let train = arguments.iter().position(|text| text == "--train").expect("it is there");
    arguments[train + 1] = "pipe.csv".to_owned();
    let writer = std::cell::OnceCell::new();
    let error = interrupted(&arguments, &|| {
        let _ = writer.set(std::fs::File::options().write(true).open(&pipe).expect("it opens"));
    });
    assert!(error.contains("interrupted; nothing was written"), "{error}");
    assert!(files(&sandbox, "").keys().eq(["s.toml"]));
}
