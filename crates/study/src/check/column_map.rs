//! The column map that corrects a recording: TOML, ready to paste.

use std::fmt::Write;

/// The value of a key in a joint's table.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A text.
    Text(&'static str),
    /// The column that the named joint has for this key.
    ColumnOf(String),
}

/// A key of a column map that corrects something.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    joint: String,
    key: &'static str,
    value: Value,
}

impl Change {
    /// `key = value` in the table of `joint`.
    pub fn new(joint: &str, key: &'static str, value: Value) -> Self {
        Self {
            joint: joint.to_owned(),
            key,
            value,
        }
    }

    /// A factor of the torque, estimated from the model, with three digits.
    pub fn scale(joint: &str, factor: f64) -> Self {
        let short = format!("{factor:.2e}").parse().unwrap_or(factor);
        Self::new(joint, "tau_scale", Value::Number(short))
    }
}

/// The map with `changes`: complete for a recording with testbed's own column names (`own`, with velocities or not); otherwise,
/// the keys to change in the map that gives the columns.
pub fn text(joints: &[String], changes: &[Change], own: bool, velocities: bool) -> Option<String> {
    if changes.is_empty() {
        return None;
    }
    let mut text = if own {
        "[time]\ncolumn = \"t\"\n".to_owned()
    } else {
        "# keys to add to the column map; a factor multiplies the one that is there, an offset is added to it\n"
            .to_owned()
    };
    for joint in joints {
        let is_here = |change: &&Change| change.joint == *joint && (velocities || change.key != "qd");
        let here: Vec<&Change> = changes.iter().filter(is_here).collect();
        if !own && here.is_empty() {
            continue;
        }
        let _ = writeln!(text, "[joints.{}]", key_of(joint));
        if own {
            let columns = ["q", "tau", "qd"].iter().take(if velocities { 3 } else { 2 });
            for key in columns.filter(|key| here.iter().all(|change| change.key != **key)) {
                let _ = writeln!(text, "{key} = {}", quoted(&format!("{key}_{joint}")));
            }
        }
        for Change { key, value, .. } in here {
            let _ = match value {
                Value::Number(number) => writeln!(text, "{key} = {number}"),
                Value::Text(word) => writeln!(text, "{key} = {}", quoted(word)),
                Value::ColumnOf(other) if own => writeln!(text, "{key} = {}", quoted(&format!("{key}_{other}"))),
                Value::ColumnOf(other) => writeln!(text, "# {key}: the column that [joints.{}] has", key_of(other)),
            };
        }
    }
    Some(text)
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A key of TOML needs quotation marks if it has other characters than these.
fn key_of(joint: &str) -> String {
    let is_bare = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
    if !joint.is_empty() && joint.chars().all(is_bare) {
        joint.to_owned()
    } else {
        quoted(joint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_is_whole_for_own_columns_and_only_what_changes_for_others() {
        let joints = ["a".to_owned(), "b/c".to_owned()];
        let changes = [
            Change::new("a", "tau", Value::ColumnOf("b/c".into())),
            Change::new("b/c", "q_unit", Value::Text("deg")),
            Change::scale("b/c", 0.012_345),
        ];
        let whole = text(&joints, &changes, true, true).expect("there are changes");
        let expected = "[time]\ncolumn = \"t\"\n[joints.a]\nq = \"q_a\"\nqd = \"qd_a\"\ntau = \"tau_b/c\"\n\
                        [joints.\"b/c\"]\nq = \"q_b/c\"\ntau = \"tau_b/c\"\nqd = \"qd_b/c\"\nq_unit = \"deg\"\n\
                        tau_scale = 0.0123\n";
        assert_eq!(whole, expected);
        let part = text(&joints, &changes[1..2], false, true).expect("there are changes");
        assert!(part.ends_with("\n[joints.\"b/c\"]\nq_unit = \"deg\"\n"), "{part}");
        assert!(!part.contains("joints.a"), "{part}");
        assert_eq!(text(&joints, &[], true, false), None);
    }
}
