//! The rows of a file as they are read: values by the plan, duplicates and runs told apart.

use std::path::Path;

use csv::ByteRecord;

use crate::header::Plan;
use crate::thinned::Thinned;
use crate::{PartialSignal, Quantity, Recording, RecordingError, Signal, Warning};

/// A clock that starts anew does so within this share of its run's length from where it started.
const RESTART_SHARE: f64 = 0.01;
/// A run in a file of several has at least this many rows.
const RUN_ROWS: usize = 50;
/// The time between two runs whose clocks say nothing of it (s).
const RUN_PAUSE: f64 = 1.0;
/// Rows with the stamp of the row before but other values may be this share of all.
const DIFFERING_SHARE: f64 = 0.01;

/// No position, speed, torque, current or temperature is larger (SI).
const LARGEST: f64 = 1e9;
/// No stamp is later (s).
const LATEST: f64 = 1e15;

/// The rows read so far, by the plan.
pub struct Rows<'a> {
    path: &'a Path,
    plan: &'a Plan,
    width: usize,
    /// The time, the channels, the other columns.
    values: Thinned,
    /// The row that is being taken.
    row: Vec<f64>,
    /// Whether another column holds numbers alone so far.
    numeric: Vec<bool>,
    /// Rows of this run.
    in_run: usize,
    warnings: Vec<Warning>,
    /// The row before, as bytes, and its stamp as the file has it (s).
    before: ByteRecord,
    stamp: f64,
    /// The first stamp of this run as the file has it (s), and what is added to the stamps (s).
    first: f64,
    shift: f64,
    /// Duplicated rows: how many, how many of them differ, the lines of the first and of the first that differs.
    duplicates: usize,
    differing: usize,
    duplicate_line: u64,
    differing_line: u64,
}

impl<'a> Rows<'a> {
    /// None yet, of a file with `width` columns, of which at most `most` values are kept.
    pub fn new(path: &'a Path, plan: &'a Plan, width: usize, most: usize) -> Self {
        Self {
            path,
            plan,
            width,
            values: Thinned::new(1 + plan.channels.len() + plan.others.len(), most),
            row: Vec::new(),
            numeric: vec![true; plan.others.len()],
            in_run: 0,
            warnings: Vec::new(),
            before: ByteRecord::new(),
            stamp: f64::NAN,
            first: f64::NAN,
            shift: 0.0,
            duplicates: 0,
            differing: 0,
            duplicate_line: 0,
            differing_line: 0,
        }
    }

    /// The last row, which is left out if the file is cut in it.
    pub fn take_last(&mut self, row: &ByteRecord, ends_whole: bool) -> Result<(), RecordingError> {
        // All that follows an open quotation mark is one cell.
        if row.iter().any(|cell| cell.contains(&b'\n')) {
            let reason = "a quotation mark is not closed in this row; close it or take it out".to_owned();
            return Err(self.row_error(row, reason));
        }
        let cell = |row: &ByteRecord| row.iter().next_back().map_or(0, <[u8]>::len);
        // Without a newline at the end, the last number may have lost digits.
        let may_be_cut = !ends_whole && cell(row) < cell(&self.before);
        let whole = row.len() == self.width && !may_be_cut;
        if whole || (row.len() > self.width) {
            let taken = self.take(row);
            if ends_whole || taken.is_ok() || row.iter().next_back().and_then(number).is_some() {
                return taken;
            }
        }
        let line = line_of(row);
        self.warnings.push(Warning::CutFile { line });
        Ok(())
    }

    /// Takes a row, which must be whole.
    pub fn take(&mut self, row: &ByteRecord) -> Result<(), RecordingError> {
        if row.len() != self.width {
            return Err(self.row_error(
                row,
                format!(
                    "the row has {} cells, the header {}; {}",
                    row.len(),
                    self.width,
                    if row.len() + 1 >= 2 * self.width {
                        "are there decimal commas? Write numbers with a decimal point"
                    } else {
                        "mend or delete the row"
                    }
                ),
            ));
        }
        let stamp = self.value(
            row,
            self.plan.time,
            &self.plan.time_header,
            (self.plan.time_factor, 0.0),
            LATEST,
        )?;
        let mut begins = false;
        if self.in_run > 0 && stamp <= self.stamp {
            if stamp == self.stamp {
                self.duplicate(row);
                return Ok(());
            }
            self.restart(row, stamp)?;
            begins = true;
        } else if self.in_run == 0 {
            self.first = stamp;
        }
        self.row.clear();
        self.row.push(stamp + self.shift);
        for index in 0..self.plan.channels.len() {
            let channel = &self.plan.channels[index];
            let conversion = (channel.factor, channel.offset);
            let value = self.value(row, channel.index, &channel.header, conversion, LARGEST)?;
            self.row.push(value);
        }
        for (numeric, (index, header)) in self.numeric.iter_mut().zip(&self.plan.others) {
            let value = row.get(*index).and_then(number);
            if *numeric && value.is_none() {
                *numeric = false;
                self.warnings.push(Warning::ColumnLeftOut {
                    column: header.clone(),
                    line: line_of(row),
                    found: text(row.get(*index)),
                });
            }
            self.row.push(value.unwrap_or(f64::NAN));
        }
        self.values.push(&self.row, begins);
        self.in_run = if begins { 1 } else { self.in_run + 1 };
        self.stamp = stamp;
        self.before.clone_from(row);
        Ok(())
    }

    /// The cell's value in SI, which is finite and at most `largest`.
    fn value(
        &self,
        row: &ByteRecord,
        index: usize,
        column: &str,
        (factor, offset): (f64, f64),
        largest: f64,
    ) -> Result<f64, RecordingError> {
        let cell = row.get(index);
        let found = cell.and_then(number).map(|value| factor * value + offset);
        if let Some(value) = found.filter(|value| value.abs() <= largest) {
            return Ok(value);
        }
        let comma = |cell: &[u8]| {
            let text = String::from_utf8_lossy(cell);
            text.contains(',') && number(text.replacen(',', ".", 1).as_bytes()).is_some()
        };
        let (what, remedy) = if found.is_some() {
            (
                "far beyond what is measured",
                "check its unit, or delete the row: gaps are dealt with",
            )
        } else if cell.is_some_and(comma) {
            ("a number with a decimal comma", "write numbers with a decimal point")
        } else {
            (
                "not a finite number",
                "delete the row: a row that is missing is a gap, and gaps are dealt with",
            )
        };
        Err(RecordingError::Value {
            path: self.path.to_owned(),
            line: line_of(row),
            column: column.to_owned(),
            found: text(cell),
            what,
            remedy,
        })
    }

    fn row_error(&self, row: &ByteRecord, reason: String) -> RecordingError {
        RecordingError::Row {
            path: self.path.to_owned(),
            line: line_of(row),
            reason,
        }
    }

    fn duplicate(&mut self, row: &ByteRecord) {
        self.duplicates += 1;
        if self.duplicates == 1 {
            self.duplicate_line = line_of(row);
        }
        if row != &self.before {
            self.differing += 1;
            if self.differing == 1 {
                self.differing_line = line_of(row);
            }
        }
    }

    /// Time that runs back: another run if it starts where this one started, else an error.
    fn restart(&mut self, row: &ByteRecord, stamp: f64) -> Result<(), RecordingError> {
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
        let before = self.stamp;
        self.shift += self.stamp + RUN_PAUSE - stamp;
        self.first = stamp;
        self.warnings.push(Warning::ClockRestart {
            line: line_of(row),
            before,
            after: stamp,
            placed: stamp + self.shift,
        });
        Ok(())
    }

    /// The recording that the rows make.
    pub fn finish(mut self) -> Result<Recording, RecordingError> {
        let path = self.path.to_owned();
        let rows = self.values.read();
        if rows < 2 {
            let found = if rows == 0 { "are no rows" } else { "is one row" };
            return Err(RecordingError::Header {
                path,
                reason: format!("there {found} below the header; a motion takes at least two, and a fit thousands"),
            });
        }
        if self.differing as f64 > DIFFERING_SHARE * rows as f64 + 1.0 {
            return Err(RecordingError::Row {
                path,
                line: self.differing_line,
                reason: format!(
                    "{} rows have the time of the row before but other values; log the time with finer digits",
                    self.differing
                ),
            });
        }
        if self.duplicates > 0 {
            self.warnings.push(Warning::Duplicates {
                rows: self.duplicates,
                line: self.duplicate_line,
                differ: self.differing > 0,
            });
        }
        let (mut columns, breaks, span) = self.values.finish();
        if let Some(span) = span {
            self.warnings.push(Warning::Thinned {
                rows,
                kept: columns[0].len(),
                span,
            });
        }
        let others: Vec<Vec<f64>> = columns.split_off(1 + self.plan.channels.len());
        let mut channels = columns.split_off(1);
        let time = columns.swap_remove(0);
        let joints = self.plan.joints.len();
        let mut partial = |quantity: Quantity| -> PartialSignal {
            let mut signal = vec![None; joints];
            for (channel, values) in self.plan.channels.iter().zip(&mut channels) {
                if channel.quantity == quantity {
                    signal[channel.joint] = Some(std::mem::take(values));
                }
            }
            if signal.iter().all(Option::is_none) {
                Vec::new()
            } else {
                signal
            }
        };
        let mut whole = |quantity: Quantity| -> Signal { partial(quantity).into_iter().flatten().collect() };
        let some = |signal: Signal| if signal.is_empty() { None } else { Some(signal) };
        let (q, tau) = (whole(Quantity::Position), whole(Quantity::Torque));
        let (qd, qdd) = (some(whole(Quantity::Velocity)), some(whole(Quantity::Acceleration)));
        if qd.is_none() {
            self.warnings.push(Warning::NoVelocity);
        }
        let q_secondary = partial(Quantity::SecondaryPosition);
        let tau_current = partial(Quantity::CurrentTorque);
        let (current, temperature) = (partial(Quantity::Current), partial(Quantity::Temperature));
        let others = self.plan.others.iter().zip(others).zip(self.numeric);
        Ok(Recording {
            joints: self.plan.joints.clone(),
            time,
            q,
            qd,
            qdd,
            tau,
            q_secondary,
            tau_current,
            current,
            temperature,
            others: others
                .filter(|(_, numeric)| *numeric)
                .map(|(((_, name), values), _)| (name.clone(), values))
                .collect(),
            breaks,
            warnings: self.warnings,
        })
    }
}

/// The finite number that a cell holds.
fn number(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell.trim_ascii()).ok()?;
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

fn text(cell: Option<&[u8]>) -> String {
    let text = String::from_utf8_lossy(cell.unwrap_or_default());
    let short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        format!("{short}…")
    } else {
        short
    }
}

/// A number without hundreds of zeros.
fn short(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-9 {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

fn line_of(row: &ByteRecord) -> u64 {
    row.position().map_or(1, csv::Position::line)
}
