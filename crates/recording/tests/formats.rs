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
        [0.3 * (5.0 * t).cos() - 1.0, -1.5 * (5.0 * t).sin(), -2.0 * (4.0 * t).sin()],
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
    assert!(currents.contains("those of UR RTDE") && currents.contains("tau_scale"), "{currents}");
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

#[test]
fn joint_states_of_bags_are_read_whatever_the_storage() {
    for name in ["joint_states.mcap", "bag_sqlite", "bag_sqlite/bag_sqlite.db3", "bag_messages", "bag_file", "bag_mcap"]
    {
        let recording = read(name);
        check(&recording, 60, 0.0);
        assert_eq!(recording.joints, ["shoulder", "elbow"], "{name}");
        let left_out = |warning: &Warning| matches!(warning, Warning::JointLeftOut { joint, .. } if joint == "finger");
        assert!(recording.warnings.iter().any(left_out), "{name}: {:?}", recording.warnings);
        assert!(system(&recording).is_some_and(|note| note.contains("/joint_states/")));
    }
    // A recorder that is killed leaves an incomplete file.
    let whole = std::fs::read(path("unstamped.mcap")).expect("it is there");
    let folder = tempfile::tempdir().expect("a folder");
    let cut = folder.path().join("cut");
    std::fs::write(&cut, &whole[..whole.len() / 2]).expect("it writes");
    let recording = Recording::read(&cut).expect("what is whole is used");
    assert!((10..60).contains(&recording.len()));
    check(&recording, recording.len(), 0.0);
    let found = |warning: &Warning| matches!(warning, Warning::CutFile { .. });
    assert!(recording.warnings.iter().any(found));
    // A message without a stamp gets the time at which it was logged.
    for name in ["unstamped.mcap", "ros_writer.mcap"] {
        check(&read(name), 60, 0.0);
    }
}

#[test]
fn topics_are_joined_by_time_or_chosen() {
    let joined = read("two_topics.mcap");
    // There is no torque before the first one.
    assert_eq!(joined.len(), 59);
    for (row, time) in joined.time.iter().enumerate() {
        let t = 0.01 * (row + 1) as f64;
        assert!((time - joined.time[0] + 0.01 - t).abs() < 1e-9);
        for joint in 0..2 {
            let [q, _, tau] = motion(joint, t);
            assert_eq!(joined.q[joint][row], q);
            // Linear between torques 10 ms apart.
            assert!((joined.tau[joint][row] - tau).abs() < 1e-3);
        }
    }
    let found =
        joined.warnings.iter().any(|warning| matches!(warning, Warning::Joined { interpolated: 59, left_out: 1, .. }));
    assert!(found, "{:?}", joined.warnings);
    let ambiguous = refusal("ambiguous.mcap");
    assert!(
        ambiguous.contains("\"shoulder\" is in the topics /a, /b") && ambiguous.contains("topics = [\"/a\"]"),
        "{ambiguous}"
    );
    check(&read_with("ambiguous.mcap", "topics = [\"/b\"]").expect("it is chosen"), 60, 0.0);
    let columns = "[time]\ncolumn = \"__time\"\n[joints.elbow]\nq = \"/a/elbow/position\"\nqd = \"/a/elbow/velocity\"\n\
                   tau = \"/b/elbow/effort\"\n";
    check(&read_with("ambiguous.mcap", columns).expect("its columns are named"), 60, 0.0);
    let missing = read_with("ambiguous.mcap", "topics = [\"/c\"]").expect_err("there is no such topic");
    assert!(
        missing.contains("in /c; its topics are /a (") && missing.contains("/b (") && missing.contains("/wanted ("),
        "{missing}"
    );
}

#[test]
fn parquet_is_read_whatever_its_compression() {
    let plain = read("plain.csv");
    for compression in ["snappy", "zstd", "gzip", "lz4"] {
        assert_eq!(read(&format!("plain_{compression}.parquet")), plain, "{compression}");
    }
    let calendar = read("datetime.parquet");
    check(&calendar, 60, 0.0);
    assert!((calendar.time[0] - 0.25).abs() < 1e-12);
    // Time differences of pandas, which Parquet holds as integers.
    check(&read("timedelta.parquet"), 60, 0.0);
    let empty = refusal("empty.parquet");
    assert!(empty.contains("the table has no rows"), "{empty}");
}

#[test]
fn episodes_of_lerobot_are_runs() {
    let recording = read("lerobot.parquet");
    assert_eq!((recording.len(), &recording.breaks[..]), (120, &[60][..]));
    assert_eq!(recording.joints, ["0", "1"]);
    for row in 0..120 {
        let t = 0.01 * (row % 60) as f64;
        for joint in 0..2 {
            let [q, _, tau] = motion(joint, t);
            assert!((recording.q[joint][row] - q).abs() < 1e-6 && (recording.tau[joint][row] - tau).abs() < 1e-6);
        }
    }
    let found = |warning: &Warning| matches!(warning, Warning::Runs { runs: 2, .. });
    assert!(recording.warnings.iter().any(found), "{:?}", recording.warnings);
    assert_eq!(read("lerobot_one_episode.parquet").len(), 60);
    let lacking = refusal("lerobot_no_torques.parquet");
    assert!(lacking.contains("those of LeRobot") && lacking.contains("observation.effort"), "{lacking}");
}

#[test]
fn arrays_of_numpy_and_matlab_are_read() {
    let plain = read("plain.csv");
    for name in ["named.npz", "named.mat"] {
        assert_eq!(read(name), plain, "{name}");
    }
    for name in ["arrays.npz", "fortran.npz", "rows.mat"] {
        let recording = read(name);
        check(&recording, 60, 0.0);
        assert_eq!(recording.joints, ["0", "1"], "{name}");
        let left_out = |warning: &Warning| matches!(warning, Warning::LeftOut { what } if what.contains("rate"));
        assert_eq!(recording.warnings.iter().any(left_out), name != "fortran.npz", "{name}");
    }
    let map = "[time]\ncolumn = \"t\"\n[joints.shoulder]\nq = \"q[0]\"\nqd = \"qd[0]\"\ntau = \"tau[0]\"\n";
    check(&read_with("arrays.npz", map).expect("it fits"), 60, 0.0);
    // A header of version 7.3 also ends in the mark of MATLAB's byte order, as those of version 5 do.
    let newer = refusal("new.mat");
    assert!(newer.contains("version 7.3 (HDF5) is not read; save it again from MATLAB: save("), "{newer}");
    assert!(newer.contains("\"-v7\")") && newer.contains("scipy.io.savemat"), "{newer}");
    check(&read("half.npz"), 60, 1e-3);
    let complex = refusal("complex.npz");
    assert!(complex.contains("q has the type <c16") && complex.contains("q.astype(float)"), "{complex}");
    let old = refusal("version_4.mat");
    assert!(old.contains("version 4 is not read") && old.contains("scipy.io.savemat"), "{old}");
    let short = refusal("short.npz");
    assert!(short.contains("q has 57 rows and 2 columns, and the longest vector has 60 values"), "{short}");
}

/// What others write is named, with the way out.
#[test]
fn formats_that_are_not_read_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run");
    let cases: [(&[u8], &str, &str); 8] = [
        (b"{\"t\":{\"0\":0.0,\"1\":0.01}}", "JSON", "pandas.read_json"),
        (b"{\"t\": 0.0, \"q_a\": 1.0}\n{\"t\": 0.01}\n", "JSON", "lines=True"),
        (b"[\n {\"t\": 0.0}]", "JSON", "pandas.read_json"),
        (b"[[0.0, 1.0], [0.01, 1.0]]", "JSON", "pandas.read_json"),
        (b"\x80\x05\x95rest of it", "a Python pickle", "as Parquet or CSV"),
        (b"ARROW1\0\0rest", "Feather (Arrow)", "to_parquet"),
        (b"\x89HDF\r\n\x1a\n", "HDF5", "numpy.savez"),
        (b"#ROSBAG V2.0\n", "a bag of ROS 1", "rosbags-convert"),
    ];
    for (content, name, remedy) in cases {
        std::fs::write(&path, content).expect("it writes");
        let error = Recording::read(&path).expect_err("it is refused").to_string();
        assert!(error.contains(&format!("run: {name}: ")) && error.contains(remedy), "{error}");
    }
}

/// Every file of a format, cut and changed in many places, is read or refused, without a panic.
#[test]
fn cut_and_damaged_files_are_read_or_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in [
        "plain.csv.gz",
        "plain.csv.zst",
        "libfranka.csv",
        "joint_states.mcap",
        "two_topics.mcap",
        "unstamped.mcap",
        "bag_sqlite/bag_sqlite.db3",
        "bag_messages/bag_messages.db3",
        "plain_snappy.parquet",
        "plain_zstd.parquet",
        "lerobot.parquet",
        "named.npz",
        "arrays.npz",
        "named.mat",
        "rows.mat",
    ] {
        let whole = std::fs::read(path(name)).expect("it is there");
        let path = folder.path().join("recording");
        let (mut refused, mut largest) = (0, 0);
        let mut tried = |bytes: &[u8]| {
            std::fs::write(&path, bytes).expect("it writes");
            let mut read = None;
            let memory = allocation_counter::measure(|| read = Some(Recording::read(&path)));
            largest = largest.max(memory.bytes_max);
            if let Some(Err(error)) = read {
                let error = error.to_string();
                assert!(error.contains("recording") && error.len() < 2000, "{name}: {error}");
                refused += 1;
            }
        };
        // An odd step, so that all places in a word are hit.
        let step = (whole.len() / 40).max(1) | 1;
        for at in (0..whole.len()).step_by(step) {
            tried(&whole[..at]);
        }
        for at in (0..whole.len()).step_by(step).chain(0..64.min(whole.len())) {
            for value in [0x00, 0x7F, 0xFF] {
                let mut damaged = whole.clone();
                damaged[at] ^= value | 1;
                tried(&damaged);
            }
        }
        assert!(refused > 20, "{name}: {refused}");
        // The limit of the expanded file, and of its table.
        assert!(largest < 2 * ((64 << 20) + 100 * whole.len() as u64), "{name}: {largest} bytes");
    }
}
