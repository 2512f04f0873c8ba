//! `testbed diagnose` on what users mistake: units, columns, files in each other's places.

use std::f64::consts::PI;

use crate::diagnose_made::{Case, arguments};
use crate::diagnose_refusals::{case, changed, refused, refused_command, refused_with};
use crate::support::{says, words};

/// One recording with a column map, by its torques.
const ALONE: [&str; 7] = ["--robot", "robot.urdf", "--train", "a.csv", "--map", "map.toml", "--torques-only"];

/// What a diagnosis with `text` as `a.csv` says: no effect, and units first, in every form.
pub fn doubted(case: &Case, text: &str) -> String {
    case.sandbox.write("a.csv", text);
    let said = case.sandbox.succeed(&arguments(&words("--json o.json --report o.html --markdown o.md")));
    let json = case.sandbox.json("o.json");
    assert_eq!(json["verdict"], "units_first", "{said}");
    assert_eq!(json["findings"].as_array().map(Vec::len), Some(0));
    let doubt = &json["doubts"][0];
    assert_eq!(doubt["recording"], "a.csv");
    let (page, markdown) = (case.text("o.html"), case.text("o.md"));
    for form in [&said, &page, &markdown] {
        says(form, &["Units, signs, order or zeros first", "no effect was searched"]);
    }
    // The map is the same everywhere.
    if let Some(map) = doubt["column_map"].as_str() {
        says(&said, &[map, "A column map that corrects it"]);
        says(&markdown, &[map.trim_end()]);
        says(&page, &[map.lines().next().expect("a line"), "<pre>"]);
    }
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    words(&said)
}

/// The same with the other files as they should be.
fn doubted_with(text: &str) -> String {
    doubted(&case(), text)
}

#[test]
fn torques_times_and_positions_in_another_unit_are_reported_with_the_remedy() {
    let scaled = |columns: std::ops::Range<usize>, factor: f64| {
        changed(|cells| {
            for cell in &mut cells[columns.clone()] {
                *cell = (cell.parse::<f64>().expect("a number") * factor).to_string();
            }
        })
    };
    for (factor, unit) in [(1e3, "mN m"), (1e-3, "kN m"), (1e2, "N cm")] {
        says(
            &doubted_with(&scaled(4..7, factor)),
            &["the torques of all joints", "times the model's", unit, "--map", "tau_"],
        );
    }
    says(
        &doubted_with(&scaled(4..7, 0.01)),
        &["a.csv (in this recording alone): the torques of all joints", "motor's side", "gear"],
    );
    says(&doubted_with(&scaled(0..1, 1e3)), &["its rows are 4.000 s apart", "unit = \"ms\"", "--map"]);
    // Of rows so far apart, next to none are held.
    let in_us = |torques: f64| {
        changed(|cells| {
            for (column, factor) in [(0, 1e6), (4, torques)] {
                cells[column] = (cells[column].parse::<f64>().expect("a number") * factor).to_string();
            }
        })
    };
    let rare = case();
    rare.sandbox.write("b.csv", &in_us(1.1));
    says(&doubted(&rare, &in_us(1.0)), &["rows are 4000.000 s apart", "\"us\""]);
    let constant = changed(|cells| cells[4..].iter_mut().for_each(|cell| *cell = "5".into()));
    says(&refused_with(&constant), &["a.csv: all torques are constant", "--map"]);
    // Three times the torque is no unit.
    let case = case();
    case.sandbox.write("a.csv", &scaled(4..7, 3.0));
    case.sandbox.succeed(&arguments(&[]));
}

#[test]
fn files_in_each_others_places_are_reported() {
    let case = case();
    let mut command = arguments(&[]);
    command[2] = "a.csv";
    says(&refused_command(&case, &command), &["a.csv:1", "is not a URDF", "begins with \"t,q_turn", "--train"]);
    case.sandbox.write("a.csv", &case.text("robot.urdf"));
    says(&refused(&case, &[]), &["a.csv:1: this is XML", "--robot"]);
    case.sandbox.write("empty.urdf", "");
    command[2] = "empty.urdf";
    says(&refused_command(&case, &command), &["empty.urdf:1", "is empty"]);
    command[2] = ".";
    says(&refused_command(&case, &command), &["--robot: .", "is a folder"]);
}

#[test]
fn a_map_that_lacks_a_joint_is_named() {
    let case = case();
    let mut map = "[time]\ncolumn = \"t\"\n".to_owned();
    for (joint, column) in [("turn", "turn"), ("sholder", "shoulder"), ("elbow", "elbow")] {
        map += &format!("[joints.{joint}]\nq = \"q_{column}\"\ntau = \"tau_{column}\"\n");
    }
    case.sandbox.write("map.toml", &map);
    says(
        &refused(&case, &["--map", "map.toml"]),
        &["map.toml: has no [joints.shoulder]", "is [joints.sholder] meant?", "add a table"],
    );
    case.sandbox.write("map.toml", &map.replace("q_elbow", "q_turn").replace("sholder", "shoulder"));
    says(&refused(&case, &["--map", "map.toml"]), &["map.toml:10", "column \"q_turn\" is taken in line 4 already"]);
}

/// `a.csv` with numbers changed; time, three positions, three torques.
pub fn with_numbers(change: impl Fn(&mut [f64])) -> String {
    changed(|cells| {
        let mut numbers: Vec<f64> = cells.iter().map(|cell| cell.parse().expect("a number")).collect();
        change(&mut numbers);
        *cells = numbers.iter().map(f64::to_string).collect();
    })
}

/// The column map at the end of a text.
pub fn map_in(text: &str) -> String {
    let (_, map) = text.split_once("[time]").unwrap_or_else(|| panic!("no map in: {text}"));
    format!("[time]{}", map.split("\n\n").next().expect("it has a first part"))
}

/// What the inspection says of `text` as `a.csv`.
pub fn inspected(case: &Case, text: &str) -> String {
    case.sandbox.write("a.csv", text);
    case.sandbox.succeed(&["inspect", "a.csv", "--robot", "robot.urdf"])
}

#[test]
fn where_all_joints_are_wrong_nothing_is_searched_and_the_map_mends_it() {
    let degrees = with_numbers(|row| row[1..4].iter_mut().for_each(|q| *q = q.to_degrees()));
    let milliradians = with_numbers(|row| row[1..4].iter_mut().for_each(|q| *q *= 1e3));
    let turns = with_numbers(|row| row[1..4].iter_mut().for_each(|q| *q /= 2.0 * PI));
    let currents = with_numbers(|row| {
        for (tau, constant) in row[4..].iter_mut().zip([12.0, 15.0, 9.0]) {
            *tau /= constant;
        }
    });
    let milliseconds = with_numbers(|row| row[0] *= 1e3);
    let inverted = with_numbers(|row| row[4..].iter_mut().for_each(|tau| *tau *= -1.0));
    for (text, parts) in [
        (degrees, ["the positions are in degrees", "q_unit = \"deg\""]),
        (milliradians, ["the positions are in milliradians", "q_unit = \"mrad\""]),
        (turns, ["the positions are in turns", "q_unit = \"turn\""]),
        (currents, ["motor currents", "tau_scale = "]),
        (milliseconds, ["its rows are", "unit = \"ms\""]),
        (inverted, ["the torques of all joints have the sign opposite", "tau_sign = -1"]),
    ] {
        let case = case();
        says(&doubted(&case, &text), &parts);
        // Followed literally, on this recording alone, because the others are as they should be.
        let map = case.sandbox.json("o.json")["doubts"][0]["column_map"].clone();
        case.sandbox.write("map.toml", map.as_str().unwrap_or_else(|| panic!("no map: {parts:?}")));
        let mut command = vec!["diagnose", "--json", "mended.json"];
        command.extend(ALONE);
        let said = case.sandbox.succeed(&command);
        let mended = case.sandbox.json("mended.json");
        assert!(mended.get("doubts").is_none(), "{parts:?}: {said}");
        let friction = mended["findings"].as_array().expect("a list").iter();
        let mut on_shoulder = friction.filter(|finding| finding["effect"] == "coulomb_friction");
        assert!(on_shoulder.any(|finding| finding["joint"] == "shoulder"), "{parts:?}: {said}");
    }
    let counts = with_numbers(|row| row[1..4].iter_mut().for_each(|q| *q *= 5e4));
    says(&doubted_with(&counts), &["in no unit of angle", "q_scale", "gear"]);
    let other = with_numbers(|row| {
        let time = row[0];
        for (joint, tau) in row[4..].iter_mut().enumerate() {
            *tau = 1e-3 * (time * (5.0 + joint as f64)).sin();
        }
    });
    says(&doubted_with(&other), &["times the recorded one or more", "check units"]);
}

#[test]
fn a_model_that_was_not_searched_is_not_written() {
    let case = case();
    let text = with_numbers(|row| row[4..].iter_mut().for_each(|tau| *tau *= 1e3));
    case.sandbox.write("a.csv", &text);
    let message = case.sandbox.refuse(&arguments(&["--urdf", "o.urdf", "--json", "o.json"]));
    says(&message, &["o.urdf: not written, because no effect was searched"]);
    assert_eq!(case.sandbox.json("o.json")["verdict"], "units_first");
    assert!(!case.path("o.urdf").exists());
    let status = case.sandbox.run(&arguments(&["--fail-on-mismatch", "--quiet"])).status;
    assert_eq!(status.code(), Some(3));
}

#[test]
fn numbered_joints_of_another_count_are_reported_with_a_map_of_the_first() {
    let case = case();
    let text = changed(|cells| {
        cells.insert(4, cells[1].clone());
        cells.push(cells[5].clone());
    });
    let rows = text.split_once('\n').expect("a header").1;
    let header = "t,q[0],q[1],q[2],q[3],tau[0],tau[1],tau[2],tau[3]";
    case.sandbox.write("a.csv", &format!("{header}\n{rows}"));
    let said = refused(&case, &[]);
    says(&said, &["its 4 joints have numbers", "the arm of trio has 3 joints", "q = \"q[0]\""]);
    case.sandbox.write("map.toml", &map_in(&said));
    case.sandbox.succeed(&[&["diagnose"], &ALONE[..]].concat());
}

#[test]
fn recordings_of_one_calendar_share_a_clock() {
    let case = case();
    let noted = |stamp: &dyn Fn(usize, f64) -> String, further: &[&str]| {
        for (number, name) in ["a.csv", "b.csv", "c.csv"].into_iter().enumerate() {
            let text = case.text(name);
            let mut lines = text.lines();
            let mut out = lines.next().expect("a header").to_owned() + "\n";
            let mut first = None;
            for line in lines {
                let (time, rest) = line.split_once(',').expect("cells");
                let time: f64 = time.parse().expect("a number");
                out += &format!("{},{rest}\n", stamp(number, time - *first.get_or_insert(time)));
            }
            case.sandbox.write(name, &out);
        }
        let output = case.sandbox.run(&arguments(further));
        assert!(output.status.success());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let overlaps = "overlap in time";
    says(&noted(&|_, time| time.to_string(), &["--torques-only"]), &[overlaps]);
    let dated = |number: usize, time: f64| format!("2024-03-01T{}:00:{time:09.6}Z", 12 + number);
    let said = noted(&dated, &["--torques-only", "--residuals", "r.csv"]);
    assert!(!said.contains(overlaps), "{said}");
    let residuals = case.text("r.csv");
    let last = residuals.lines().last().expect("a row");
    let mut cells = last.split(',').filter_map(|cell| cell.parse::<f64>().ok());
    assert!(cells.any(|cell| (7200.0..7210.0).contains(&cell)), "two hours later: {last}");
}

#[test]
fn names_numbers_and_files_that_do_not_fit_the_flag_are_reported() {
    let case = case();
    let with = |flags: &[&str]| refused(&case, flags);
    says(&with(&["--only", "coulomb_fricton:elbow"]), &["coulomb_fricton on elbow", "did you mean coulomb_friction?"]);
    let output = case.sandbox.run(&arguments(&["--cutoff", "-3"]));
    assert!(String::from_utf8_lossy(&output.stderr).contains("give a frequency from 0.1 to 1000 Hz"));
    says(&with(&["--before", "a.csv"]), &["a.csv: is given with --before and with --train"]);
}
