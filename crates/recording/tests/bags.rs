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
    assert!((held + recording.left_out - seconds).abs() < 0.02 * seconds, "{held} {}", recording.left_out);
    for (row, &t) in recording.time.iter().enumerate() {
        let [q, tau] = motion(t);
        assert!((recording.q[0][row] - q).abs() < 1e-9, "{t} s: {} {q}", recording.q[0][row]);
        assert!((recording.tau[0][row] - tau).abs() < 2e-3, "{t} s: {} {tau}", recording.tau[0][row]);
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
        let beside: Vec<Message> = first.iter().zip(&second).flat_map(|(a, b)| [a.clone(), b.clone()]).collect();
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
            let at = read.warnings.iter().position(|warning| matches!(warning, Warning::OutOfOrder { .. }));
            let warning = read.warnings.remove(at.expect("a warning"));
            let Warning::OutOfOrder { messages, largest, .. } = warning else { panic!("{warning}") };
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
    for (seconds, at, by) in [(60, 40.0, 0.7), (60, 40.0, 20.0), (60, 40.0, 1.5), (900, 500.0, 300.0)] {
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
            assert!(error.contains(&format!("time runs back by {:.3} s", by - 1.0 / f64::from(RATE))), "{error}");
        }
    }
}

/// The warnings of one kind.
fn said(recording: &Recording, is_wanted: impl Fn(&Warning) -> bool) -> Vec<String> {
    let wanted = recording.warnings.iter().filter(|warning| is_wanted(warning));
    wanted.map(ToString::to_string).collect()
}

/// A few stamps a week ahead or back, at the beginning, within and at the end, one or three of them.
#[test]
fn messages_with_a_wrong_stamp_are_left_out() {
    let all = 60 * RATE;
    let week = 7.0 * 86_400.0;
    for by in [week, -week, 100.0, -100.0] {
        for first in [0, 1, 5, 600, all - 3] {
            for count in [1, 3] {
                let is_wrong = |at: u32| (first..first + count).contains(&at);
                let stamped = |at: u32| state(time(at), time(at) + if is_wrong(at) { by } else { 0.0 });
                // Less than a day apart, only what follows can tell which time is the wrong one.
                if by.abs() < week && (first < 600 || by > 0.0 && first + count >= all) {
                    continue;
                }
                let messages: Vec<Message> = (0..all).map(stamped).collect();
                for read in windows(&messages) {
                    let read = read.expect("it reads");
                    let case = format!("{by} s at {first}: {count}");
                    // Of the first messages of a bag, the right ones before a wrong one are also doubtful.
                    let lost = all as usize - read.len();
                    assert!((count as usize..=count as usize + 5).contains(&lost), "{case}: {lost}");
                    assert!(first < 600 || lost == count as usize, "{case}: {lost}");
                    assert!(read.duration() < 60.0, "{case}: {}", read.duration());
                    let said = said(&read, |warning| matches!(warning, Warning::WrongStamps { .. }));
                    assert!(said.len() == 1 && said[0].contains(&format!("{lost} message")), "{case}: {said:?}");
                    for (row, &t) in read.time.iter().enumerate() {
                        let t = t + f64::from(read.epoch.map_or(0, |epoch| epoch - 1_700_000_000) as i32);
                        assert!((read.q[0][row] - motion(t)[0]).abs() < 1e-6, "{case}: {t} s");
                    }
                }
            }
        }
    }
}

/// A simulation whose clock goes back to zero, positions and efforts in one topic or in two.
#[test]
fn a_simulation_that_starts_again_is_another_run() {
    let (first, second) = (40 * RATE, 30 * RATE);
    let one = |t: f64| vec![state(t, t).simulated()];
    let two = |t: f64| vec![positions(t).simulated(), efforts(t + 0.002).simulated()];
    for of in [&one as &dyn Fn(f64) -> Vec<Message>, &two] {
        // It may have run for a while before the bag begins.
        for begins in [0.05, 7.0] {
            let before = (0..first).map(|at| begins + time(at));
            let messages: Vec<Message> = before.chain((0..second).map(|at| 0.05 + time(at))).flat_map(of).collect();
            for read in windows(&messages) {
                let read = read.expect("it reads");
                let [at] = read.breaks[..] else { panic!("{:?}", read.breaks) };
                assert!(read.len() as u32 >= first + second - 5 && at as u32 >= first - 3, "{} {at}", read.len());
                assert!((read.time[at] - read.time[at - 1] - 1.0).abs() < 0.1);
                for (row, &t) in read.time.iter().enumerate() {
                    let stamp = match row < at {
                        true => t,
                        false => {
                            0.05 + t - read.time[at] + if read.len() as u32 == first + second { 0.0 } else { time(1) }
                        }
                    };
                    assert!((read.q[0][row] - motion(stamp)[0]).abs() < 1e-6, "{t} s");
                    assert!((read.tau[0][row] - motion(stamp)[1]).abs() < 2e-3, "{t} s");
                }
                let said = said(&read, |warning| matches!(warning, Warning::ClockRestart { .. }));
                assert!(said.len() == 1 && said[0].contains("another run"), "{said:?}");
            }
        }
    }
}

/// Where one of two clocks starts again, the two topics no longer belong together.
#[test]
fn a_clock_that_starts_again_alone_is_refused() {
    let restarted = |t: f64| if t < 40.0 { t } else { t - 40.0 };
    let messages: Vec<Message> = (0..80 * RATE).map(time).flat_map(|t| [positions(restarted(t)), efforts(t)]).collect();
    for read in windows(&messages) {
        let error = read.expect_err("it is refused").to_string();
        assert!(error.contains("in /torques: time began again in other joint states"), "{error}");
    }
}

/// Before a simulation begins, its messages have no stamp.
#[test]
fn messages_without_a_stamp_are_not_mixed_with_others() {
    let all = 60 * RATE;
    for unstamped in [20, all - 20] {
        let message = |at: u32| {
            let message = state(time(at), time(at)).simulated();
            if at < unstamped { message.unstamped() } else { message }
        };
        let messages: Vec<Message> = (0..all).map(message).collect();
        for read in windows(&messages) {
            let read = read.expect("it reads");
            assert!(read.duration() < 60.0 && read.len() as u32 == all - 20, "{} s", read.duration());
            let said = said(&read, |warning| matches!(warning, Warning::LeftOut { .. }));
            let expected = if unstamped == 20 {
                "20 messages without a stamp, or with the stamp 0,"
            } else {
                "20 messages with a stamp"
            };
            assert!(said.len() == 1 && said[0].contains(expected), "{said:?}");
        }
    }
}

/// Names of files need not be in the order of time.
#[test]
fn the_files_of_a_bag_may_have_any_names() {
    let each = 50 * RATE;
    for order in [[2, 0, 1], [1, 2, 0], [2, 1, 0], [0, 2, 1]] {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, part) in ["a", "b", "c"].iter().zip(order) {
            let messages: Vec<Message> = (part * each..(part + 1) * each).map(|at| state(time(at), time(at))).collect();
            bag::write_mcap(&folder.path().join(format!("{name}.mcap")), &messages);
        }
        let recording = Recording::read_windows(folder.path(), None, 1000.0).expect("it reads");
        assert_eq!(recording.len() as u32, 3 * each);
        assert!(recording.breaks.is_empty() && recording.warnings.len() == 2, "{:?}", recording.warnings);
    }
}

/// A file of a bag may have no joint states; all of them may not.
#[test]
fn a_file_without_joint_states_is_no_error_in_a_bag() {
    let folder = tempfile::tempdir().expect("a folder");
    bag::write_mcap(&folder.path().join("a.mcap"), &[]);
    bag::write_database(&folder.path().join("b.db3"), &[]);
    let error = Recording::read(folder.path()).expect_err("it is refused").to_string();
    assert!(error.contains("there are no whole messages: was anything recorded, or was the file cut"), "{error}");
    let messages: Vec<Message> = (0..60 * RATE).map(|at| state(time(at), time(at))).collect();
    bag::write_mcap(&folder.path().join("c.mcap"), &messages);
    assert_eq!(Recording::read(folder.path()).map(|recording| recording.len()).ok(), Some(60 * RATE as usize));
}

/// Files whose times overlap are no parts of one bag.
#[test]
fn files_with_the_same_times_are_refused() {
    for (first, second) in [((0, 40), (20, 60)), ((20, 60), (0, 40)), ((0, 60), (20, 40)), ((20, 40), (0, 60))] {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, (from, to)) in [("a.mcap", first), ("b.mcap", second)] {
            let messages: Vec<Message> = (from * RATE..to * RATE).map(|at| state(time(at), time(at))).collect();
            bag::write_mcap(&folder.path().join(name), &messages);
        }
        let error = Recording::read_windows(folder.path(), None, 1000.0).expect_err("it is refused").to_string();
        assert!(error.contains("b.mcap") && error.contains("time runs back by"), "{error}");
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
        let messages: Vec<Message> = (part * each..(part + 1) * each).map(|at| state(time(at), time(at))).collect();
        bag::write_database(&folder.path().join(format!("day.one_{part}.db3")), &messages);
    }
    let recording = Recording::read_windows(folder.path(), None, SECONDS).expect("it reads");
    check(&recording, 600.0);
    assert!(!recording.warnings.iter().any(|warning| matches!(warning, Warning::OutOfOrder { .. })));
}
