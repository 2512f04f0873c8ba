//! Text with a header and a row per sample, read row by row, so that only the values are kept.

use std::io::Read;
use std::path::{Path, PathBuf};

use csv::ByteRecord;

use super::csv_text::{self, Comments, Separator, Squeezed};
use super::{Format, Options};
use crate::input::Input;
use crate::location::Location;
use crate::table::{Cell, Row, RowSource, Table};
use crate::{RecordingError, Warning, header};

/// Comma-separated values, or with another separator.
pub struct Csv;

impl Format for Csv {
    fn matches(&self, input: &Input) -> bool {
        !input.is_folder()
    }

    fn read(&self, input: Input, options: &Options<'_>) -> Result<Table, RecordingError> {
        let path = input.path.clone();
        if let Some((line, reason)) = csv_text::no_table(&input.head) {
            let place = Location::Line(line);
            return Err(RecordingError::Row { path, place, reason });
        }
        let (comments, start) = csv_text::comments(&input.head);
        let separator = match options.delimiter {
            Some(b' ') => Separator::Spaces,
            Some(delimiter) => Separator::Byte(delimiter),
            None => csv_text::find_separator(start),
        };
        let has_comments = comments != Comments::None;
        let headless = match comments {
            Comments::HeaderIsLast(headers) => Some(headers),
            _ => csv_text::headless(start, separator),
        };
        let (stream, ends_whole) = input.into_stream()?;
        let (delimiter, stream): (u8, Box<dyn Read>) = match separator {
            Separator::Byte(delimiter) => (delimiter, stream),
            Separator::Spaces => (b' ', Box::new(Squeezed::new(stream))),
        };
        let mut csv = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .flexible(true)
            .has_headers(headless.is_none())
            .comment(has_comments.then_some(b'#'))
            .buffer_capacity(1 << 18)
            .from_reader(stream);
        let headers = match headless {
            Some(headers) => headers,
            None => match csv.headers() {
                Ok(headers) => headers.iter().map(|header| header.trim().to_owned()).collect(),
                Err(error) => return Err(csv_error(&path, error)),
            },
        };
        if let Some(reason) = header::numbers(&headers) {
            return Err(RecordingError::Header { path, has_lines: true, reason });
        }
        let mut rows = Lines {
            path,
            csv,
            width: headers.len(),
            ends_whole,
            newest: ByteRecord::new(),
            before: ByteRecord::new(),
            above: Vec::new(),
            any: false,
            cut: None,
        };
        rows.any = rows.advance()?;
        let first = if rows.any { &rows.newest } else { &rows.before };
        let text = |cell: &[u8]| String::from_utf8_lossy(cell.trim_ascii()).into_owned();
        Ok(Table {
            has_lines: true,
            first: first.iter().map(text).collect(),
            headers,
            rows: Box::new(rows),
            warnings: Vec::new(),
            left_out: 0.0,
            breaks: Vec::new(),
        })
    }
}

/// The rows of a file, delayed by one, because the last one may be cut.
struct Lines {
    path: PathBuf,
    csv: csv::Reader<Box<dyn Read>>,
    width: usize,
    ends_whole: bool,
    /// The last row that was read, and the one before it.
    newest: ByteRecord,
    before: ByteRecord,
    /// The last cell of the row before these.
    above: Vec<u8>,
    /// Whether `newest` has not been returned yet.
    any: bool,
    /// The line of a last row that is cut.
    cut: Option<Location>,
}

impl Lines {
    /// Reads the next row into `newest`.
    fn advance(&mut self) -> Result<bool, RecordingError> {
        std::mem::swap(&mut self.newest, &mut self.before);
        let read = self.csv.read_byte_record(&mut self.newest);
        read.map_err(|error| csv_error(&self.path, error))
    }

    fn refuse(&self, row: &ByteRecord, reason: String) -> RecordingError {
        RecordingError::Row { path: self.path.clone(), place: Row::of_text(row).place, reason }
    }

    /// Whether the last row, which is in `before`, is complete.
    fn is_last_whole(&self) -> Result<bool, RecordingError> {
        let row = &self.before;
        // Everything after an open quotation mark is one cell.
        if row.iter().any(|cell| cell.contains(&b'\n')) {
            let reason = "a quotation mark is not closed in this row; close it or take it out".to_owned();
            return Err(self.refuse(row, reason));
        }
        if self.ends_whole || row.len() != self.width {
            return Ok(self.ends_whole && row.len() == self.width || row.len() > self.width);
        }
        let cell = row.iter().next_back().unwrap_or_default();
        // Without a newline at the end, digits of the last number may be missing.
        let is_number = |cell: &[u8]| Cell::Text(cell).number().is_some();
        Ok(cell.len() >= self.above.len() && (is_number(cell) || !is_number(&self.above)))
    }

    fn check_width(&self, row: &ByteRecord) -> Result<(), RecordingError> {
        // Spreadsheets may write separators after the last cell.
        if row.len() >= self.width && row.iter().skip(self.width).all(|cell| cell.trim_ascii().is_empty()) {
            return Ok(());
        }
        let remedy = if row.len() + 1 >= 2 * self.width {
            "are there decimal commas? Write numbers with a decimal point"
        } else {
            "mend or delete the row"
        };
        let found = row.len();
        Err(self.refuse(row, format!("the row has {found} cells, the header {}; {remedy}", self.width)))
    }
}

impl RowSource for Lines {
    fn next(&mut self) -> Result<Option<Row<'_>>, RecordingError> {
        if !self.any {
            return Ok(None);
        }
        self.above.clear();
        self.above.extend_from_slice(self.before.iter().next_back().unwrap_or_default());
        self.any = self.advance()?;
        if !self.any && !self.is_last_whole()? {
            self.cut = Some(Row::of_text(&self.before).place);
            return Ok(None);
        }
        self.check_width(&self.before)?;
        Ok(Some(Row::of_text(&self.before)))
    }

    fn warnings(&mut self) -> Vec<Warning> {
        self.cut.map(|place| Warning::CutFile { line: place }).into_iter().collect()
    }
}

fn csv_error(path: &Path, error: csv::Error) -> RecordingError {
    let line = error.position().map_or(1, csv::Position::line);
    match error.into_kind() {
        csv::ErrorKind::Io(reason) => RecordingError::Read { path: path.to_owned(), reason },
        kind => RecordingError::Row {
            path: path.to_owned(),
            place: Location::Line(line),
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
