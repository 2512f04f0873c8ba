//! A column map is proposed only if the recording agrees with the robot with it, and what one joint's columns prevent.

use std::f64::consts::FRAC_PI_2;

use recording::Recording;

use crate::diagnose_mistakes::{doubted, with_numbers};
use crate::diagnose_refusals::{case, changed, refused, refused_with};
use crate::support::{Sandbox, root, says};

#[test]
fn a_map_that_does_not_mend_the_recording_is_not_proposed() {
    let of_motors = with_numbers(|row| {
        row[1..4].iter_mut().for_each(|q| *q *= 100.0);
        row[4..].iter_mut().for_each(|tau| *tau /= 100.0);
    });
    let case = case();
    says(&doubted(&case, &of_motors), &["the motors' side of the gears?"]);
    let doubts = case.sandbox.json("o.json")["doubts"].clone();
    assert!(doubts[0]["column_map"].is_null(), "{doubts}");
}

/// Numbers of rows in the place of times, of 125 Hz: in milliseconds, the motion would be eight times too fast.
#[test]
fn numbers_of_rows_are_no_milliseconds() {
    let examples = root().join("examples/concealed");
    let mut recording = Recording::read(&examples.join("train_1.csv.gz")).expect("it is a recording");
    recording.time = (0..recording.len()).map(|row| row as f64).collect();
    let sandbox = Sandbox::new();
    recording.write_csv(&sandbox.path("rows.csv")).expect("it is written");
    let robot = examples.join("robot.urdf").display().to_string();
    let said = sandbox.succeed(&["inspect", "rows.csv", "--robot", &robot, "--json", "o.json"]);
    says(&said, &["or are they the numbers of the rows"]);
    assert!(sandbox.json("o.json")["files"][0]["column_map"].is_null(), "{said}");
}

/// What is certain of one or two joints alone also prevents a diagnosis: with a wrong position of one, the model's torques of all
/// joints before it are wrong, and effects would be named on them.
#[test]
fn one_joint_in_degrees_or_off_by_a_quarter_and_two_swapped_torques_prevent_a_diagnosis() {
    let number = |cell: &String| cell.parse::<f64>().expect("a number");
    let degrees = changed(|cells| cells[3] = number(&cells[3]).to_degrees().to_string());
    says(&doubted(&case(), &degrees), &["elbow: the position is in degrees", "[joints.elbow]", "q_unit = \"deg\""]);
    let turned = changed(|cells| cells[2] = (number(&cells[2]) + FRAC_PI_2).to_string());
    says(
        &doubted(&case(), &turned),
        &["shoulder: the position's zero is off by π/2", "q_offset = -1.5707963267948966"],
    );
    let swapped = changed(|cells| cells.swap(5, 6));
    says(&doubted(&case(), &swapped), &["the torques of shoulder and elbow seem swapped"]);
}

/// Of two joints, one may be in degrees alone; and its velocities may be in rad/s.
#[test]
fn degrees_of_one_of_two_joints_are_not_attributed_to_both() {
    let examples = root().join("examples/double_pendulum");
    let robot = examples.join("robot.urdf").display().to_string();
    for (with_velocity, units) in [(false, vec!["q_unit"]), (true, vec!["q_unit", "qd_unit"])] {
        let mut recording = Recording::read(&examples.join("r143339.csv.gz")).expect("it is a recording");
        recording.q[0].iter_mut().for_each(|q| *q = q.to_degrees());
        if let Some(qd) = recording.qd.as_mut().filter(|_| with_velocity) {
            qd[0].iter_mut().for_each(|qd| *qd = qd.to_degrees());
        }
        let sandbox = Sandbox::new();
        recording.write_csv(&sandbox.path("a.csv")).expect("it is written");
        sandbox.succeed(&["inspect", "a.csv", "--robot", &robot, "--json", "o.json"]);
        let map = sandbox.json("o.json")["files"][0]["column_map"].clone();
        let map = map.as_str().unwrap_or_else(|| panic!("no map: {map}"));
        let (joint1, joint2) = map.split_once("[joints.joint2]").expect("both joints");
        let has: Vec<&str> = joint1.lines().filter_map(|line| line.split_once("_unit")).map(|(key, _)| key).collect();
        let expected: Vec<&str> = units.iter().map(|key| key.trim_end_matches("_unit")).collect();
        assert_eq!(has, expected, "{map}");
        assert!(!joint2.contains("unit"), "{map}");
    }
}

/// A joint whose torque was recorded nowhere has a column, with a map and without one.
#[test]
fn a_joint_without_torques_is_refused_for_its_empty_column() {
    let empty = changed(|cells| cells[5].clear());
    let said = ["a.csv: column \"tau_shoulder\" has no values", "\"shoulder\" of trio", "--lock shoulder=VALUE"];
    says(&refused_with(&empty), &said);
    let case = case();
    case.sandbox.write("a.csv", &empty);
    let joint = |name: &str| format!("[joints.{name}]\nq = \"q_{name}\"\ntau = \"tau_{name}\"\n");
    let joints: String = ["turn", "shoulder", "elbow"].map(joint).concat();
    case.sandbox.write("map.toml", &format!("[time]\ncolumn = \"t\"\n\n{joints}"));
    says(&refused(&case, &["--map", "map.toml"]), &said);
}
