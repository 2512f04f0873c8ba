//! Signs, zeros and the order of joints that are wrong in a recording.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use arm::Vector3;

use crate::diagnose_made::{ELBOW, SHOULDER, recording, trio};
use crate::diagnose_mistakes::{inspected, map_in, with_numbers};
use crate::diagnose_refusals::{case, changed};
use crate::support::{Sandbox, root, says};

/// One recording, by its torques.
const DIAGNOSE: [&str; 8] =
    ["diagnose", "--robot", "robot.urdf", "--train", "a.csv", "--torques-only", "--json", "o.json"];

#[test]
fn zeros_signs_and_order_are_reported_with_the_map_that_mends_them() {
    let case = case();
    let corrections = ["zero", "opposite", "swapped", "column map"];
    for (text, parts) in [
        (
            with_numbers(|row| row[1 + SHOULDER] += FRAC_PI_2),
            ["shoulder: the position's zero is off by π/2", "q_offset = -1.5708"],
        ),
        (
            with_numbers(|row| row[1 + ELBOW] -= FRAC_PI_2),
            ["elbow: the position's zero", "off by -π/2 from the URDF's; correct it (q_offset = 1.5708"],
        ),
        (
            with_numbers(|row| row[1 + ELBOW] += PI),
            ["elbow: the position's zero", "off by π from the URDF's; correct it (q_offset = 3.14"],
        ),
        (
            with_numbers(|row| row.swap(4 + SHOULDER, 4 + ELBOW)),
            ["the torques of shoulder and elbow seem swapped", "tau = \"tau_elbow\""],
        ),
        (with_numbers(|row| row[4 + SHOULDER] *= -1.0), ["shoulder: the torque", "tau_sign = -1"]),
    ] {
        let said = inspected(&case, &text);
        says(&said, &parts);
        says(&said, &["remains unexplained by the model, other inertial parameters and friction; without it"]);
        case.sandbox.write("map.toml", &map_in(&said));
        let mended = case.sandbox.succeed(&["inspect", "a.csv", "--robot", "robot.urdf", "--map", "map.toml"]);
        assert!(!corrections.iter().any(|word| mended.contains(word)), "{said}{mended}");
    }
    // Times a thirtieth of what they are.
    says(
        &inspected(&case, &with_numbers(|row| row[0] /= 30.0)),
        &["the speed reaches", "times the URDF's velocity limit 5"],
    );
}

/// A turn does not change a torque. Positions beyond the limits by whole turns give the same report.
#[test]
fn whole_turns_change_nothing() {
    let case = case();
    let sentences = |text: &str| -> Vec<String> {
        case.sandbox.write("a.csv", text);
        case.sandbox.succeed(&DIAGNOSE);
        let report = case.sandbox.json("o.json");
        assert!(report["warnings"].is_null(), "{}", report["warnings"]);
        let findings = report["findings"].as_array().expect("findings").iter();
        findings.map(|finding| finding["sentence"].to_string()).collect()
    };
    let as_it_is = sentences(&with_numbers(|_| ()));
    let turned = with_numbers(|row| row[1 + SHOULDER] -= 4.0 * PI);
    assert!(!as_it_is.is_empty());
    assert_eq!(sentences(&turned), as_it_is);
    says(
        &inspected(&case, &turned),
        &["shoulder: its positions lie 2 turns below the URDF's limits", "were moved into them"],
    );
}

#[test]
fn positions_in_each_others_columns_are_reported() {
    let case = case();
    let swapped = changed(|cells| cells.swap(2, 3));
    case.sandbox.write("a.csv", &swapped);
    let text = case.sandbox.succeed(&["inspect", "a.csv", "b.csv", "--robot", "robot.urdf"]);
    says(&text, &["the positions of shoulder and elbow seem swapped; correct the header"]);
    assert_eq!(text.matches("seem swapped").count(), 1, "{text}");
    // With velocities, these say which joint's they are.
    let mut last: Option<Vec<f64>> = None;
    let mut rows =
        "t,q_turn,q_shoulder,q_elbow,tau_turn,tau_shoulder,tau_elbow,qd_turn,qd_elbow,qd_shoulder\n".to_owned();
    for line in swapped.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let before = last.replace(cells.clone()).unwrap_or_else(|| cells.iter().map(|cell| cell - 1e-9).collect());
        let speed = |joint: usize| (cells[joint] - before[joint]) / (cells[0] - before[0]);
        rows += &format!("{line},{},{},{}\n", speed(1), speed(2), speed(3));
    }
    case.sandbox.write("a.csv", &rows);
    let text = case.sandbox.succeed(&["inspect", "a.csv", "--robot", "robot.urdf"]);
    says(&text, &["shoulder: its recorded velocity is not its position's slope, but that of \"elbow\" is"]);
}

#[test]
fn walls_ceilings_and_offsets_of_effects_are_no_mistakes() {
    let case = case();
    let gravity = 9.81;
    let slope = FRAC_PI_4.sin() * gravity;
    for down in [
        Vector3::new(0.0, 0.0, gravity),
        Vector3::new(gravity, 0.0, 0.0),
        Vector3::new(0.0, -gravity, 0.0),
        Vector3::new(slope, 0.0, -slope),
    ] {
        let text = recording(&trio().with_gravity(down), 0, 8.0, &|_, _| {});
        let said = inspected(&case, &text);
        assert!(!said.contains("column map"), "{down}: {said}");
    }
    for offset in [0.02, 0.1, 0.3] {
        let said = inspected(&case, &with_numbers(|row| row[1 + SHOULDER] += offset));
        assert!(!said.contains("column map"), "{offset}: {said}");
    }
}

/// Friction takes energy out of a motion, whatever the base's attitude: torques that are all inverted are no base on a ceiling. Both robots
/// are such that the model of a hanging base explains the torques of most joints.
#[test]
#[ignore = "needs ../shared"]
fn inverted_torques_of_real_robots_are_reported_and_the_map_mends_them() {
    for (robot, names) in [("lwr4", &["run_2", "run_3", "run_1"][..]), ("lbr_med7", &["may12_a", "may12_b"])] {
        let shared = root().join("../shared/recordings").join(robot);
        let sandbox = Sandbox::new();
        for name in names {
            let text = std::fs::read_to_string(shared.join(format!("{name}.csv"))).expect("it is there");
            let (header, rows) = text.split_once('\n').expect("rows");
            let torques: Vec<bool> = header.split(',').map(|name| name.starts_with("tau_")).collect();
            let inverted = rows.lines().map(|row| {
                let cells =
                    row.split(',').zip(&torques).map(|(cell, is_torque)| match (cell.strip_prefix('-'), is_torque) {
                        (_, false) => cell.to_owned(),
                        (Some(cell), true) => cell.to_owned(),
                        (None, true) => format!("-{cell}"),
                    });
                cells.collect::<Vec<_>>().join(",")
            });
            let rows: Vec<String> = inverted.collect();
            sandbox.write(&format!("{name}.csv"), &format!("{header}\n{}\n", rows.join("\n")));
        }
        let urdf = shared.join("robot.urdf").to_string_lossy().into_owned();
        let files: Vec<String> = names.iter().map(|name| format!("{name}.csv")).collect();
        let (held_out, train) = files.split_last().expect("files");
        let mut command = vec!["diagnose", "--robot", &urdf, "--json", "o.json", "--torques-only", "--train"];
        command.extend(train.iter().map(String::as_str));
        command.extend(["--held-out", held_out]);
        sandbox.succeed(&command);
        let report = sandbox.json("o.json");
        assert_eq!(report["verdict"], "units_first", "{robot}");
        let text = report["doubts"][0]["text"].to_string();
        says(&text, &["the torques of all joints have the sign opposite"]);
        assert_eq!(report["findings"].as_array().map(Vec::len), Some(0));
        let map = report["doubts"][0]["column_map"].as_str().expect("a map").to_owned();
        sandbox.write("map.toml", &map);
        sandbox.succeed(&[&command[..], &["--map", "map.toml"]].concat());
        assert_ne!(sandbox.json("o.json")["verdict"], "units_first", "{robot}");
    }
}

/// What may be wrong and is not certain stands in the report, beside the findings.
#[test]
fn what_is_not_certain_is_a_warning_in_every_report() {
    let case = case();
    // Beyond the elbow's limits, by less than a turn.
    let text = case.text("robot.urdf").replace("lower=\"-3\" upper=\"3\"", "lower=\"-0.3\" upper=\"0.3\"");
    case.sandbox.write("robot.urdf", &text);
    case.sandbox.succeed(&[&DIAGNOSE[..], &["--markdown", "o.md", "--report", "o.html"]].concat());
    let warnings = case.sandbox.json("o.json")["warnings"].clone();
    let said = "exceed the URDF's limits";
    says(&warnings[0]["text"].to_string(), &[said]);
    for file in ["o.md", "o.html"] {
        says(&case.text(file), &["Recordings that contradict the URDF", said]);
    }
}

/// Who knows better may go on.
#[test]
fn recordings_are_diagnosed_as_they_were_read_if_the_user_says_so() {
    let case = case();
    case.sandbox.write("a.csv", &with_numbers(|row| row[4 + SHOULDER] *= -1.0));
    says(&case.sandbox.succeed(&DIAGNOSE), &["--as-read"]);
    let first = case.sandbox.json("o.json");
    assert_eq!(first["verdict"], "units_first");
    case.sandbox.succeed(&[&DIAGNOSE[..], &["--as-read"]].concat());
    let second = case.sandbox.json("o.json");
    assert_ne!(second["verdict"], "units_first");
    assert!(second["doubts"].is_null());
    assert_eq!(second["warnings"], first["doubts"]);
}

/// The masses and moments of inertia of a URDF in g and g m²: the recordings are not blamed.
#[test]
fn masses_in_grams_are_refused_before_the_recordings_are_judged() {
    let case = case();
    let in_grams = |text: &str, attribute: &str| {
        let mut pieces = text.split(attribute).map(str::to_owned);
        let first = pieces.next().expect("a beginning");
        let rest = pieces.map(|piece| {
            let (number, rest) = piece.split_once('"').expect("a number");
            format!("{attribute}{}\"{rest}", 1e3 * number.parse::<f64>().expect("a number"))
        });
        first + &rest.collect::<String>()
    };
    let urdf = ["mass value=\"", "ixx=\"", "iyy=\"", "izz=\""]
        .iter()
        .fold(case.text("robot.urdf"), |text, attribute| in_grams(&text, attribute));
    case.sandbox.write("robot.urdf", &urdf);
    let said = case.sandbox.refuse(&DIAGNOSE);
    says(&said, &["robot.urdf: its masses seem to be in g: the links weigh 14000 kg together", "--as-read"]);
    assert!(!said.contains("a.csv"), "{said}");
    says(&case.sandbox.noted(&["inspect", "a.csv", "--robot", "robot.urdf"]), &["masses seem to be in g"]);
    says(&case.sandbox.noted(&[&DIAGNOSE[..], &["--as-read"]].concat()), &["taken as it is, although its masses"]);
}
