//! A column map is proposed only if the recording agrees with the robot with it.

use recording::Recording;

use crate::diagnose_mistakes::{doubted, with_numbers};
use crate::diagnose_refusals::{case, says};
use crate::support::{Sandbox, root};

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
