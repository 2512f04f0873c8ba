//! The notes on the inputs of a diagnosis, grouped by their kind, because many recordings often have the same flaw.

use std::collections::BTreeSet;
use std::mem::{Discriminant, discriminant};

use recording::{FindingKind, Warning};

use crate::check::MisfitKind;

/// The largest number of gaps that are listed one by one.
const MOST_GAPS: usize = 3;

/// What a note is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A property of a recording that was corrected or ignored when it was read.
    Warning(Discriminant<Warning>),
    /// Gaps that are not listed one by one.
    FurtherGaps,
    /// A doubtful property of a recording.
    Finding(FindingKind),
    /// A contradiction between a recording and the URDF.
    Misfit(MisfitKind),
    /// The place of a column map.
    ColumnMap,
}

impl From<&Warning> for Kind {
    fn from(warning: &Warning) -> Self {
        Self::Warning(discriminant(warning))
    }
}

/// One note: its severity, its kind, its subject and its text.
#[derive(Clone, Debug)]
pub struct Note {
    /// `note` or `warning`.
    pub weight: &'static str,
    /// What it is about.
    pub kind: Kind,
    /// The recording.
    pub file: String,
    /// The text.
    pub text: String,
}

/// Notes in the order in which they were made.
#[derive(Default)]
pub struct Notes {
    list: Vec<Note>,
}

impl Notes {
    /// Adds the notes on `file`; `weight` is `note` or `warning`.
    pub fn add(&mut self, weight: &'static str, kind: Kind, file: &str, text: String) {
        self.list.push(Note { weight, kind, file: file.to_owned(), text });
    }

    /// The notes one by one.
    pub fn iter(&self) -> impl Iterator<Item = &Note> {
        self.list.iter()
    }

    /// One line for each note, or (`is_short`) for all notes of one severity and kind: the first of them, with the number of the
    /// others.
    pub fn lines(&self, is_short: bool) -> Vec<String> {
        let mut groups: Vec<Vec<&Note>> = Vec::new();
        for note in &self.list {
            let is_like = |group: &&mut Vec<&Note>| (group[0].weight, group[0].kind) == (note.weight, note.kind);
            match groups.iter_mut().filter(|_| is_short).find(is_like) {
                Some(group) => group.push(note),
                None => groups.push(vec![note]),
            }
        }
        groups.iter().map(|group| line(group)).collect()
    }
}

/// The warnings of a list that are shown, and the number of gaps that are not.
pub fn shortened<T>(list: impl Iterator<Item = T>, warning: impl Fn(&T) -> &Warning) -> (Vec<T>, usize) {
    let mut gaps = 0;
    let shown = list.filter(|item| {
        let is_gap = matches!(warning(item), Warning::Gap { .. });
        gaps += usize::from(is_gap);
        !is_gap || gaps <= MOST_GAPS
    });
    let shown = shown.collect();
    (shown, gaps.saturating_sub(MOST_GAPS))
}

fn line(group: &[&Note]) -> String {
    let Note { weight, file, text, .. } = group[0];
    if group.len() == 1 {
        return format!("{weight}: {file}: {text}");
    }
    let files: BTreeSet<&str> = group.iter().map(|note| note.file.as_str()).collect();
    if group.iter().all(|note| note.text == *text) {
        return format!("{weight}: {} files: {text} (--verbose lists them)", files.len());
    }
    // The first one in full, as an example of the others.
    let more = group.len() - 1;
    let place = match files.len() {
        1 => "in this file".to_owned(),
        several => format!("in {several} files"),
    };
    format!("{weight}: {file}: {text} (and {more} more like it {place}; --verbose lists them)")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_of_one_kind_are_one_line() {
        let at_rest = Kind::Finding(FindingKind::JointAtRest);
        let limits = Kind::Misfit(MisfitKind::PositionLimits);
        let mut notes = Notes::default();
        notes.add("note", at_rest, "a.csv", "a, b do not move".to_owned());
        notes.add("note", limits, "a.csv", "positions exceed the limits by 2.3".to_owned());
        notes.add("note", at_rest, "b.csv", "b do not move".to_owned());
        notes.add("warning", at_rest, "b.csv", "b do not move".to_owned());
        notes.add("note", limits, "a.csv", "positions exceed the limits by 4.1".to_owned());
        let expected = [
            "note: a.csv: a, b do not move (and 1 more like it in 2 files; --verbose lists them)",
            "note: a.csv: positions exceed the limits by 2.3 (and 1 more like it in this file; --verbose lists them)",
            "warning: b.csv: b do not move",
        ];
        assert_eq!(notes.lines(true), expected);
        let all = notes.lines(false);
        assert_eq!((all.len(), all[2].as_str()), (5, "note: b.csv: b do not move"));
    }
}
