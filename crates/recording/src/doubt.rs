//! Why values cannot be used, and how to mend them.

use std::path::Path;

use crate::RecordingError;
use crate::header::{Channel, Plan};
use crate::location::Location;
use crate::table::{Cell, Row};

/// What a value is, and how to mend it.
pub type Doubt = (&'static str, &'static str);

/// A value that nothing measures.
pub const FAR: Doubt = ("far beyond what is measured", "check its unit, or delete the row: short gaps are filled");

/// Why a cell is no number that can be used.
pub fn unusable(cell: Cell<'_>, remedy: &'static str) -> Doubt {
    let comma = |cell: &[u8]| {
        let text = String::from_utf8_lossy(cell);
        text.contains(',') && Cell::Text(text.replacen(',', ".", 1).as_bytes()).number().is_some()
    };
    match cell {
        Cell::Text(cell) if comma(cell) => ("a number with a decimal comma", "write numbers with a decimal point"),
        _ => ("not a finite number", remedy),
    }
}

/// Whether the row is the header again, as in files that were joined.
pub fn is_header(plan: &Plan, row: &Row<'_>) -> bool {
    let is = |index: usize, header: &str| {
        let Cell::Text(cell) = row.cell(index) else {
            return false;
        };
        cell.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(cell).trim_ascii() == header.as_bytes()
    };
    let mut channels = plan.channels.iter();
    is(plan.time.index, &plan.time.header) && channels.all(|channel| is(channel.index, &channel.header))
}

/// The error of a required value that is missing where others of its column are not.
pub fn missing(path: &Path, channel: &Channel, place: Location, found: String) -> RecordingError {
    RecordingError::Value {
        path: path.to_owned(),
        place,
        column: channel.header.clone(),
        found,
        what: "not a finite number",
        remedy: "delete the row: a short gap is filled, and a long one divides the recording. If many cells are empty, because several topics were \
                 exported into one table, export each joint's columns from one topic",
    }
}

/// A number without hundreds of zeros.
pub fn short(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-9 { format!("{value:e}") } else { value.to_string() }
}
