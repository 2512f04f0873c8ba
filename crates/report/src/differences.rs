//! Sentences on how the recordings differ among themselves, which come before the verdict.

use std::collections::BTreeSet;

use diagnosis::{Parameter, RecordingNames, Report, late};

use crate::numbers;
use crate::words::{is_mostly_unexplained, list};

/// The most recordings whose names a sentence lists.
const NAMED_RECORDINGS: usize = 4;

/// The names of recordings in a sentence, without the folders that all have: names that differ in their folders keep what differs.
fn short_names<'a>(names: impl Iterator<Item = &'a String>, recordings: &RecordingNames) -> Vec<String> {
    let mut paths = recordings.train.iter().chain(&recordings.held_out);
    let first = paths.next().map_or("", String::as_str);
    let common = paths.fold(first.len(), |length, path| {
        let pairs = first.bytes().zip(path.bytes());
        length.min(pairs.take_while(|(a, b)| a == b).count())
    });
    let folder = first.as_bytes()[..common].iter().rposition(|&byte| matches!(byte, b'/' | b'\\'));
    names.map(|path| path[folder.map_or(0, |at| at + 1)..].to_owned()).collect()
}

/// `names` in a sentence, not too many of them.
fn some_of(mut names: Vec<String>) -> String {
    if names.len() > NAMED_RECORDINGS {
        let more = names.len() + 1 - NAMED_RECORDINGS;
        names.truncate(NAMED_RECORDINGS - 1);
        names.push(format!("{more} more"));
    }
    list(&names)
}

/// The friction of the held-out recordings, where it is not that of the training recordings, in two sentences; `None` if it is.
pub fn held_out_friction(report: &Report) -> Option<String> {
    let all = &report.held_out_friction;
    let joints: BTreeSet<&str> = all.iter().map(|other| other.joint.as_str()).collect();
    let recordings: BTreeSet<&String> = all.iter().map(|other| &other.recording).collect();
    let factors = || all.iter().map(|other| other.factor);
    let [least, most] = [factors().min_by(f64::total_cmp)?, factors().max_by(f64::total_cmp)?];
    let [least, most] = [least, most].map(|factor| format!("{factor:.2}"));
    let times = if least == most { least } else { format!("{least} to {most}") };
    let on = if joints.len() > 3 {
        format!("{} joints", joints.len())
    } else {
        list(&joints.into_iter().map(str::to_owned).collect::<Vec<String>>())
    };
    Some(format!(
        "The friction of {on} in {} is {times} times that in the training recordings, and the held-out errors contain the difference. \
         Find out what differed: the temperature of the drives, or work on the arm.",
        some_of(short_names(recordings.into_iter(), &report.recordings))
    ))
}

/// The load that only some of the recordings have, and what to do; `None` if all have the same. It is stated as a supposition where most of
/// the mismatch is unexplained.
pub fn different_load(report: &Report) -> Option<String> {
    let (load, recordings) = (report.different_load.as_ref()?, &report.recordings);
    let all = recordings.train.len() + recordings.held_out.len();
    let (with, others) = (load.recordings.len(), all - load.recordings.len());
    let names = short_names(load.recordings.iter(), recordings);
    let Parameter { value, ci95: [low, high], unit } = load.more_than_others;
    let (size, word) = if value < 0.0 { ([-value, -high, -low], "less") } else { ([value, low, high], "more") };
    let size = Parameter { value: size[0], ci95: [size[1], size[2]], unit };
    // What no effect explains may look like a load.
    let is_doubtful = is_mostly_unexplained(report);
    let made = match (is_doubtful, with == 1) {
        (true, true) => "seems to have been made",
        (true, false) => "seem to have been made",
        (false, true) => "was made",
        (false, false) => "were made",
    };
    let than = load.until.map_or_else(
        || format!("than the other {others}"),
        |until| format!("than later, until {until:.2} s on the common clock"),
    );
    let advice = if is_doubtful {
        " This is taken into account, but most of the mismatch is unexplained, and its cause may look like a load: check what the arm held."
    } else if load.until.is_some() {
        " This is taken into account."
    } else if report.changed.is_some() {
        ""
    } else {
        " This is taken into account. To name what else differs between them, diagnose each group alone, or give one of them with --before."
    };
    let names = if load.until.is_some() { list(&names) } else { some_of(names) };
    Some(format!("{names} {made} with {} {word} at the tip {than}.{advice}", numbers::with_interval("mass", &size)))
}

/// The lags of torques that were removed, as sentences; `None` if there were none.
pub fn torque_lag(report: &Report) -> Option<String> {
    let all = report.torque_lag.map(|lag| {
        let late = late(lag);
        format!(
            "The torques of all joints were recorded {late} than the positions; they are compared without this lag."
        )
    });
    let own = &report.own_torque_lags;
    let names = short_names(own.keys(), &report.recordings);
    let own: Vec<String> = names.iter().zip(own.values()).map(|(name, &lag)| format!("{name} {}", late(lag))).collect();
    let single = (!own.is_empty()).then(|| {
        let own = some_of(own);
        format!("Compared with the other recordings, the torques were recorded in {own}; they are compared without this difference.")
    });
    let sentences: Vec<String> = all.into_iter().chain(single).collect();
    (!sentences.is_empty()).then(|| sentences.join(" "))
}
