//! What a text that does not parse as URDF most likely is, and where.

use std::path::Path;

use crate::error::ArmError;

/// The attributes that hold numbers.
const NUMBERS: [&str; 18] = [
    "value", "ixx", "ixy", "ixz", "iyy", "iyz", "izz", "xyz", "rpy", "lower", "upper", "effort", "velocity", "damping",
    "friction", "radius", "length", "size",
];

/// Refuses a text that xacro has still to expand; parsed as it is, it would lose parts silently.
pub(super) fn refuse_xacro(text: &str, path: &Path) -> Result<(), ArmError> {
    let found = ["<xacro:", "=\"${", "=\"$("]
        .iter()
        .filter_map(|mark| text.find(mark))
        .min();
    match found {
        None => Ok(()),
        Some(position) => Err(syntax_error(
            path,
            Some(line_at(text, position)),
            "is xacro, not URDF; expand it first: xacro FILE > robot.urdf".into(),
        )),
    }
}

/// The parser's error, with the place of the first number that is none, if that is what it met.
pub(super) fn explain(text: &str, path: &Path, error: &urdf_rs::UrdfError) -> ArmError {
    for attribute in NUMBERS {
        for (position, opening) in text.match_indices(&format!(" {attribute}=\"")) {
            let value = text[position + opening.len()..].split('"').next().unwrap_or_default();
            if value.split_whitespace().any(|word| word.parse::<f64>().is_err()) {
                let reason = format!("{attribute}=\"{value}\" is not a number; give one in SI units");
                return syntax_error(path, Some(line_at(text, position)), reason);
            }
        }
    }
    syntax_error(path, None, format!("is not a URDF: {error}; check it with check_urdf"))
}

fn syntax_error(path: &Path, line: Option<usize>, reason: String) -> ArmError {
    let place = line.map_or(String::new(), |line| format!(":{line}"));
    ArmError::Syntax {
        path: path.to_owned(),
        place,
        reason,
    }
}

fn line_at(text: &str, position: usize) -> usize {
    text[..position].matches('\n').count() + 1
}
