//! `testbed excite`: a motion within the limits that determines more than a naive one, runs as a scenario, and is refused with the
//! remedy where a limit is missing.

use std::collections::BTreeMap;

use arm::{Arm, Workspace};

use crate::diagnose_made::{URDF, recording, trio};
use crate::support::{Sandbox, says, words};

const JOINTS: [&str; 3] = ["turn", "shoulder", "elbow"];

fn columns(text: &str) -> BTreeMap<String, Vec<f64>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    let mut columns: BTreeMap<String, Vec<f64>> = header.iter().map(|name| (name.clone(), Vec::new())).collect();
    for row in reader.records() {
        for (name, cell) in header.iter().zip(row.expect("a row").iter()) {
            columns.get_mut(name).expect("a column").push(cell.parse().expect("a number"));
        }
    }
    columns
}

fn sandbox(urdf: &str) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("robot.urdf", urdf);
    sandbox
}

const FAST: [&str; 5] = ["excite", "--robot", "robot.urdf", "--duration", "12"];

fn run(sandbox: &Sandbox, further: &[&str]) -> String {
    sandbox.succeed(&[&FAST[..], further].concat())
}

/// The numbers of a line of the table of motions.
fn numbers(printed: &str, motion: &str) -> Vec<f64> {
    let line = printed.lines().find(|line| line.trim_start().starts_with(motion));
    let line = line.unwrap_or_else(|| panic!("no {motion} in\n{printed}"));
    let cells = line.split_whitespace().rev().take(3);
    cells.map(|cell| cell.parse().expect("a number")).collect()
}

#[test]
fn a_motion_is_within_all_limits_and_rests_at_its_ends() {
    let sandbox = sandbox(URDF);
    // Narrower than the URDF's in each kind, so that each of them matters.
    let limits = words(
        "--position-limit elbow=-0.4:1.6 --velocity-limit 2 --velocity-limit turn=1.2 --acceleration-limit shoulder=3 --effort-limit shoulder=60 --csv m.csv --rate 400",
    );
    let printed = run(&sandbox, &limits);
    assert!(printed.ends_with("written: m.csv\n"), "{printed}");
    assert!(printed.lines().all(|line| line.chars().count() <= 80), "{printed}");
    let columns = columns(&std::fs::read_to_string(sandbox.path("m.csv")).expect("it is there"));
    assert_eq!(columns.len(), 10);
    let times = &columns["t"];
    assert_eq!((times.len(), times[4800]), (4801, 12.0));
    let signal = |kind: &str| JOINTS.map(|joint| &columns[&format!("{kind}_{joint}")]);
    let [q, qd, qdd] = ["q", "qd", "qdd"].map(signal);
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    for (j, [low, high]) in [[-2.7, 2.7], [-2.7, 2.7], [-0.3, 1.5]].into_iter().enumerate() {
        assert!(q[j].iter().all(|q| (low - 1e-9..=high + 1e-9).contains(q)), "{} leaves its range", JOINTS[j]);
        for k in 1..4800 {
            let speed = 200.0 * (q[j][k + 1] - q[j][k - 1]);
            assert!((speed - qd[j][k]).abs() < 1e-3, "qd of {} at {k}", JOINTS[j]);
            let quick = 200.0 * (qd[j][k + 1] - qd[j][k - 1]);
            assert!((quick - qdd[j][k]).abs() < 2e-2, "qdd of {} at {k}", JOINTS[j]);
        }
        for end in [0, 4800] {
            assert!(qd[j][end].abs() < 1e-9 && qdd[j][end].abs() < 1e-9, "{} moves at {end}", JOINTS[j]);
        }
    }
    for (j, most) in [0.96, 1.6, 1.6].into_iter().enumerate() {
        let fastest = largest(qd[j]);
        assert!(fastest <= most + 1e-9, "{}: {fastest} rad/s", JOINTS[j]);
    }
    assert!(largest(qdd[1]) <= 2.4 + 1e-9, "{} rad/s²", largest(qdd[1]));
    let (arm, mut strongest) = (trio(), 0.0_f64);
    let (mut workspace, mut tau) = (Workspace::new(&arm), [0.0; 3]);
    for k in 0..=4800 {
        let at = |signal: [&Vec<f64>; 3]| signal.map(|values| values[k]);
        arm.inverse_dynamics(&mut workspace, &at(q), &at(qd), &at(qdd), &mut tau);
        strongest = strongest.max(tau[1].abs());
    }
    assert!(strongest <= 48.0 && strongest > 20.0, "{strongest} N m on the shoulder");
}

#[test]
fn the_motion_determines_more_than_a_naive_one_and_is_the_same_every_time() {
    let sandbox = sandbox(URDF);
    let text = recording(&trio(), 0, 8.0, &|_, _| {});
    sandbox.write("a.csv", &text);
    let files = ["--scenario", "m.toml", "--csv", "m.csv"];
    let printed = run(&sandbox, &[&files[..], &["--compare", "a.csv"]].concat());
    let words = printed.split_whitespace().collect::<Vec<_>>().join(" ");
    let determined = "combinations of the 30 inertial parameters of the links, 6 friction parameters";
    assert!(words.contains(determined), "{printed}");
    let [proposed, naive, recorded] =
        ["proposed", "one sine per joint", "a.csv"].map(|motion| numbers(&printed, motion));
    assert_eq!(proposed[0], 1.0, "{printed}");
    assert!(naive[0] > 1.05, "a naive motion is as good: {printed}");
    assert!(recorded[0] > 1.05 && recorded[2].is_finite(), "{printed}");
    let read = |name: &str| std::fs::read_to_string(sandbox.path(name)).expect("it is there");
    let before = files.map(|name| if name.starts_with('-') { String::new() } else { read(name) });
    let again = run(&sandbox, &files);
    assert!(again.contains("written: m.toml (in place of an earlier one)"), "{again}");
    assert!(!again.contains("Warning"), "{again}");
    assert!(files.map(|name| if name.starts_with('-') { String::new() } else { read(name) }) == before);
    // A file of another origin is not replaced.
    for (option, name) in [("--csv", "a.csv"), ("--scenario", "mine.toml")] {
        sandbox.write("mine.toml", "title = \"mine\"\n");
        let kept = read(name);
        let refused = sandbox.refuse(&[&FAST[..], &[option, name]].concat());
        says(&refused, &[&format!("{option} {name}: exists and"), "give another file"]);
        assert_eq!(read(name), kept);
    }
    let other = run(&sandbox, &["--seed", "1", "--csv", "other.csv"]);
    assert!(other.contains("proposed") && read("other.csv") != read("m.csv"));
    // The simulated arm follows it.
    let tracked = sandbox.succeed(&["--scenario", "m.toml", "--rerun", "off", "--out", "run"]);
    assert!(tracked.contains("rigid-body"), "{tracked}");
    let summary = sandbox.json("run/summary.json");
    let errors = summary["tracking"][0]["rms_error_rad"].as_array().expect("a list").clone();
    assert!(errors.iter().all(|error| error.as_f64().is_some_and(|error| error < 1e-4)), "{errors:?}");
}

#[test]
fn what_is_missing_is_refused_with_the_flag_that_mends_it() {
    let refuse = |urdf: &str, further: &[&str]| {
        let sandbox = sandbox(urdf);
        let message = sandbox.refuse(&[&FAST[..], &["--csv", "m.csv"], further].concat());
        assert!(!sandbox.path("m.csv").exists());
        message
    };
    let slow = URDF.replace("velocity=\"5\"", "velocity=\"0\"");
    says(&refuse(&slow, &[]), &["robot.urdf", "\"turn\" has no velocity limit", "--velocity-limit turn=VALUE (rad/s)"]);
    let weak = URDF.replace("effort=\"200\"", "effort=\"1\"");
    says(&refuse(&weak, &[]), &["robot.urdf", "shoulder", "of the 0.800 N m or N", "--effort-limit shoulder=VALUE"]);
    says(&refuse(URDF, &["--velocity-limit", "elbo=1"]), &["elbo", "did you mean elbow?"]);
    says(&refuse(URDF, &["--position-limit", "1:0"]), &["LOW:HIGH"]);
    // A continuous joint may turn by half a turn.
    let endless = URDF.replacen("type=\"revolute\"", "type=\"continuous\"", 1);
    assert!(Arm::from_urdf_text(&endless, "r.urdf").expect("an arm").joints()[0].limits.lower.is_infinite());
    let printed = run(&sandbox(&endless), &[]);
    assert!(printed.contains("proposed"), "{printed}");
}

#[test]
fn a_motion_that_hardly_moves_is_warned_of() {
    let sandbox = sandbox(URDF);
    let printed = run(&sandbox, &["--acceleration-limit", "1e-4"]);
    let words = printed.split_whitespace().collect::<Vec<_>>().join(" ");
    says(
        &words,
        &["Warning: within these limits, turn, shoulder and elbow move by less than 0.05 rad", "No file was asked for"],
    );
}
