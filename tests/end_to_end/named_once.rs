//! An error names the file once that it is about, whatever the file is and wherever it is given.

use super::support::Sandbox;

/// One arm of one joint.
const ROBOT: &str = "<robot name=\"r\"><link name=\"base\"/><joint name=\"j\" type=\"revolute\"><parent link=\"base\"/><child \
link=\"arm\"/><axis xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"9\"/></joint><link name=\"arm\">\
<inertial><origin xyz=\"0.2 0 0\"/><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/>\
</inertial></link></robot>";

/// The names of files that are no robot, no recording, no column map and no list of effects; the last ones are not there.
const WRONG: [&str; 11] = [
    "README.md",
    "a.folder",
    "empty.urdf",
    "html.urdf",
    "utf16.urdf",
    "binary.urdf",
    "syntax.json",
    "syntax.toml",
    "cut.parquet",
    "missing.urdf",
    "missing.csv",
];

fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("r.urdf", ROBOT);
    let row = |k: i32| {
        let time = 0.01 * f64::from(k);
        let (sin, cos) = (3.0 * time).sin_cos();
        format!("{time},{},{}\n", 0.5 * sin, cos - sin)
    };
    let rows: String = (0..600).map(row).collect();
    sandbox.write("good.csv", &format!("t,q_j,tau_j\n{rows}"));
    sandbox.write("README.md", "# A text\n\nof words\n");
    sandbox.write("empty.urdf", "");
    sandbox.write("html.urdf", "<html><body/></html>");
    sandbox.write("syntax.json", "{\"a\": 1");
    sandbox.write("syntax.toml", "no toml [");
    sandbox.write("cut.parquet", "PAR1 and no more");
    std::fs::create_dir(sandbox.path("a.folder")).expect("it can be made");
    let bytes = |name: &str, bytes: &[u8]| std::fs::write(sandbox.path(name), bytes).expect("it can be written");
    bytes("utf16.urdf", b"\xFF\xFE<\0r\0o\0b\0o\0t\0/\0>\0");
    bytes("binary.urdf", b"\x1b[2J\0\x01\xfe\xfd");
    sandbox
}

/// The number of times that `file` stands in `text`, not as a part of another name.
fn named(text: &str, file: &str) -> usize {
    let is_name = |c: char| c.is_alphanumeric() || matches!(c, '.' | '_');
    let ends = text.match_indices(file).filter(|(at, _)| {
        let (before, after) = (&text[..*at], &text[at + file.len()..]);
        !before.ends_with(is_name) && !after.starts_with(|c: char| c.is_alphanumeric() || c == '_')
    });
    ends.count()
}

#[test]
fn an_error_names_its_file_once() {
    let sandbox = sandbox();
    let commands: [&[&str]; 12] = [
        &["diagnose", "--robot", "FILE", "--train", "good.csv"],
        &["diagnose", "--robot", "r.urdf", "--train", "FILE"],
        &["diagnose", "--robot", "r.urdf", "--train", "good.csv", "--held-out", "FILE"],
        &["diagnose", "--robot", "r.urdf", "--train", "good.csv", "--known", "FILE"],
        &["diagnose", "--robot", "r.urdf", "--train", "good.csv", "--map", "FILE"],
        &["conceal", "--seed", "1", "--out", "cases", "--robot", "FILE"],
        &["conceal", "--robot", "r.urdf", "--out", "cases", "--effects", "FILE"],
        &["excite", "--csv", "motion.csv", "--robot", "FILE"],
        &["inspect", "FILE"],
        &["inspect", "good.csv", "--robot", "FILE"],
        &["--scenario", "taskA", "--rerun", "off", "--train", "FILE"],
        &["prove", "--cases", "1", "--out", "proof", "--robot", "FILE"],
    ];
    for command in commands {
        for file in WRONG {
            let command: Vec<&str> = command.iter().map(|word| if *word == "FILE" { file } else { word }).collect();
            let stderr = sandbox.refuse(&command);
            let error = stderr.lines().filter(|line| !line.starts_with("note: ") && !line.starts_with("warning: "));
            let error = error.collect::<Vec<_>>().join("\n");
            assert_eq!(named(&error, file), 1, "{command:?}: {error}");
            let is_plain = |c: char| c == '\n' || !c.is_control();
            assert!(error.chars().all(is_plain), "{command:?}: {error:?}");
        }
    }
}

/// A robot in a scenario's file, which stands beside it.
#[test]
fn a_scenario_names_the_file_of_its_robot_once() {
    let sandbox = sandbox();
    let scenario = include_str!("../../scenarios/taskA.toml");
    for file in WRONG {
        sandbox.write("task.toml", &scenario.replace("\"puma560\"", &format!("\"{file}\"")));
        let error = sandbox.refuse(&["--scenario", "task.toml", "--rerun", "off"]);
        assert_eq!((named(&error, file), named(&error, "task.toml")), (1, 1), "{error}");
    }
}
