//! Recordings longer than are held in memory.

use recording::{Recording, Warning};

/// `seconds` at 20 Hz of two joints, with a gap of a minute after the first quarter.
fn long(seconds: usize) -> Recording {
    let rows = 20 * seconds;
    let time: Vec<f64> = (0..rows).map(|row| row as f64 * 0.05 + if 4 * row < rows { 0.0 } else { 60.0 }).collect();
    let signal = |pace: f64| -> Vec<f64> { time.iter().map(|t| (pace * t).sin()).collect() };
    Recording {
        joints: vec!["a".into(), "b".into()],
        q: vec![signal(0.5), signal(0.3)],
        qd: Some(vec![signal(0.4), signal(0.2)]),
        tau: vec![signal(0.7), signal(1.1)],
        time,
        ..Recording::default()
    }
}

#[test]
fn of_a_long_file_windows_are_held() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("long.csv");
    let whole = long(2000);
    whole.write_csv(&file).expect("it is written");
    let windows = Recording::read_windows(&file, None, 300.0).expect("it reads");
    let held = windows.len() as f64 * 0.05;
    assert!((150.0..330.0).contains(&held), "{held}");
    assert!((held + windows.left_out - 2000.0).abs() < 1.0, "{}", windows.left_out);
    for (row, time) in windows.time.iter().enumerate() {
        let at = whole.time.partition_point(|other| other < time);
        assert_eq!(whole.time[at], *time);
        assert_eq!((whole.q[0][at], whole.tau[1][at]), (windows.q[0][row], windows.tau[1][row]));
    }
    let (regular, warnings) = windows.regular().expect("it has a clock");
    assert!((regular.period - 0.05).abs() < 1e-9 && regular.has_clock);
    assert!(regular.segments.len() > 5, "{:?}", regular.segments);
    assert_eq!(regular.left_out, windows.left_out);
    assert!(!warnings.iter().any(|warning| matches!(warning, Warning::Gap { .. })), "{warnings:?}");
}

#[test]
fn of_a_short_file_all_is_held() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("short.csv");
    long(200).write_csv(&file).expect("it is written");
    let windows = Recording::read_windows(&file, None, 300.0).expect("it reads");
    assert_eq!(windows, Recording::read(&file).expect("it reads"));
}

/// A row that cannot be read is refused in a window, and outside of the windows only its time is read.
#[test]
fn outside_of_windows_the_time_alone_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("long.csv");
    long(2000).write_csv(&file).expect("it is written");
    let text = std::fs::read_to_string(&file).expect("it reads");
    let held = Recording::read_windows(&file, None, 300.0).expect("it reads");
    let damaged = |at: usize| {
        let mut lines: Vec<&str> = text.lines().collect();
        let line = lines[at].replacen(',', ",x", 1);
        lines[at] = &line;
        std::fs::write(&file, lines.join("\n") + "\n").expect("it is written");
        Recording::read_windows(&file, None, 300.0)
    };
    // The first window is always held; so much is left out of the end of the second half that some row is not.
    assert!(damaged(100).is_err());
    let whole = long(2000);
    let outside = (20_000..whole.len()).find(|&row| !held.time.contains(&whole.time[row]));
    let outside = outside.expect("a row outside of the windows");
    let read = damaged(outside + 1).expect("it reads");
    assert_eq!(read.time, held.time);
}
