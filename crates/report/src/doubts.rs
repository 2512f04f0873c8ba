//! Doubts about the units, signs, order or zeros of recordings, and the column maps that correct them.

use diagnosis::{Doubt, Report};

use crate::words;

/// How a column map is used that concerns all recordings.
const USE: &str = ": save it as `map.toml`, and add `--map map.toml` to the command.";
/// How it is used if it does not concern all recordings.
const USE_FOR_SOME: &str = ". With `--map`, all files of a command are read with one map, and this map fits this file only: \
                            correct the columns of this file as the map says, or leave the file out.";

/// Whether what a sentence says is certain enough to prevent a diagnosis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Certainty {
    /// Of [`Report::doubts`].
    Certain,
    /// Of [`Report::warnings`].
    Possible,
}

/// What a column map is for, after an article.
pub fn of_a_map(certainty: Certainty) -> &'static str {
    match certainty {
        Certainty::Certain => "column map that corrects it",
        Certainty::Possible => "column map that would correct it, if that is the cause",
    }
}

/// The doubts about recordings that have the same column map.
pub struct Group<'a> {
    /// One sentence for each doubt about the first recording.
    pub texts: Vec<String>,
    /// The map (TOML), if one corrects them.
    pub map: Option<&'a str>,
    /// How the map is used.
    pub usage: String,
}

/// The `doubts` or warnings of `report`. Recordings with the same map are one group, and the sentences name its first recording.
pub fn groups<'a>(doubts: &'a [Doubt], certainty: Certainty, report: &Report) -> Vec<Group<'a>> {
    let mut groups: Vec<Vec<&'a Doubt>> = Vec::new();
    for doubt in doubts {
        let same = |group: &&mut Vec<&Doubt>| group[0].column_map == doubt.column_map;
        match groups.iter_mut().find(same) {
            Some(group) => group.push(doubt),
            None => groups.push(vec![doubt]),
        }
    }
    let all = report.recordings.train.len() + report.recordings.held_out.len();
    groups.into_iter().map(|doubts| group(&doubts, certainty, all)).collect()
}

/// The group of `doubts` (at least one); `all` is the number of recordings.
fn group<'a>(doubts: &[&'a Doubt], certainty: Certainty, all: usize) -> Group<'a> {
    let first = &doubts[0].recording;
    let mut files: Vec<&str> = doubts.iter().map(|doubt| doubt.recording.as_str()).collect();
    files.dedup();
    let others = match files.len() - 1 {
        0 if all == 1 => String::new(),
        0 => " (in this recording alone)".to_owned(),
        more if more + 1 == all => format!(" (and the same in {})", words::count(more, "other recording")),
        more => format!(" (and the same in {more} of {} other recordings)", all - 1),
    };
    let own = doubts.iter().filter(|doubt| doubt.recording == *first);
    let text = |doubt: &&Doubt| {
        let joint = doubt.joint.as_ref().map_or_else(String::new, |joint| format!("{joint}: "));
        format!("{first}{others}: {joint}{}", doubt.text)
    };
    Group {
        texts: own.map(text).collect(),
        map: doubts[0].column_map.as_deref(),
        usage: format!("A {}", of_a_map(certainty)) + if files.len() < all { USE_FOR_SOME } else { USE },
    }
}
