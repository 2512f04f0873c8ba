//! Bags whose messages are not in the order of their time, and long ones, of which windows are read.

mod bag;

use std::path::Path;

use bag::{Message, efforts, motion, positions, state};
use recording::{Recording, Warning};

/// Of a longer bag, windows of so much time are read (s).
const SECONDS: f64 = 100.0;
const RATE: u32 = 20;

/// A bag of each storage of `messages`, by name.
fn bags(folder: &Path, messages: &[Message]) -> Vec<std::path::PathBuf> {
    let paths = ["bag.mcap", "bag.db3"].map(|name| folder.join(name));
    bag::write_mcap(&paths[0], messages);
    bag::write_database(&paths[1], messages);
    paths.into()
}

fn time(message: u32) -> f64 {
    f64::from(message) / f64::from(RATE)
}

/// What is read of each bag of `messages`: windows of it.
fn windows(messages: &[Message]) -> Vec<Result<Recording, String>> {
    let folder = tempfile::tempdir().expect("a folder");
    let read =
        |path: &std::path::PathBuf| Recording::read_windows(path, None, SECONDS).map_err(|error| error.to_string());
    bags(folder.path(), messages).iter().map(read).collect()
}

/// Checks that `recording` has the motion's values, of `seconds` (s) in all, with all rows of its windows.
fn check(recording: &Recording, seconds: f64) {
    assert!(
        (SECONDS / 2.0 - 20.0..SECONDS + 25.0).contains(&(recording.len() as f64 / f64::from(RATE))),
        "{}",
        recording.len()
    );
    let held = recording.len() as f64 / f64::from(RATE);
    assert!(
        (held + recording.left_out - seconds).abs() < 0.02 * seconds,
        "{held} {}",
        recording.left_out
    );
    for (row, &t) in recording.time.iter().enumerate() {
        let [q, tau] = motion(t);
        assert!(
            (recording.q[0][row] - q).abs() < 1e-9,
            "{t} s: {} {q}",
            recording.q[0][row]
        );
        assert!(
            (recording.tau[0][row] - tau).abs() < 2e-3,
            "{t} s: {} {tau}",
            recording.tau[0][row]
        );
    }
}

/// Positions and efforts in two topics: beside one another, one after the other, and the second one first.
#[test]
fn two_topics_of_a_long_bag_are_read_in_the_same_windows() {
    // Of some lengths, the second of two topics that come after each other was left out; of others, it was held whole.
    for seconds in [400, 420, 450, 480] {
        let all = RATE * seconds;
        let first: Vec<Message> = (0..all).map(|message| positions(time(message))).collect();
        let second: Vec<Message> = (0..all).map(|message| efforts(time(message) + 0.002)).collect();
        let beside: Vec<Message> = first
            .iter()
            .zip(&second)
            .flat_map(|(a, b)| [a.clone(), b.clone()])
            .collect();
        let after: Vec<Message> = first.iter().chain(&second).cloned().collect();
        let before: Vec<Message> = second.iter().chain(&first).cloned().collect();
        for messages in [beside, after, before] {
            for recording in windows(&messages) {
                check(&recording.expect("it reads"), f64::from(seconds));
            }
        }
    }
}

#[test]
fn messages_a_little_out_of_order_are_used_and_counted() {
    for seconds in [60, 900] {
        let all = RATE * seconds;
        // Of each 37 messages, two are exchanged, one of which is late then.
        let message = |at: u32| match at % 37 {
            5 => at + 1,
            6 => at - 1,
            _ => at,
        };
        let in_order: Vec<Message> = (0..all).map(|at| state(time(at), time(at))).collect();
        let exchanged: Vec<Message> = (0..all).map(|at| state(time(message(at)), time(message(at)))).collect();
        for (expected, read) in windows(&in_order).into_iter().zip(windows(&exchanged)) {
            let (expected, mut read) = (expected.expect("it reads"), read.expect("it reads"));
            let at = read
                .warnings
                .iter()
                .position(|warning| matches!(warning, Warning::OutOfOrder { .. }));
            let warning = read.warnings.remove(at.expect("a warning"));
            let Warning::OutOfOrder { messages, largest, .. } = warning else {
                panic!("{warning}")
            };
            assert_eq!(messages, u64::from((all - 7) / 37 + 1));
            assert!((largest - 1.0 / f64::from(RATE)).abs() < 1e-9, "{largest}");
            assert!(warning.to_string().contains("message 7 of the bag"), "{warning}");
            assert_eq!(read, expected);
            assert_eq!(read.left_out > 0.0, seconds == 900);
        }
    }
}

#[test]
fn a_clock_that_is_set_back_is_refused_with_its_place() {
    for (seconds, at, by) in [
        (60, 40.0, 0.7),
        (60, 40.0, 20.0),
        (60, 40.0, 1.5),
        (900, 500.0, 300.0),
        (900, 500.0, 500.0),
    ] {
        let message = |message: u32| {
            let t = time(message);
            state(t, if t < at { t } else { t - by })
        };
        let messages: Vec<Message> = (0..RATE * seconds).map(message).collect();
        for (read, name) in windows(&messages).into_iter().zip(["bag.mcap", "bag.db3"]) {
            let error = read.expect_err("it is refused");
            let place = f64::from(RATE) * at + 1.0;
            assert!(
                error.contains(name) && error.contains(&format!("message {place} of joint states, in /joints")),
                "{error}"
            );
            assert!(
                error.contains(&format!("time runs back by {:.3} s", by - 1.0 / f64::from(RATE))),
                "{error}"
            );
        }
    }
}

/// Two computers whose clocks differ publish one joint each.
#[test]
fn two_joints_may_have_two_clocks() {
    let messages: Vec<Message> = (0..RATE * 60)
        .flat_map(|message| {
            let t = time(message);
            [state(t, t), state(t, t - 30.0).of("other")]
        })
        .collect();
    for recording in windows(&messages) {
        assert!(recording.is_ok(), "{recording:?}");
    }
}

/// A bag of several files: the tenth does not come before the second one.
#[test]
fn the_files_of_a_bag_are_read_by_their_number() {
    let folder = tempfile::tempdir().expect("a folder");
    let each = 50 * RATE;
    for part in 0..12 {
        let messages: Vec<Message> = (part * each..(part + 1) * each)
            .map(|at| state(time(at), time(at)))
            .collect();
        bag::write_database(&folder.path().join(format!("day.one_{part}.db3")), &messages);
    }
    let recording = Recording::read_windows(folder.path(), None, SECONDS).expect("it reads");
    check(&recording, 600.0);
    assert!(
        !recording
            .warnings
            .iter()
            .any(|warning| matches!(warning, Warning::OutOfOrder { .. }))
    );
}
