//! Errors of recordings.

use std::path::PathBuf;

use crate::Location;

/// Why a recording could not be read, understood or written.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be opened or read.
    #[error("{path}: cannot be read: {reason}; check the path and that you may read it")]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// The file or its folder cannot be written.
    #[error("{path}: cannot be written: {reason}; {}", write_remedy(reason))]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// The header lacks a required column.
    #[error("{path}{}: {reason}", if *has_lines { ":1" } else { "" })]
    Header {
        /// The file.
        path: PathBuf,
        /// Whether the header is a line of text.
        has_lines: bool,
        /// What is missing or doubled, and the remedy.
        reason: String,
    },
    /// The file is damaged, or contains no recording that its format allows.
    #[error("{path}: {format}: {reason}")]
    Format {
        /// The file.
        path: PathBuf,
        /// The format's name.
        format: &'static str,
        /// What was found, and the remedy.
        reason: String,
    },
    /// A row does not agree with the header.
    #[error("{path}{}: {reason}", place.suffix())]
    Row {
        /// The file.
        path: PathBuf,
        /// The line or row.
        place: Location,
        /// What was found, and the remedy.
        reason: String,
    },
    /// A cell does not contain a usable number.
    #[error("{path}{}: column \"{column}\" is \"{found}\", {what}; {remedy}", place.suffix())]
    Value {
        /// The file.
        path: PathBuf,
        /// The line or row.
        place: Location,
        /// The column's header.
        column: String,
        /// The content of the cell.
        found: String,
        /// The description of that content.
        what: &'static str,
        /// The remedy.
        remedy: &'static str,
    },
    /// A column map is invalid.
    #[error("{path}:{line}: {reason}")]
    Map {
        /// The map's file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What was found, and the remedy.
        reason: String,
    },
    /// Too few samples for a clock.
    #[error("the recording has {rows} rows, too few to estimate its clock, which needs at least {needed}")]
    TooShort {
        /// The number of rows.
        rows: usize,
        /// The least number of rows.
        needed: usize,
    },
    /// Rows follow one another faster than any drive records them.
    #[error(
        "its rows are {period:.1e} s apart, and no drive records so fast: are its stamps in another unit? Give the unit of the \
         time in a column map"
    )]
    Period {
        /// The time between rows (s).
        period: f64,
    },
    /// Time stamps from a program do not increase.
    #[error("sample {row}: time goes from {before} s to {after} s; it must increase")]
    Time {
        /// The sample, from 0.
        row: usize,
        /// The stamp before (s).
        before: f64,
        /// The stamp (s).
        after: f64,
    },
}

/// The remedy for a file that cannot be written.
pub fn write_remedy(reason: &std::io::Error) -> &'static str {
    use std::io::ErrorKind;
    match reason.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "the disk is full: free some space, or choose another disk"
        }
        ErrorKind::FileTooLarge => {
            "the file is larger than this disk, or a limit (ulimit -f), allows: choose another disk"
        }
        ErrorKind::ReadOnlyFilesystem => "the disk is read-only: choose another",
        ErrorKind::NotFound => "give a path in a folder that exists",
        _ => "choose a folder you may write to",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_disk_is_no_matter_of_permission() {
        let failed = |kind: std::io::ErrorKind| {
            let error = RecordingError::Write { path: "a.csv".into(), reason: kind.into() };
            error.to_string()
        };
        assert!(failed(std::io::ErrorKind::StorageFull).contains("the disk is full: free some space"));
        assert!(failed(std::io::ErrorKind::PermissionDenied).contains("a folder you may write to"));
    }
}
