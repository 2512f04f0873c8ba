//! Recordings written by the formats' own libraries (`formats/make.py`): all hold the same motion of two joints.

use std::path::{Path, PathBuf};

use recording::{ColumnMap, Recording, Warning};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats").join(name)
}

fn read(name: &str) -> Recording {
    Recording::read(&path(name)).unwrap_or_else(|error| panic!("{error}"))
}

fn read_with(name: &str, map: &str) -> Result<Recording, String> {
    let map = ColumnMap::parse(map, Path::new("map.toml")).expect("the map is good");
    Recording::read_with(&path(name), Some(&map)).map_err(|error| error.to_string())
}

fn refusal(name: &str) -> String {
    Recording::read(&path(name)).expect_err("it is refused").to_string()
}

/// Position, velocity and torque of a joint at a time after the start.
fn motion(joint: usize, t: f64) -> [f64; 3] {
    [
        [0.8 * (2.0 * t).sin(), 1.6 * (2.0 * t).cos(), 5.0 * (3.0 * t).cos() + 1.0],
        [
            0.3 * (5.0 * t).cos() - 1.0,
            -1.5 * (5.0 * t).sin(),
            -2.0 * (4.0 * t).sin(),
        ],
    ][joint]
}

/// Checks every value, whatever the first stamp and the joints' order.
fn check(recording: &Recording, rows: usize, tolerance: f64) {
    assert_eq!(recording.len(), rows);
    let qd = recording.qd.as_ref().expect("it has velocities");
    for (index, name) in recording.joints.iter().enumerate() {
        let joint = usize::from(name == "elbow" || name == "1");
        for row in 0..rows {
            let t = 0.01 * row as f64;
            let stamp = recording.time[row] - recording.time[0];
            assert!((stamp - t).abs() < 1e-6, "row {row}: {stamp} s");
            let found = [recording.q[index][row], qd[index][row], recording.tau[index][row]];
            for (found, expected) in found.iter().zip(motion(joint, t)) {
                assert!((found - expected).abs() <= tolerance, "{name}, row {row}: {found} {expected}");
            }
        }
    }
}

fn system(recording: &Recording) -> Option<String> {
    recording.warnings.iter().find_map(|warning| match warning {
        Warning::System { .. } => Some(warning.to_string()),
        _ => None,
    })
}

#[test]
fn text_of_known_systems_needs_no_map() {
    for (name, of, joints) in [
        ("ur_rtde.csv", "UR RTDE", ["0", "1"]),
        ("libfranka.csv", "libfranka", ["0", "1"]),
        ("plotjuggler.csv", "PlotJuggler", ["shoulder", "elbow"]),
        ("rostopic_echo.csv", "rostopic echo -p", ["shoulder", "elbow"]),
        ("ros2_topic_echo.csv", "ros2 topic echo --csv", ["shoulder", "elbow"]),
    ] {
        let recording = read(name);
        assert_eq!(recording.joints, joints, "{name}");
        check(&recording, 60, 1e-15);
        let note = system(&recording).unwrap_or_else(|| panic!("{name} has no note"));
        assert!(note.contains(of), "{note}");
        assert_eq!(note.contains("URDF's order"), joints[0] == "0", "{note}");
    }
    let currents = refusal("ur_rtde_current.csv");
    assert!(
        currents.contains("those of UR RTDE") && currents.contains("tau_scale"),
        "{currents}"
    );
}

#[test]
fn stamps_of_a_calendar_are_read_to_the_nanosecond() {
    for name in ["sec_nanosec.csv", "iso8601.csv", "rostopic_echo.csv", "ros2_topic_echo.csv"] {
        let recording = read(name);
        check(&recording, 60, 1e-15);
        for (row, time) in recording.time.iter().enumerate() {
            let stamp = time - recording.time[0];
            assert!((stamp - 0.01 * row as f64).abs() < 1e-9, "{name}: {stamp}");
        }
    }
}

#[test]
fn compressed_files_are_read_as_they_are() {
    let plain = read("plain.csv");
    check(&plain, 60, 1e-15);
    assert_eq!(read("plain.csv.gz"), plain);
    assert_eq!(read("plain.csv.zst"), plain);
}
