//! The formats of recordings, and their recognition by the file's content.

mod csv;
mod csv_text;
mod mat;
mod mcap;
mod npz;
mod pages;
mod parquet;
mod rosbag2;
mod thrift;
mod unread;

use std::path::Path;

use crate::input::Input;
use crate::rows::Rows;
use crate::table::{Column, Table};
use crate::{ColumnMap, Recording, RecordingError, dialect, draft, header};

/// A file with more values is reduced to means over several rows (1 GiB).
const MOST_VALUES: usize = 1 << 27;

/// A format of files with recordings.
trait Format {
    /// Whether a file with this beginning, or a folder with this name, has this format.
    fn matches(&self, input: &Input) -> bool;

    /// The file as a table of named columns.
    ///
    /// # Errors
    /// [`RecordingError`] with the place, if the file is damaged.
    fn read(&self, input: Input, options: &Options<'_>) -> Result<Table, RecordingError>;
}

/// The options of a column map for reading a file.
pub(crate) struct Options<'a> {
    /// The separator of the cells of text.
    pub delimiter: Option<u8>,
    /// The topics to read of a file that has topics; all if there are none.
    pub topics: &'a [String],
    /// The time that is read of a longer recording, as windows (s).
    pub seconds: Option<f64>,
}

/// The formats; the first one that matches is used.
const FORMATS: &[&dyn Format] = &[
    &mcap::Mcap,
    &rosbag2::Rosbag2,
    &parquet::Parquet,
    &npz::Npz,
    &mat::Mat,
    &unread::Unread,
    // CSV comes last, because text has no signature.
    &csv::Csv,
];

impl Recording {
    /// Reads a recording of any format that `docs/recordings.md` lists, compressed or not. Its columns are `t` (s),
    /// `q_<joint>` and `tau_<joint>` for all joints, optionally `qd_`, `qdd_`, `q_secondary_`, `tau_current_`,
    /// `current_` and `temperature_<joint>`; or those of a known system. Other columns are kept unchanged.
    /// [`Recording::warnings`] lists what was corrected or omitted.
    ///
    /// # Errors
    /// [`RecordingError`] with the line or row and the column, if the file cannot be read, a column is missing, a
    /// value is not a finite number, time runs back, or there are fewer than two rows.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        Self::read_with(path, None)
    }

    /// Reads a recording as [`Self::read`] does, with the columns that `map` names.
    ///
    /// # Errors
    /// Those of [`Self::read`], and [`RecordingError::Map`] if the file lacks a column that the map names.
    pub fn read_with(path: &Path, map: Option<&ColumnMap>) -> Result<Self, RecordingError> {
        Self::read_within(path, map, (MOST_VALUES, None))
    }

    /// Reads a recording as [`Self::read_with`] does; but of one that is longer than `seconds`, only windows that are spread
    /// evenly over the whole and last between half of that time and all of it together. The rest is read for its time alone
    /// (see [`Self::left_out`]), so that a file of any length takes no more memory.
    ///
    /// # Errors
    /// Those of [`Self::read_with`], for the rows in the windows.
    pub fn read_windows(path: &Path, map: Option<&ColumnMap>, seconds: f64) -> Result<Self, RecordingError> {
        Self::read_within(path, map, (MOST_VALUES, Some(seconds)))
    }

    fn read_within(path: &Path, map: Option<&ColumnMap>, most: (usize, Option<f64>)) -> Result<Self, RecordingError> {
        let input = Input::open(path)?;
        let options = Options {
            delimiter: map.and_then(ColumnMap::delimiter),
            topics: map.map_or(&[], ColumnMap::topics),
            seconds: most.1,
        };
        let format = FORMATS.iter().find(|format| format.matches(&input));
        let format = format.ok_or_else(|| RecordingError::Read {
            path: path.to_owned(),
            reason: std::io::Error::other("it is a folder"),
        })?;
        let table = format.read(input, &options)?;
        Self::of_table(table, path, map, most)
    }

    /// A recording from columns in memory, which are named and read like those of a file: see [`Self::read_with`].
    /// `name` is its name in errors.
    ///
    /// # Errors
    /// Those of [`Self::read_with`], and if the columns have different lengths.
    pub fn of_columns(
        name: &str,
        columns: Vec<(String, Column)>,
        map: Option<&ColumnMap>,
    ) -> Result<Self, RecordingError> {
        let length = columns.first().map_or(0, |(_, column)| column.len());
        if let Some((header, column)) = columns.iter().find(|(_, column)| column.len() != length) {
            return Err(RecordingError::Header {
                path: name.into(),
                has_lines: false,
                reason: format!(
                    "column \"{header}\" has {} values, column \"{}\" has {length}; give one value per sample in each",
                    column.len(),
                    columns[0].0
                ),
            });
        }
        Self::of_table(Table::of_columns(columns), Path::new(name), map, (MOST_VALUES, None))
    }

    fn of_table(
        mut table: Table,
        path: &Path,
        map: Option<&ColumnMap>,
        (most, seconds): (usize, Option<f64>),
    ) -> Result<Self, RecordingError> {
        let topics = map.map_or(&[] as &[String], ColumnMap::topics);
        let has_lines = table.has_lines;
        let header_error = |reason: String| RecordingError::Header { path: path.to_owned(), has_lines, reason };
        let mut warnings = std::mem::take(&mut table.warnings);
        let plan = match map.filter(|map| map.has_joints()) {
            Some(map) => map.plan(&table.headers, &table.first, path)?,
            None => match dialect::of(&table.headers, topics) {
                Some(ready) => {
                    let (plan, note) = dialect::plan(&ready, &table.headers, &table.first, path, has_lines)?;
                    warnings.push(note);
                    plan
                }
                None => header::plan_by_names(&table.headers).map_err(|reason| {
                    header_error(header::twice(&table.headers) + &reason + &draft::of(&table.headers))
                })?,
            },
        };
        if let Some(header) = header::doubled(&table.headers, &plan) {
            return Err(header_error(format!("there are two columns \"{header}\"; rename one")));
        }
        if let Some(joint) = plan.joints.iter().find(|joint| joint.contains(char::is_control)) {
            return Err(header_error(format!(
                "the name of the joint {joint:?} holds a line break or another control character; rename its columns"
            )));
        }
        // A format that holds all in memory has chosen the windows.
        let seconds = seconds.filter(|_| table.left_out == 0.0);
        let mut rows = Rows::new(path, has_lines, &plan, (most, seconds));
        let mut number = 0;
        while let Some(row) = table.rows.next()? {
            rows.take(&row, table.breaks.contains(&number))?;
            number += 1;
        }
        let mut recording = rows.finish(warnings, table.rows.warnings())?;
        recording.left_out += table.left_out;
        Ok(recording)
    }
}

#[cfg(test)]
#[path = "format/csv_tests.rs"]
mod csv_tests;
