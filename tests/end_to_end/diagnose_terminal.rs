//! What `testbed diagnose` prints where: the short and the complete text, quiet runs, JSON for pipes, exit status, grouped notes.

use crate::diagnose_made::{Case, Motion, SHOULDER, arguments, trio};

/// Coulomb and viscous friction on the shoulder.
fn friction(motion: &Motion, tau: &mut [f64]) {
    let speed = motion.qd[SHOULDER];
    tau[SHOULDER] += 2.5 * speed.signum() + 1.8 * speed;
}

#[test]
fn a_pipe_gets_what_it_asks_for() {
    let case = Case::new(&trio(), &friction);
    let run = |further: &[&str]| {
        let further = [&["--torques-only"], further].concat();
        let output = case.sandbox.run(&arguments(&further));
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("it is UTF-8");
        (output.status.code(), text(output.stdout), text(output.stderr))
    };
    let (status, json, _) = run(&["--json", "-", "--fail-on-mismatch"]);
    assert_eq!(status, Some(3));
    let found: serde_json::Value = serde_json::from_str(&json).expect("standard output is JSON");
    assert_eq!(found["verdict"], "explained");
    assert!(!case.path("-").exists());
    let (status, printed, said) = run(&["--quiet", "--json", "d.json"]);
    assert_eq!((status, printed.as_str(), said.as_str()), (Some(0), "written: d.json\n", ""));
    let (_, short, _) = run(&[]);
    let (_, complete, _) = run(&["--verbose"]);
    assert!(short.lines().count() < complete.lines().count(), "{short}{complete}");
    assert!(complete.contains("not testable with these recordings") && !short.contains("not testable"));
    assert!(short.lines().filter(|line| line.starts_with("- ")).count() <= 4, "{short}");
}

#[test]
fn no_mismatch_does_not_fail() {
    let case = Case::new(&trio(), &|_, _| {});
    case.diagnose(&["--fail-on-mismatch", "--torques-only"]);
}

#[test]
fn a_note_on_several_files_is_one_line() {
    let case = Case::new(&trio(), &friction);
    for name in ["a.csv", "b.csv"] {
        let text = case.text(name);
        let cut = &text[..text.len() - 9];
        case.sandbox.write(name, cut);
    }
    let said = |further: &[&str]| {
        let output = case.sandbox.run(&arguments(further));
        String::from_utf8_lossy(&output.stderr)
            .lines()
            .filter(|line| line.contains("cut in the middle"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let short = said(&["--torques-only"]);
    assert!(short.len() == 1 && short[0].contains("2 files"), "{short:?}");
    assert_eq!(said(&["--torques-only", "--verbose"]).len(), 2);
}
