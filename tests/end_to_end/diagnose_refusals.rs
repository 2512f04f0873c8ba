//! `testbed diagnose` on bad input: refused with file, place and remedy, or corrected with a note; no file remains.

use crate::diagnose_made::{Case, SHOULDER, arguments, recording, trio};
use crate::support::{Sandbox, says};

/// A robot with a little friction; files as in [`Case`], shorter.
pub fn case() -> Case {
    let sandbox = Sandbox::new();
    sandbox.write("robot.urdf", crate::diagnose_made::URDF);
    for (variant, name) in ["a.csv", "b.csv", "c.csv"].into_iter().enumerate() {
        let text = recording(&trio(), variant, 8.0, &|motion, tau| {
            tau[SHOULDER] += 2.0 * motion.qd[SHOULDER].signum();
        });
        sandbox.write(name, &text);
    }
    Case { sandbox }
}

const OUTPUTS: [&str; 8] = ["--json", "o.json", "--report", "o.html", "--model", "o.toml", "--urdf", "o.urdf"];

/// The refusal with further arguments; nothing must be written.
pub fn refused(case: &Case, further: &[&str]) -> String {
    refused_command(case, &arguments(further))
}

pub fn refused_command(case: &Case, command: &[&str]) -> String {
    let mut list = command.to_vec();
    list.extend(OUTPUTS);
    let before = case.sandbox.list("");
    let message = case.sandbox.refuse(&list);
    assert_eq!(case.sandbox.list(""), before, "something was left behind");
    assert!(message.lines().any(|line| line.starts_with("error: ")), "{message}");
    message
}

/// The refusal where `a.csv` is another text.
pub fn refused_with(text: &str) -> String {
    let case = case();
    case.sandbox.write("a.csv", text);
    refused(&case, &[])
}

/// `a.csv` with every row's cells changed.
pub fn changed(change: impl Fn(&mut Vec<String>)) -> String {
    let text = case().text("a.csv");
    let mut lines = text.lines();
    let mut out = lines.next().expect("a header").to_owned() + "\n";
    for line in lines {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        change(&mut cells);
        out += &(cells.join(",") + "\n");
    }
    out
}

/// `a.csv` with one line changed; lines count from one.
fn with_line(number: usize, change: impl Fn(&str) -> String) -> String {
    let text = case().text("a.csv");
    let lines = text.lines().enumerate();
    let list: Vec<String> =
        lines.map(|(k, line)| if k + 1 == number { change(line) } else { line.to_owned() }).collect();
    list.join("\n") + "\n"
}

#[test]
fn joints_that_do_not_fit_the_robot_are_named_with_their_columns() {
    let renamed = with_line(1, |header| header.replace("_shoulder", "_sholder"));
    says(&refused_with(&renamed), &["a.csv", "no column q_shoulder", "q_sholder", "similar", "--map"]);
    let two = with_line(1, |_| String::new());
    let mut lacking = "t,q_turn,q_shoulder,tau_turn,tau_shoulder".to_owned();
    for line in two.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        lacking += &format!("\n{}", [cells[0], cells[1], cells[2], cells[4], cells[5]].join(","));
    }
    says(
        &refused_with(&lacking),
        &["a.csv", "no positions and torques (q_elbow, tau_elbow) of \"elbow\" of trio", "record all joints"],
    );
    let misspelt = with_line(1, |header| header.replace("_elbow", "_elbwo"));
    says(
        &refused_with(&misspelt),
        &[
            "a.csv: column q_elbwo: \"elbwo\" is not a joint of trio, which has \"turn\", \"shoulder\", and without a column \
             \"elbow\"; rename the column to q_elbow if \"elbow\" is meant, leave the column out",
        ],
    );
    let mut is_header = true;
    let mut more = String::new();
    for line in case().text("a.csv").lines() {
        more += &format!("{line}{}\n", if is_header { ",q_hand,tau_hand" } else { ",0.1,0.2" });
        is_header = false;
    }
    says(&refused_with(&more), &["a.csv", "column q_hand", "\"hand\" is not a joint of trio", "\"elbow\"", "--map"]);
}

#[test]
fn another_robots_urdf_is_refused_with_what_does_not_fit() {
    let case = case();
    let mut command = arguments(&[]);
    command[2] = "puma560";
    says(
        &refused_command(&case, &command),
        &["a.csv: belongs to another robot", "\"shoulder\"", "puma560", "\"joint6\"", "give the URDF"],
    );
    // The same names, but a range that the motion leaves, and far too little torque: a note, and no refusal.
    let urdf = case.text("robot.urdf").replace("lower=\"-3\" upper=\"3\"", "lower=\"-0.1\" upper=\"0.1\"");
    case.sandbox.write("robot.urdf", &urdf);
    let output = case.sandbox.run(&arguments(&["--verbose"]));
    let stderr = String::from_utf8_lossy(&output.stderr);
    says(&stderr, &["warning: a.csv: elbow: positions", "exceed the URDF's limits"]);
    command[2] = "gone.urdf";
    says(&refused_command(&case, &command), &["gone.urdf", "cannot be read"]);
}

#[test]
fn what_is_no_number_is_refused_with_line_and_column() {
    for flaw in ["NaN", "inf", "-inf", "x", ""] {
        let text = with_line(12, |line| {
            let mut cells: Vec<&str> = line.split(',').collect();
            cells[5] = flaw;
            cells.join(",")
        });
        says(&refused_with(&text), &["a.csv:12", "\"tau_shoulder\"", &format!("\"{flaw}\""), "delete the row"]);
    }
    let long = with_line(9, |line| line.to_owned() + ",1");
    says(&refused_with(&long), &["a.csv:9"]);
}

#[test]
fn time_that_runs_back_and_too_few_rows_are_refused() {
    let back = with_line(1002, |line| line.replacen("4.0000", "3.0000", 1));
    says(&refused_with(&back), &["a.csv:1002", "time runs back"]);
    let header = "t,q_turn,q_shoulder,q_elbow,tau_turn,tau_shoulder,tau_elbow\n";
    says(&refused_with(header), &["a.csv:1", "there are no rows"]);
    let row = format!("{header}0,1,2,3,4,5,6\n");
    says(&refused_with(&row), &["a.csv:1", "there is one row", "at least two"]);
    says(&refused_with(""), &["a.csv:1", "the file is empty"]);
    let few: Vec<String> = with_line(1, str::to_owned).lines().take(50).map(str::to_owned).collect();
    says(
        &refused_with(&few.join("\n")),
        &["a.csv", "too short", "needs 0.31 s in one piece; record at least 4 s of motion without gaps"],
    );
}

#[test]
fn no_torque_and_no_motion_are_refused_or_reported() {
    let no_torque = changed(|cells| cells[4..].iter_mut().for_each(|cell| *cell = "0".into()));
    says(&refused_with(&no_torque), &["a.csv", "all torques are zero", "tau_<joint>", "--map"]);
    let no_motion = changed(|cells| cells[1..4].iter_mut().for_each(|cell| *cell = "0.5".into()));
    let case = case();
    case.sandbox.write("a.csv", &no_motion);
    case.sandbox.write("b.csv", &no_motion.replace(",0.5", ",0.6"));
    says(&refused(&case, &[]), &["no joint moves", "record a motion"]);
    // Of one joint, or in one of the recordings: a note.
    let case = self::case();
    case.sandbox.write("a.csv", &changed(|cells| cells[6] = "0".into()));
    let output = case.sandbox.run(&arguments(&[]));
    let stderr = String::from_utf8_lossy(&output.stderr);
    says(&stderr, &["warning: a.csv: elbow: the torque is 0 throughout", "column"]);
}

#[test]
fn what_is_fitted_cannot_be_the_proof() {
    let case = case();
    let command = |train: &'static str, held_out: &'static str| {
        ["diagnose", "--robot", "robot.urdf", "--train", "a.csv", train, "--held-out", held_out]
    };
    says(
        &refused_command(&case, &command("b.csv", "./b.csv")),
        &["./b.csv: is given as a training and as a held-out recording"],
    );
    says(&refused_command(&case, &command("a.csv", "c.csv")), &["a.csv: is given twice"]);
    std::fs::copy(case.path("b.csv"), case.path("copy.csv")).expect("it can be copied");
    says(&refused_command(&case, &command("b.csv", "copy.csv")), &["copy.csv: contains the same samples as b.csv"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("b.csv", case.path("link.csv")).expect("it can be linked");
        says(
            &refused_command(&case, &command("b.csv", "link.csv")),
            &["link.csv: is given as a training and as a held-out recording"],
        );
    }
}

#[test]
fn a_file_cut_in_a_row_is_used_as_far_as_it_is_whole() {
    let case = case();
    let text = case.text("a.csv");
    case.sandbox.write("a.csv", &text[..text.len() - 20]);
    let output = case.sandbox.run(&arguments(&["--json", "o.json"]));
    assert!(output.status.success());
    let stderr = String::from_utf8_lossy(&output.stderr);
    says(&stderr, &["note: a.csv: line 2001", "cut in the middle", "left out"]);
    assert!(case.path("o.json").exists());
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_anything_is_read() {
    let case = case();
    let refused = |further: &[&str]| {
        let before = case.sandbox.list("");
        let message = case.sandbox.refuse(&arguments(further));
        assert_eq!(case.sandbox.list(""), before, "something was left behind");
        message
    };
    says(
        &refused(&["--json", "d.json", "--report", "gone/o.html"]),
        &["gone/o.html", "cannot be written", "folder that exists"],
    );
    says(&refused(&["--json", "."]), &["is a folder"]);
    let recorded = case.text("a.csv");
    says(&refused(&["--json", "./a.csv"]), &["./a.csv is an input of this command (a.csv); write to another file"]);
    says(&refused(&["--urdf", "robot.urdf"]), &["robot.urdf", "another file"]);
    assert_eq!(case.text("a.csv"), recorded);
    says(&refused(&["--json", "o.json", "--report", "o.json"]), &["o.json", "given for two outputs"]);
    says(&refused(&["--json", "new.json", "--report", "./new.json"]), &["new.json", "given for two outputs"]);
    case.sandbox.write("known.toml", "schema = \"testbed.model/1\"\n");
    says(
        &refused(&["--known", "known.toml", "--json", "known.toml"]),
        &["known.toml is an input of this command; write to another file"],
    );
    says(&refused(&["--cutoff", "0"]), &["--cutoff", "0.1 to 1000 Hz"]);
}

#[test]
fn known_effects_that_do_not_fit_are_refused_with_their_line() {
    let case = case();
    let refusal = |effect: &str| {
        case.sandbox.write("known.toml", &format!("schema = \"testbed.model/1\"\n\n[[effects]]\n{effect}"));
        refused(&case, &["--known", "known.toml"])
    };
    says(
        &refusal("effect = \"viscus_friction\"\njoint = \"elbow\"\ncoefficient = 1.0\n"),
        &["known.toml:4", "\"viscus_friction\"", "did you mean \"viscous_friction\"?"],
    );
    says(
        &refusal("effect = \"viscous_friction\"\njoint = \"elbo\"\ncoefficient = 1.0\n"),
        &["known.toml:5", "no joint \"elbo\"", "did you mean \"elbow\"?"],
    );
    says(&refusal("effect = \"viscous_friction\"\njoint = \"elbow\"\n"), &["known.toml", "coefficient"]);
    says(&refused(&case, &["--known", "gone.toml"]), &["gone.toml", "cannot be read"]);
}

#[test]
fn a_column_map_reads_anybodys_file_and_is_refused_by_its_line() {
    let case = case();
    let [mut map, mut header] = ["[time]\ncolumn = \"stamp\"\nunit = \"ms\"\n".to_owned(), "stamp".to_owned()];
    for (joint, q) in ["turn", "shoulder", "elbow"].into_iter().zip(["p1", "p2", "p3"]) {
        map += &format!("[joints.{joint}]\nq = \"{q}\"\nq_unit = \"deg\"\ntau = \"m{q}\"\n");
    }
    for column in ["p1", "p2", "p3", "mp1", "mp2", "mp3"] {
        header += &format!(",{column}");
    }
    case.sandbox.write("map.toml", &map);
    let plain = case.json(&[]);
    for name in ["a.csv", "b.csv", "c.csv"] {
        let text = case.text(name);
        let mut theirs = header.clone() + "\n";
        for line in text.lines().skip(1) {
            let mut cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            cells[0] *= 1e3;
            cells[1..4].iter_mut().for_each(|q| *q = q.to_degrees());
            let cells: Vec<String> = cells.iter().map(|cell| format!("{cell:.6}")).collect();
            theirs += &(cells.join(",") + "\n");
        }
        case.sandbox.write(name, &theirs);
    }
    says(&refused(&case, &[]), &["a.csv:1", "column \"t\"", "--map"]);
    let mapped = case.json(&["--map", "map.toml"]);
    assert_eq!(crate::diagnose_made::names(&mapped), crate::diagnose_made::names(&plain));
    case.sandbox.write("bad.toml", &map.replace("\"p2\"", "\"p22\""));
    says(
        &refused(&case, &["--map", "bad.toml"]),
        &["bad.toml:9", "a.csv has no column \"p22\"", "did you mean \"p2\"?"],
    );
}

#[test]
fn a_part_of_a_training_recording_is_no_proof() {
    let case = case();
    let text = case.text("a.csv");
    let lines: Vec<&str> = text.lines().collect();
    let part = [&lines[..1], &lines[500..1700]].concat().join("\n");
    case.sandbox.write("c.csv", &(part + "\n"));
    says(&refused(&case, &[]), &["c.csv: contains a part of a.csv", "must be independent"]);
}
