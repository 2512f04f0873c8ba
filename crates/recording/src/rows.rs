//! The rows of a table, converted by the plan; duplicates and separate runs are recognised.

use std::path::Path;

use crate::doubt::{Doubt, FAR, is_header, missing, short, unusable};
use crate::gathered::{Gathered, State};
use crate::header::Plan;
use crate::location::Location;
use crate::stamp::Stamps;
use crate::stray::{Ends, too_long};
use crate::table::{Cell, Row};
use crate::thinned::Thinned;
use crate::warning::RUN_PAUSE;
use crate::{Recording, RecordingError, Warning};

/// The first stamp of a new run differs from that of the previous run by at most this share of the run's duration.
const RESTART_SHARE: f64 = 0.01;
/// The smallest number of rows of a run in a file with several.
const RUN_ROWS: usize = 50;
/// The largest share of rows that have the stamp of the previous row and other values. With coarse stamps, it may be large; with rows of
/// two sources in turn, it is one half.
const DIFFERING_SHARE: f64 = 0.4;

/// The largest plausible value of any quantity (SI).
const LARGEST: f64 = 1e9;
/// The latest plausible stamp (s).
const LATEST: f64 = 1e15;

/// The rows that were read so far, converted by the plan.
pub struct Rows<'a> {
    path: &'a Path,
    has_lines: bool,
    plan: &'a Plan,
    /// The time, the channels, and the other columns.
    values: Thinned,
    /// The row that is being converted, and the previous one.
    row: Vec<f64>,
    before: Vec<f64>,
    /// Whether the row before was read for its time alone.
    is_left_out: bool,
    /// For each other column, whether all its cells are numbers so far.
    numeric: Vec<bool>,
    /// The state of each channel.
    states: Vec<State>,
    /// The number of rows of this run, its number in the file, and the number of runs by these numbers.
    in_run: usize,
    number: f64,
    runs: usize,
    warnings: Vec<Warning>,
    stamps: Stamps,
    ends: Ends,
    /// The stamp of the previous row in the file (s), and the time that it got (s).
    stamp: f64,
    placed: f64,
    /// The first stamp of this run in the file (s), and the offset that is added to its stamps (s).
    first: f64,
    shift: f64,
    /// Rows with the stamp of the row before: the number of those with its values, too, that of the others, and the place of the first
    /// of each.
    duplicates: usize,
    differing: usize,
    duplicate_place: Location,
    differing_place: Location,
}

impl<'a> Rows<'a> {
    /// An empty list of rows, which keeps at most `most` values. If `seconds` are given, it keeps windows of that duration together of
    /// a longer recording.
    pub fn new(path: &'a Path, has_lines: bool, plan: &'a Plan, (most, seconds): (usize, Option<f64>)) -> Self {
        let values = Thinned::new(1 + plan.channels.len() + plan.others.len(), most);
        Self {
            path,
            has_lines,
            plan,
            values: match seconds {
                Some(seconds) => values.in_windows(seconds),
                None => values,
            },
            is_left_out: false,
            row: Vec::new(),
            before: Vec::new(),
            numeric: vec![true; plan.others.len()],
            states: vec![State::New; plan.channels.len()],
            in_run: 0,
            number: f64::NAN,
            runs: 1,
            warnings: Vec::new(),
            stamps: Stamps::default(),
            ends: Ends::default(),
            stamp: f64::NAN,
            placed: f64::NEG_INFINITY,
            first: f64::NAN,
            shift: 0.0,
            duplicates: 0,
            differing: 0,
            duplicate_place: Location::Line(1),
            differing_place: Location::Line(1),
        }
    }

    /// Adds a row; `begins_run` if its time is already that of another run.
    pub fn take(&mut self, row: &Row<'_>, begins_run: bool) -> Result<(), RecordingError> {
        for (index, name) in &self.plan.names {
            if !matches!(row.cell(*index), Cell::Text(cell) if cell.trim_ascii() == name.as_bytes()) {
                let found = row.cell(*index).shown();
                let reason = format!(
                    "joint \"{found}\" stands where \"{name}\" stood before; the order of the names must stay the same: \
                     give the bag itself, whose names are read message by message"
                );
                return Err(self.row_error(row, reason));
            }
        }
        let stamp = self.stamp(row)?;
        let mut begins = self.new_run(row, stamp);
        if begins {
            self.shift += self.stamp + RUN_PAUSE - stamp;
            self.first = stamp;
        } else if begins_run {
            begins = true;
            self.first = stamp;
        } else if self.in_run > 0 && stamp <= self.stamp {
            if stamp < self.stamp {
                self.restart(row, stamp)?;
                begins = true;
            } else if !self.is_left_out && self.is_duplicate(row) {
                return Ok(());
            }
        } else if self.in_run == 0 {
            self.first = stamp;
        }
        self.ends.add(row.place, stamp, begins);
        self.in_run = if begins { 1 } else { self.in_run + 1 };
        self.stamp = stamp;
        // Rows with one stamp keep their order, and the clock finds their ticks.
        self.placed = (stamp + self.shift).max(self.placed.next_up());
        self.is_left_out = !self.values.wants(self.placed, begins);
        if self.is_left_out {
            return Ok(());
        }
        self.row.clear();
        self.row.push(self.placed);
        for index in 0..self.plan.channels.len() {
            let value = self.channel_value(row, index)?;
            self.row.push(value);
        }
        for (numeric, (index, header)) in self.numeric.iter_mut().zip(&self.plan.others) {
            let value = row.cell(*index).number();
            if *numeric && value.is_none() {
                *numeric = false;
                self.warnings.push(Warning::ColumnLeftOut {
                    column: header.clone(),
                    line: row.place,
                    found: row.cell(*index).shown(),
                });
            }
            self.row.push(value.unwrap_or(f64::NAN));
        }
        self.values.push(&self.row);
        std::mem::swap(&mut self.row, &mut self.before);
        Ok(())
    }

    /// The time of the row in the file (s).
    fn stamp(&mut self, row: &Row<'_>) -> Result<f64, RecordingError> {
        let time = &self.plan.time;
        match self.stamps.seconds(row, time) {
            Some(stamp) if stamp.abs() <= LATEST => Ok(stamp),
            Some(_) => Err(self.value_error(row, time.index, &time.header, FAR)),
            None if is_header(self.plan, row) => {
                Err(self.row_error(row, "the header is repeated here; delete the line".to_owned()))
            }
            None => Err(self.value_error(
                row,
                time.index,
                &time.header,
                unusable(
                    row.cell(time.index),
                    // Where the first row fails, all probably do.
                    if self.values.read() == 0 {
                        "give the times as numbers or in ISO 8601 (2024-03-01T12:00:00.004Z)"
                    } else {
                        "give the time as a number or in ISO 8601 (2024-03-01T12:00:00.004Z), or delete the row"
                    },
                ),
            )),
        }
    }

    /// Whether a further run begins with this row, according to the column that numbers them.
    fn new_run(&mut self, row: &Row<'_>, stamp: f64) -> bool {
        let Some((run, _)) = &self.plan.time.run else {
            return false;
        };
        let number = row.cell(*run).number().unwrap_or(f64::NAN);
        let before = std::mem::replace(&mut self.number, number);
        // The clock may also continue from run to run.
        let begins = self.in_run > 0 && number != before && !(number.is_nan() && before.is_nan());
        self.runs += usize::from(begins);
        begins && stamp.is_finite()
    }

    /// The value of a channel in SI; NaN if an optional value is missing.
    fn channel_value(&mut self, row: &Row<'_>, index: usize) -> Result<f64, RecordingError> {
        let channel = &self.plan.channels[index];
        let cell = row.cell(channel.index);
        let found = cell.number().map(|value| channel.factor * value + channel.offset);
        if found.is_some_and(|value| !value.is_finite() || value.abs() > LARGEST) {
            return Err(self.value_error(row, channel.index, &channel.header, FAR));
        }
        match (found, &self.states[index]) {
            (_, State::LeftOut) => return Ok(f64::NAN),
            (Some(value), State::New | State::Values) => {
                self.states[index] = State::Values;
                return Ok(value);
            }
            (Some(_), State::Missing { place, found }) => {
                return Err(missing(self.path, channel, *place, found.clone()));
            }
            (None, _) => {}
        }
        if !channel.quantity.is_required() {
            self.warnings.push(Warning::ColumnLeftOut {
                column: channel.header.clone(),
                line: row.place,
                found: cell.shown(),
            });
            self.states[index] = State::LeftOut;
            return Ok(f64::NAN);
        }
        match &self.states[index] {
            State::New if cell.is_missing() => {
                self.states[index] = State::Missing { place: row.place, found: cell.shown() };
                Ok(f64::NAN)
            }
            State::Missing { .. } if cell.is_missing() => Ok(f64::NAN),
            _ => Err(self.value_error(
                row,
                channel.index,
                &channel.header,
                unusable(cell, "delete the row: a short gap is filled, and a long one divides the recording"),
            )),
        }
    }

    fn value_error(&self, row: &Row<'_>, index: usize, column: &str, (what, remedy): Doubt) -> RecordingError {
        RecordingError::Value {
            path: self.path.to_owned(),
            place: row.place,
            column: column.to_owned(),
            found: row.cell(index).shown(),
            what,
            remedy,
        }
    }

    fn row_error(&self, row: &Row<'_>, reason: String) -> RecordingError {
        RecordingError::Row { path: self.path.to_owned(), place: row.place, reason }
    }

    /// Counts a row with the stamp of the previous row. Whether its values are the same, too.
    fn is_duplicate(&mut self, row: &Row<'_>) -> bool {
        let channels = self.plan.channels.iter().zip(&self.states).map(|(channel, state)| {
            let value = row.cell(channel.index).number();
            let value = value.filter(|_| *state != State::LeftOut);
            value.map_or(f64::NAN, |value| channel.factor * value + channel.offset)
        });
        let others = self.plan.others.iter().map(|(index, _)| row.cell(*index).number());
        let values = channels.chain(others.map(|value| value.unwrap_or(f64::NAN)));
        let differs = |(value, before): (f64, &f64)| value.to_bits() != before.to_bits();
        let differs = values.zip(&self.before[1..]).any(differs);
        let (count, place) = if differs {
            (&mut self.differing, &mut self.differing_place)
        } else {
            (&mut self.duplicates, &mut self.duplicate_place)
        };
        *count += 1;
        if *count == 1 {
            *place = row.place;
        }
        !differs
    }

    /// Handles time that decreases: a further run if it starts at the time at which this run started, otherwise an
    /// error.
    fn restart(&mut self, row: &Row<'_>, stamp: f64) -> Result<(), RecordingError> {
        let length = self.stamp - self.first;
        let near_start = (stamp - self.first).abs() <= RESTART_SHARE * length;
        if self.in_run < RUN_ROWS || !near_start {
            return Err(self.row_error(
                row,
                format!(
                    "time runs back, from {} s to {} s; sort the rows by time, or keep each run in a file of its own",
                    short(self.stamp),
                    short(stamp)
                ),
            ));
        }
        if let Some((place, reason)) = self.ends.jumped(stamp, self.stamps.epoch()) {
            return Err(RecordingError::Row { path: self.path.to_owned(), place, reason });
        }
        let before = self.stamp;
        self.shift += self.stamp + RUN_PAUSE - stamp;
        self.first = stamp;
        self.warnings.push(Warning::ClockRestart { line: row.place, before, after: stamp, placed: stamp + self.shift });
        Ok(())
    }

    /// The recording that the rows make; `before` are the warnings from before the rows, `warnings` those of the table's end.
    pub fn finish(mut self, before: Vec<Warning>, warnings: Vec<Warning>) -> Result<Recording, RecordingError> {
        self.warnings.splice(0..0, before);
        let path = self.path.to_owned();
        let rows = self.values.read();
        if rows < 2 {
            let reason = match (rows, self.duplicates) {
                (1, 1..) => format!(
                    "all {} rows have the time {} s; check the column of the time",
                    1 + self.duplicates,
                    short(self.stamp)
                ),
                (0, _) => "there are no rows below the header; a motion takes at least two, and a fit thousands".into(),
                _ => "there is one row below the header; a motion takes at least two, and a fit thousands".into(),
            };
            return Err(RecordingError::Header { path, has_lines: self.has_lines, reason });
        }
        if self.differing as f64 > DIFFERING_SHARE * rows as f64 + 1.0 {
            return Err(RecordingError::Row {
                path,
                place: self.differing_place,
                reason: format!(
                    "{} of {rows} rows have the time of the row before but other values; log the time with finer digits, and the \
                     rows of one source only",
                    self.differing
                ),
            });
        }
        self.warnings.extend(warnings);
        if self.duplicates > 0 {
            self.warnings.push(Warning::Duplicates { rows: self.duplicates, line: self.duplicate_place });
        }
        if self.differing > 0 {
            self.warnings.push(Warning::EqualStamps { rows: self.differing, line: self.differing_place });
        }
        if let (Some((_, column)), 2..) = (&self.plan.time.run, self.runs) {
            let (runs, column) = (self.runs, column.clone());
            self.warnings.push(Warning::Runs { runs, column });
        }
        // A joint without any values is omitted; if no joint has values, the first one is the error.
        let lacking = self.plan.channels.iter().zip(&self.states).find_map(|(channel, state)| {
            let State::Missing { place, found } = state else {
                return None;
            };
            Some(missing(self.path, channel, *place, found.clone()))
        });
        let left_out = self.values.left_out();
        let (mut columns, breaks, span) = self.values.finish();
        let mut epoch = self.stamps.epoch();
        self.warnings.extend(self.ends.leave_out(self.in_run, &mut columns, &mut epoch));
        if let Some(reason) = too_long(columns[0][0], columns[0][columns[0].len() - 1]) {
            return Err(RecordingError::Header { path, has_lines: self.has_lines, reason });
        }
        if let Some(span) = span {
            let kept = columns[0].len();
            self.warnings.push(Warning::Thinned { rows, kept, span });
        }
        let gathered = Gathered {
            plan: self.plan,
            columns,
            breaks,
            states: self.states,
            numeric: self.numeric,
            warnings: self.warnings,
            epoch,
            left_out,
        };
        let recording = gathered.into_recording();
        match lacking {
            Some(error) if recording.joints.is_empty() => Err(error),
            _ => Ok(recording),
        }
    }
}
