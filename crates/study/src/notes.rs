//! The notes on the inputs of a diagnosis, grouped by their text, because many recordings often have the same flaw.

use std::collections::BTreeSet;

use recording::Warning;

/// The largest number of gaps that are listed one by one.
const MOST_GAPS: usize = 3;

/// One note: its severity, its subject and its text.
#[derive(Clone, Debug)]
pub struct Note {
    /// `note` or `warning`.
    pub weight: &'static str,
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
    pub fn add(&mut self, weight: &'static str, file: &str, text: String) {
        self.list.push(Note {
            weight,
            file: file.to_owned(),
            text,
        });
    }

    /// The notes one by one.
    pub fn iter(&self) -> impl Iterator<Item = &Note> {
        self.list.iter()
    }

    /// One line for each note, or (`is_short`) for all notes that only differ in file, numbers and `joints`: the first of them,
    /// with the number of the others.
    pub fn lines(&self, joints: &[&str], is_short: bool) -> Vec<String> {
        let mut groups: Vec<(String, Vec<&Note>)> = Vec::new();
        for note in &self.list {
            let key = format!("{}: {}", note.weight, template(&note.text, joints));
            match groups.iter_mut().find(|group| is_short && group.0 == key) {
                Some(group) => group.1.push(note),
                None => groups.push((key, vec![note])),
            }
        }
        groups.iter().map(|(_, group)| line(group)).collect()
    }
}

/// The warnings of a list that are shown, and the number of gaps that are not.
pub fn shortened<T>(list: impl Iterator<Item = T>, warning: impl Fn(&T) -> &Warning) -> (Vec<T>, usize) {
    let mut gaps = 0;
    let told = list.filter(|item| {
        let is_gap = matches!(warning(item), Warning::Gap { .. });
        gaps += usize::from(is_gap);
        !is_gap || gaps <= MOST_GAPS
    });
    let told = told.collect();
    (told, gaps.saturating_sub(MOST_GAPS))
}

fn line(group: &[&Note]) -> String {
    let Note { weight, file, text } = group[0];
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

/// `text` with `…` in the place of numbers, and of names of `joints`; lists of joints become one.
fn template(text: &str, joints: &[&str]) -> String {
    let mut words: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let core = word.trim_matches(|letter: char| ",;:()%".contains(letter));
        let name = ["q_", "qd_", "tau_"].iter().find_map(|start| core.strip_prefix(start));
        let is_joint = joints.iter().any(|joint| *joint == core || Some(*joint) == name);
        if !core.is_empty() && (is_joint || core.parse::<f64>().is_ok()) {
            if is_joint && words.last().is_some_and(|last| last == "…,") {
                words.pop();
            }
            words.push(word.replacen(core, "…", 1));
        } else {
            words.push(word.to_owned());
        }
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_that_differ_in_file_joints_and_numbers_are_one_line() {
        let mut notes = Notes::default();
        notes.add("note", "a.csv", "a, b do not move".to_owned());
        notes.add("note", "a.csv", "no rows from 2.30 s to 2.34 s".to_owned());
        notes.add("note", "b.csv", "b do not move".to_owned());
        notes.add("warning", "b.csv", "b do not move".to_owned());
        notes.add("note", "a.csv", "no rows from 4.1 s to 4.2 s".to_owned());
        let expected = [
            "note: a.csv: a, b do not move (and 1 more like it in 2 files; --verbose lists them)",
            "note: a.csv: no rows from 2.30 s to 2.34 s (and 1 more like it in this file; --verbose lists them)",
            "warning: b.csv: b do not move",
        ];
        assert_eq!(notes.lines(&["a", "b"], true), expected);
        let all = notes.lines(&["a", "b"], false);
        assert_eq!((all.len(), all[2].as_str()), (5, "note: b.csv: b do not move"));
    }
}
