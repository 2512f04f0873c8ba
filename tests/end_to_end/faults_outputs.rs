//! Outputs that cannot be written, or are there already: the answer is printed, no file is incomplete, and the replaced files are named.

use std::process::{Command, Stdio};

use crate::diagnose_made::arguments;
use crate::diagnose_refusals::case;
use crate::faults::{OUTPUTS, SCENARIO, diagnose, files, run_of};
use crate::support::{Sandbox, says};

/// Runs the program where no file may be larger than `blocks` of 512 bytes, which fails as a full disk does.
fn on_a_full_disk(sandbox: &Sandbox, arguments: &[String], blocks: u32) -> std::process::Output {
    // SIGXFSZ is ignored, so that the write fails instead.
    Command::new("bash")
        .args(["-c", &format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"")])
        .arg(env!("CARGO_BIN_EXE_testbed"))
        .args(arguments)
        .current_dir(sandbox.path(""))
        .output()
        .expect("a shell starts")
}

#[test]
fn a_full_disk_costs_the_file_and_not_the_answer() {
    let sandbox = Sandbox::new();
    for folder in ["none", "some"] {
        std::fs::create_dir(sandbox.path(folder)).expect("a folder");
    }
    let none = on_a_full_disk(&sandbox, &diagnose("none/"), 0);
    let printed = String::from_utf8_lossy(&none.stdout);
    let error = String::from_utf8_lossy(&none.stderr);
    assert!(!none.status.success() && printed.contains("Coulomb friction"), "{printed}{error}");
    for name in OUTPUTS {
        assert!(error.contains(&format!("error: none/{name}")), "{name}: {error}");
    }
    assert!(sandbox.list("none").is_empty() && !printed.contains("written:"), "{printed}");
    // Small files have room, large ones do not.
    let some = on_a_full_disk(&sandbox, &diagnose("some/"), 16);
    let printed = String::from_utf8_lossy(&some.stdout);
    assert!(!some.status.success() && printed.contains("Coulomb friction"), "{printed}");
    let kept = sandbox.list("some");
    assert!(kept.contains(&"m.toml".to_owned()) && !kept.contains(&"p.html".to_owned()), "{kept:?}");
    for name in OUTPUTS {
        assert_eq!(
            printed.contains(&format!("written: some/{name}")),
            kept.contains(&name.to_owned()),
            "{name}: {printed}"
        );
    }
    // A run, too.
    sandbox.write("s.toml", SCENARIO);
    let run = run_of("s.toml", "run");
    let run = on_a_full_disk(&sandbox, &run, 0);
    let printed = String::from_utf8_lossy(&run.stdout);
    assert!(!run.status.success() && printed.contains("RMS error"), "{printed}");
    assert!(sandbox.list("run").is_empty());
    let error = String::from_utf8_lossy(&run.stderr);
    assert!(error.contains("recording.csv") && error.contains("summary.json"), "{error}");
}

#[test]
fn a_printed_answer_that_finds_no_room_is_an_error() {
    let full = std::fs::File::options().write(true).open("/dev/full");
    // Not every system has the device.
    let Ok(full) = full else { return };
    let output = Command::new(env!("CARGO_BIN_EXE_testbed")).arg("schema").stdout(full).output();
    let output = output.expect("the program starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && error.contains("printing the result"), "{error}");
}

#[test]
fn a_reader_that_leaves_costs_no_file() {
    let sandbox = Sandbox::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_testbed"))
        .args(diagnose(""))
        .current_dir(sandbox.path(""))
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts");
    drop(child.stdout.take());
    assert!(child.wait().expect("it ends").success());
    assert_eq!(files(&sandbox, "").len(), OUTPUTS.len());
}

#[test]
fn the_summary_of_a_run_is_printed_alone() {
    let sandbox = Sandbox::new();
    sandbox.write("s.toml", SCENARIO);
    let arguments = run_of("s.toml", "run");
    let mut list: Vec<&str> = arguments.iter().map(String::as_str).collect();
    list.extend(["--json", "-"]);
    let printed: serde_json::Value = serde_json::from_str(&sandbox.succeed(&list)).expect("it is JSON");
    assert_eq!(printed, sandbox.json("run/summary.json"));
    assert!(!sandbox.path("-").exists());
}

#[test]
fn what_is_replaced_is_reported() {
    let sandbox = Sandbox::new();
    let arguments = diagnose("");
    let list: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let first = sandbox.succeed(&list);
    assert!(first.contains("written: d.json\n") && !first.contains("in place of"), "{first}");
    let second = sandbox.succeed(&list);
    assert!(second.contains("written: d.json (in place of an earlier one)\n"), "{second}");
    sandbox.write("s.toml", SCENARIO);
    let run = run_of("s.toml", "run");
    let run: Vec<&str> = run.iter().map(String::as_str).collect();
    assert!(!sandbox.succeed(&run).contains("in place of"));
    assert!(sandbox.succeed(&run).contains("recording.csv (in place of an earlier one)\n"));
}

/// A folder that cannot be written to is an error before the work begins. Root may write everywhere, and is not refused.
#[test]
fn a_read_only_folder_is_reported_before_the_work() {
    use std::os::unix::fs::PermissionsExt;
    let sandbox = Sandbox::new();
    let folder = sandbox.path("closed");
    std::fs::create_dir(&folder).expect("a folder");
    let permit =
        |mode: u32| std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(mode)).expect("it is set");
    permit(0o555);
    let is_closed = std::fs::write(folder.join("x"), "").is_err();
    if is_closed {
        let arguments = diagnose("closed/");
        let list: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let error = sandbox.refuse(&list);
        assert!(error.contains("closed/") && error.contains("cannot be written"), "{error}");
        assert!(!error.contains("reading"), "{error}");
    }
    permit(0o755);
    // A folder of the system that nobody writes to stops root, too.
    if std::path::Path::new("/proc/self").is_dir() {
        let arguments = diagnose("/proc/self/");
        let list: Vec<&str> = arguments.iter().map(String::as_str).collect();
        assert!(sandbox.refuse(&list).contains("cannot be written"));
    }
}

/// A mistyped name must not cost a recording, a robot or a column map; an earlier output is replaced.
#[test]
fn only_earlier_outputs_are_replaced() {
    let case = case();
    for (option, name, text) in [
        ("--residuals", "own.csv", "t,q_a,measured_a\n0,0,0\n"),
        ("--residuals", "own.parquet", "PAR1 measured_a PAR1"),
        ("--trace", "own.csv", "t,q_a,tau_a\n0,0,0\n"),
        ("--urdf", "own.urdf", crate::diagnose_made::URDF),
        ("--mjcf", "own.xml", crate::diagnose_made::URDF),
        ("--model", "own.toml", "[a]\nq = \"p\"\n"),
        ("--json", "own.json", "{\n  \"schema\": \"testbed.seal/1\"\n}\n"),
        ("--report", "own.html", "<title>Diagnosis of mine</title>\n"),
        ("--markdown", "own.md", "# Diagnosis of mine\n"),
    ] {
        case.sandbox.write(name, text);
        let message = case.sandbox.refuse(&arguments(&[option, name]));
        says(&message, &[option, name, "exists and was not written by this option"]);
        assert_eq!(case.text(name), text);
        std::fs::remove_file(case.sandbox.path(name)).expect("it is there");
        case.sandbox.succeed(&arguments(&[option, name]));
        let again = case.sandbox.succeed(&arguments(&[option, name]));
        assert!(again.contains("in place of an earlier one"), "{option}: {again}");
    }
    std::fs::create_dir(case.sandbox.path("run")).expect("it can be made");
    case.sandbox.write("run/recording.csv", "t,q_a,tau_a\n");
    let message = case.sandbox.refuse(&["--scenario", "taskD", "--model", "rigid-body", "--out", "run"]);
    says(&message, &["recording.csv", "not of an earlier run", "--out"]);
}
