//! A table of named columns that is read row by row: every format converts its file into one.

use csv::ByteRecord;

use crate::location::Location;
use crate::{RecordingError, Warning};

/// One value of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell<'a> {
    /// Text, which may be a number.
    Text(&'a [u8]),
    /// A number, which may be NaN: missing.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// A time (ns since 1970).
    Nanos(i64),
}

impl Cell<'_> {
    /// The finite number that it holds.
    pub fn number(self) -> Option<f64> {
        let value = match self {
            Self::Text(cell) => std::str::from_utf8(cell.trim_ascii()).ok()?.parse().ok()?,
            Self::Number(value) => value,
            Self::Integer(value) => value as f64,
            Self::Nanos(nanos) => nanos as f64 * 1e-9,
        };
        Some(value).filter(|value: &f64| value.is_finite())
    }

    /// Whether there is no value: an empty cell, or NaN.
    pub fn is_missing(self) -> bool {
        match self {
            Self::Text(cell) => {
                let cell = cell.trim_ascii();
                cell.is_empty() || cell.eq_ignore_ascii_case(b"nan")
            }
            Self::Number(value) => value.is_nan(),
            Self::Integer(_) | Self::Nanos(_) => false,
        }
    }

    /// Its description in a message.
    pub fn shown(self) -> String {
        let text = match self {
            Self::Text(cell) => String::from_utf8_lossy(cell).into_owned(),
            Self::Number(value) => value.to_string(),
            Self::Integer(value) | Self::Nanos(value) => value.to_string(),
        };
        let short: String = text.chars().take(40).collect();
        if short.len() < text.len() { format!("{short}…") } else { short }
    }
}

/// A column that is held in memory.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// Numbers; NaN where there is none.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Integers(Vec<i64>),
    /// Times (ns since 1970).
    Nanos(Vec<i64>),
}

impl Column {
    /// The number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Integers(values) | Self::Nanos(values) => values.len(),
        }
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values at these indices.
    pub(crate) fn picked(&self, places: impl Iterator<Item = usize>) -> Self {
        match self {
            Self::Numbers(values) => Self::Numbers(places.map(|place| values[place]).collect()),
            Self::Integers(values) => Self::Integers(places.map(|place| values[place]).collect()),
            Self::Nanos(values) => Self::Nanos(places.map(|place| values[place]).collect()),
        }
    }

    fn cell(&self, row: usize) -> Cell<'_> {
        match self {
            Self::Numbers(values) => Cell::Number(values[row]),
            Self::Integers(values) => Cell::Integer(values[row]),
            Self::Nanos(values) => Cell::Nanos(values[row]),
        }
    }
}

/// One row of a table.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// The place in the file.
    pub place: Location,
    cells: Cells<'a>,
}

#[derive(Clone, Copy, Debug)]
enum Cells<'a> {
    Record(&'a ByteRecord),
    Columns(&'a [Column], usize),
}

impl<'a> Row<'a> {
    /// A row of text, which has as many cells as there are columns.
    pub fn of_text(record: &'a ByteRecord) -> Self {
        Self { place: Location::Line(record.position().map_or(1, csv::Position::line)), cells: Cells::Record(record) }
    }

    /// The value in a column.
    pub fn cell(&self, column: usize) -> Cell<'a> {
        match self.cells {
            Cells::Record(record) => Cell::Text(record.get(column).unwrap_or_default()),
            Cells::Columns(columns, row) => columns[column].cell(row),
        }
    }
}

/// A source of rows.
pub trait RowSource {
    /// The next row; `None` at the end.
    fn next(&mut self) -> Result<Option<Row<'_>>, RecordingError>;

    /// The warnings about the rows that were read.
    fn warnings(&mut self) -> Vec<Warning> {
        Vec::new()
    }
}

/// Named columns and their rows.
pub struct Table {
    /// Whether it is text, whose first line contains the names of the columns.
    pub has_lines: bool,
    /// The columns' names.
    pub headers: Vec<String>,
    /// The cells of the first row, if they are text, because they may contain names of joints.
    pub first: Vec<String>,
    /// The rows.
    pub rows: Box<dyn RowSource>,
    /// The warnings about the file before its first row.
    pub warnings: Vec<Warning>,
    /// The time that was recorded and is not in the rows (s).
    pub left_out: f64,
    /// The rows with which another run begins.
    pub breaks: Vec<usize>,
}

impl Table {
    /// A table of columns in memory, all of which have the same number of values.
    pub fn of_columns(columns: Vec<(String, Column)>) -> Self {
        let (headers, columns): (Vec<String>, Vec<Column>) = columns.into_iter().unzip();
        let rows = columns.iter().map(Column::len).min().unwrap_or(0);
        Self {
            has_lines: false,
            first: Vec::new(),
            headers,
            rows: Box::new(Held { columns, rows, next: 0 }),
            warnings: Vec::new(),
            left_out: 0.0,
            breaks: Vec::new(),
        }
    }
}

struct Held {
    columns: Vec<Column>,
    rows: usize,
    next: usize,
}

impl RowSource for Held {
    fn next(&mut self) -> Result<Option<Row<'_>>, RecordingError> {
        if self.next == self.rows {
            return Ok(None);
        }
        self.next += 1;
        Ok(Some(Row { place: Location::Row(self.next as u64), cells: Cells::Columns(&self.columns, self.next - 1) }))
    }
}
