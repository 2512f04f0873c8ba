//! Places in the text of a URDF, and errors with them.

use std::path::Path;

use crate::error::ArmError;

pub(super) fn syntax_error(path: &Path, line: Option<usize>, reason: String) -> ArmError {
    let place = line.map_or(String::new(), |line| format!(":{line}"));
    ArmError::Syntax { path: path.to_owned(), place, reason }
}

pub(super) fn line_at(text: &str, position: usize) -> usize {
    text.as_bytes()[..position.min(text.len())].iter().filter(|byte| **byte == b'\n').count() + 1
}

/// The line (from 1) of the element `<tag … name="name"`, or that of the last such tag, or 1.
pub(super) fn line_of(text: &str, tag: &str, name: &str) -> usize {
    let open = format!("<{tag}");
    let mut line = 1;
    for (start, _) in text.match_indices(&open) {
        let element = text[start..].split('>').next().unwrap_or_default();
        if [format!("name=\"{name}\""), format!("name='{name}'")].iter().any(|n| element.contains(n.as_str())) {
            line = line_at(text, start);
        }
    }
    line
}
