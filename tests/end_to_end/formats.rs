//! Recordings of other formats and systems, in the commands that take recordings.

use crate::diagnose_made::arguments;
use crate::diagnose_refusals::case;
use crate::support::{Sandbox, root, says};

#[test]
fn inspect_reads_every_format() {
    let sandbox = Sandbox::new();
    for (name, joint) in [
        ("plain.csv.gz", "elbow"),
        ("ur_rtde.csv", "UR RTDE"),
        ("ros2_topic_echo.csv", "ros2 topic echo"),
        ("joint_states.mcap", "elbow"),
        ("bag_sqlite", "elbow"),
        ("plain_zstd.parquet", "elbow"),
        ("named.npz", "elbow"),
        ("rows.mat", "arrays"),
    ] {
        let file = root().join("crates/recording/tests/formats").join(name);
        let text = sandbox.succeed(&["inspect", &file.display().to_string()]);
        says(&text, &[name, ": 2 joints, 60 rows, 0.59 s at 100 Hz", joint]);
    }
}

#[test]
fn diagnose_takes_numbered_joints_spaces_and_split_stamps() {
    let case = case();
    let found = |case: &crate::diagnose_made::Case| -> Vec<String> {
        let output = case.sandbox.run(&arguments(&["--json", "o.json"]));
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{stderr}");
        let json = case.sandbox.json("o.json");
        let findings = json["findings"].as_array().expect("there are findings").iter();
        let mut list: Vec<String> =
            findings.map(|finding| format!("{} {}", finding["effect"], finding["joint"])).collect();
        list.push(stderr);
        list
    };
    let mut expected = found(&case);
    expected.pop();
    assert!(!expected.is_empty());
    // The joints of the header in its order, by numbers.
    let text = case.text("a.csv");
    let (header, rows) = text.split_once('\n').expect("a header");
    let joints: Vec<&str> = header.split(',').filter_map(|name| name.strip_prefix("q_")).collect();
    let number = |name: &str| {
        let joint = joints.iter().position(|joint| name.ends_with(joint));
        joint.map_or(name.to_owned(), |joint| {
            format!("{}[{joint}]", name.trim_end_matches(joints[joint]).trim_end_matches('_'))
        })
    };
    let numbered: Vec<String> = header.split(',').map(number).collect();
    case.sandbox.write("a.csv", &format!("{}\n{rows}", numbered.join(",")));
    case.sandbox.write("b.csv", &case.text("b.csv").replace(',', "  "));
    let text = case.text("c.csv");
    let (header, rows) = text.split_once('\n').expect("a header");
    let split = rows.lines().map(|row| {
        let (t, rest) = row.split_once(',').expect("a time");
        let nanos = (t.parse::<f64>().expect("a time") * 1e9).round() as i64;
        format!("{},{},{rest}\n", 1_700_000_000 + nanos / 1_000_000_000, nanos % 1_000_000_000)
    });
    let split: String = split.collect();
    case.sandbox.write("c.csv", &format!("{}\n{split}", header.replacen("t,", "sec,nanosec,", 1)));
    let mut again = found(&case);
    let stderr = again.pop().expect("the notes");
    assert_eq!(again, expected);
    says(&stderr, &["note: a.csv: the columns are those of arrays", "URDF's order"]);
}
