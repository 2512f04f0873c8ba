//! Recordings from CSV: read row by row, so that only the values are kept.

use std::fs::File;
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use csv::ByteRecord;

use crate::header;
use crate::rows::Rows;
use crate::{ColumnMap, Recording, RecordingError};

/// Of a file with more values, means over longer times are kept (1 GiB).
const MOST_VALUES: usize = 1 << 27;

impl Recording {
    /// Reads a recording whose header names `t` (s) and `q_<joint>`, `tau_<joint>` for the same joints,
    /// `qd_`, `qdd_`, `q_secondary_`, `tau_current_`, `current_` and `temperature_<joint>` where there are
    /// any, other columns as they are. What was dealt with is in [`Recording::warnings`].
    ///
    /// # Errors
    /// [`RecordingError`] with the line and the column, if the file cannot be read, a column is missing, a
    /// value is not a finite number, time runs back, or there are fewer than two rows.
    pub fn read_csv(path: &Path) -> Result<Self, RecordingError> {
        Self::read_csv_with(path, None)
    }

    /// As [`Self::read_csv`], with the columns that `map` names.
    ///
    /// # Errors
    /// As [`Self::read_csv`], and [`RecordingError::Map`] if the file lacks a column that the map names.
    pub fn read_csv_with(path: &Path, map: Option<&ColumnMap>) -> Result<Self, RecordingError> {
        Self::read_within(path, map, MOST_VALUES)
    }

    fn read_within(path: &Path, map: Option<&ColumnMap>, most: usize) -> Result<Self, RecordingError> {
        let unreadable = |reason| RecordingError::Read {
            path: path.to_owned(),
            reason,
        };
        let mut file = File::open(path).map_err(unreadable)?;
        let ends_whole = ends_with_newline(&mut file).map_err(unreadable)?;
        let start = read_start(&mut file).map_err(unreadable)?;
        if let Some((line, reason)) = no_table(&start) {
            let path = path.to_owned();
            return Err(RecordingError::Row { path, line, reason });
        }
        let delimiter = map
            .and_then(ColumnMap::delimiter)
            .unwrap_or_else(|| find_delimiter(&start));
        let mut csv = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .flexible(true)
            .buffer_capacity(1 << 18)
            .from_reader(Cursor::new(start).chain(file));
        let header_error = |reason: String| RecordingError::Header {
            path: path.to_owned(),
            reason,
        };
        let headers: Vec<String> = match csv.headers() {
            Ok(headers) => headers.iter().map(|header| header.trim().to_owned()).collect(),
            Err(error) => return Err(csv_error(path, error)),
        };
        if let Some(reason) = header::numbers(&headers) {
            return Err(header_error(reason));
        }
        if let Some(header) = header::doubled(&headers) {
            return Err(header_error(format!("there are two columns \"{header}\"; rename one")));
        }
        let plan = match map {
            Some(map) => map.plan(&headers, path)?,
            None => header::plan_by_names(&headers).map_err(header_error)?,
        };
        let mut rows = Rows::new(path, &plan, headers.len(), most);
        let mut record = ByteRecord::new();
        // A row is taken once the next is there: the last one may be cut.
        let mut held = ByteRecord::new();
        let mut any = false;
        loop {
            match csv.read_byte_record(&mut record) {
                Ok(true) => {
                    if any {
                        rows.take(&held)?;
                    }
                    std::mem::swap(&mut held, &mut record);
                    any = true;
                }
                Ok(false) => break,
                Err(error) => return Err(csv_error(path, error)),
            }
        }
        if any {
            rows.take_last(&held, ends_whole)?;
        }
        rows.finish()
    }
}

fn csv_error(path: &Path, error: csv::Error) -> RecordingError {
    let line = error.position().map_or(1, csv::Position::line);
    match error.into_kind() {
        csv::ErrorKind::Io(reason) => RecordingError::Read {
            path: path.to_owned(),
            reason,
        },
        kind => RecordingError::Row {
            path: path.to_owned(),
            line,
            reason: match kind {
                csv::ErrorKind::Utf8 { err, .. } => format!(
                    "cell {} is not UTF-8 (Latin-1?); save the file as UTF-8 (in spreadsheets \"CSV UTF-8\")",
                    err.field() + 1
                ),
                kind => format!("not CSV: {kind:?}; write it as UTF-8 text with one row a line"),
            },
        },
    }
}

/// Whether the file ends with a newline, or cannot say (a pipe).
fn ends_with_newline(file: &mut File) -> std::io::Result<bool> {
    if file.metadata()?.is_dir() {
        return Err(std::io::Error::other("it is a folder"));
    }
    if file.seek(SeekFrom::End(-1)).is_err() {
        return Ok(true);
    }
    let mut last = [0];
    file.read_exact(&mut last)?;
    file.rewind()?;
    Ok(last[0] == b'\n')
}

/// The first bytes of the file, which hold the header.
fn read_start(file: &mut File) -> std::io::Result<Vec<u8>> {
    let mut start = Vec::new();
    file.take(1 << 16).read_to_end(&mut start)?;
    Ok(start)
}

/// Why a file that begins so is no table of text, with the line.
fn no_table(start: &[u8]) -> Option<(u64, String)> {
    let text = start.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(start);
    let said = |reason: &str| Some((1, reason.to_owned()));
    if text.trim_ascii().is_empty() {
        return said("the file is empty; a recording has a header (t, q_<joint>, tau_<joint>, ...) and a row a sample");
    }
    if text.starts_with(b"\xFF\xFE") || text.starts_with(b"\xFE\xFF") {
        return said(
            "the text is UTF-16; save it as UTF-8 (in spreadsheets \"CSV UTF-8\"; or iconv -f UTF-16 -t UTF-8)",
        );
    }
    if let Some(at) = text.iter().position(|&byte| byte == 0) {
        let line = 1 + text[..at].iter().filter(|&&byte| byte == b'\n').count() as u64;
        let reason = "there is a zero byte: this is a binary file, or UTF-16; give a CSV file in UTF-8".to_owned();
        return Some((line, reason));
    }
    if text.trim_ascii().starts_with(b"<") {
        return said("this is XML (a URDF?), no CSV; give a recording here, and the robot's URDF with --robot");
    }
    None
}

/// The separator of the cells: a semicolon or a tab where the header has no comma.
fn find_delimiter(start: &[u8]) -> u8 {
    let header = start.split(|&byte| byte == b'\n').next().unwrap_or_default();
    let has = |byte: u8| header.contains(&byte);
    match (has(b','), has(b';'), has(b'\t')) {
        // Commas in numbers, too.
        (true, true, _) if header.first().is_some_and(u8::is_ascii_digit) => b';',
        (false, true, _) => b';',
        (false, false, true) => b'\t',
        _ => b',',
    }
}

#[cfg(test)]
#[path = "csv_tests.rs"]
mod tests;
