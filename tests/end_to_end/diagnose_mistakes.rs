//! `testbed diagnose` on what users mistake: units, columns, files in each other's places.

use crate::diagnose_made::arguments;
use crate::diagnose_refusals::{case, changed, refused, refused_command, refused_with, says};

#[test]
fn torques_times_and_positions_in_another_unit_are_refused_with_the_remedy() {
    let scaled = |columns: std::ops::Range<usize>, factor: f64| {
        changed(|cells| {
            for cell in &mut cells[columns.clone()] {
                *cell = (cell.parse::<f64>().expect("a number") * factor).to_string();
            }
        })
    };
    for (factor, unit) in [(1e3, "mN m"), (1e-3, "kN m"), (1e2, "N cm")] {
        says(
            &refused_with(&scaled(4..7, factor)),
            &[
                "a.csv: the torques of all joints",
                "times the model's",
                unit,
                "--map",
                "tau_",
            ],
        );
    }
    says(
        &refused_with(&scaled(4..7, 0.01)),
        &["a.csv: the torques of all joints", "motor's side", "gear"],
    );
    says(
        &refused_with(&scaled(0..1, 1e3)),
        &["a.csv: its rows are 4.000 s apart", "ms", "--map"],
    );
    let constant = changed(|cells| cells[4..].iter_mut().for_each(|cell| *cell = "5".into()));
    says(&refused_with(&constant), &["a.csv: all torques are constant", "--map"]);
    // Three times the torque is no unit.
    let case = case();
    case.sandbox.write("a.csv", &scaled(4..7, 3.0));
    case.sandbox.succeed(&arguments(&[]));
}

#[test]
fn files_in_each_others_places_are_told() {
    let case = case();
    let mut command = arguments(&[]);
    command[2] = "a.csv";
    says(
        &refused_command(&case, &command),
        &["a.csv:1", "is not a URDF", "begins with \"t,q_turn", "--train"],
    );
    case.sandbox.write("a.csv", &case.text("robot.urdf"));
    says(&refused(&case, &[]), &["a.csv:1: this is XML", "--robot"]);
    case.sandbox.write("empty.urdf", "");
    command[2] = "empty.urdf";
    says(&refused_command(&case, &command), &["empty.urdf:1", "is empty"]);
    command[2] = ".";
    says(&refused_command(&case, &command), &["--robot .", "is a folder"]);
}

#[test]
fn positions_in_each_others_columns_are_told() {
    let case = case();
    let swapped = changed(|cells| cells.swap(2, 3));
    case.sandbox.write("a.csv", &swapped);
    let text = case
        .sandbox
        .succeed(&["inspect", "a.csv", "b.csv", "--robot", "robot.urdf"]);
    says(
        &text,
        &["the positions of shoulder and elbow seem swapped; correct the header"],
    );
    assert_eq!(text.matches("seem swapped").count(), 1, "{text}");
    // With velocities, these say which joint's they are.
    let mut last: Option<Vec<f64>> = None;
    let mut rows =
        "t,q_turn,q_shoulder,q_elbow,tau_turn,tau_shoulder,tau_elbow,qd_turn,qd_elbow,qd_shoulder\n".to_owned();
    for line in swapped.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let before = last
            .replace(cells.clone())
            .unwrap_or_else(|| cells.iter().map(|cell| cell - 1e-9).collect());
        let speed = |joint: usize| (cells[joint] - before[joint]) / (cells[0] - before[0]);
        rows += &format!("{line},{},{},{}\n", speed(1), speed(2), speed(3));
    }
    case.sandbox.write("a.csv", &rows);
    let text = case.sandbox.succeed(&["inspect", "a.csv", "--robot", "robot.urdf"]);
    says(
        &text,
        &["shoulder: its recorded velocity is not its position's slope, but that of \"elbow\" is"],
    );
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
        &[
            "map.toml: has no [joints.shoulder]",
            "is [joints.sholder] meant?",
            "add a table",
        ],
    );
    case.sandbox.write(
        "map.toml",
        &map.replace("q_elbow", "q_turn").replace("sholder", "shoulder"),
    );
    says(
        &refused(&case, &["--map", "map.toml"]),
        &["map.toml:10", "column \"q_turn\" is taken in line 4 already"],
    );
}
