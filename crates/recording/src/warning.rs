//! Doubtful properties of a recording that can be used, each with its place.

use std::fmt;

use serde::Serialize;

use crate::{Location, Quantity};

mod digits;

use digits::short;

/// The pause that is assumed between two runs if their clocks do not determine it (s).
pub(crate) const RUN_PAUSE: f64 = 1.0;

/// A property that was found in a recording and corrected or ignored.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Warning {
    /// The file ends in the middle of a row, which was omitted.
    CutFile {
        /// The line or row.
        line: Location,
    },
    /// Rows that equal the previous one were omitted.
    Duplicates {
        /// Their number.
        rows: usize,
        /// The line or row of the first.
        line: Location,
    },
    /// Rows have the time stamp of the previous one and other values; they were placed after it.
    EqualStamps {
        /// Their number.
        rows: usize,
        /// The line or row of the first.
        line: Location,
    },
    /// The file has more rows than are kept: each is the mean of several.
    Thinned {
        /// The number of rows read.
        rows: usize,
        /// The number of rows kept.
        kept: usize,
        /// The time span of a mean (s).
        span: f64,
    },
    /// Each sample was written several times; the rows that repeat it were omitted.
    Held {
        /// The number of rows read.
        rows: usize,
        /// The number of samples among them.
        samples: usize,
        /// The number of rows of most samples.
        held: usize,
    },
    /// Some rows repeat all values of the row before while the arm moves; they were omitted.
    Repeated {
        /// The number of rows read.
        rows: usize,
        /// The number of rows that repeat the one before.
        repeated: usize,
    },
    /// The positions were refreshed in some of the rows only; the others were omitted.
    HeldPositions {
        /// The number of rows read.
        rows: usize,
        /// The number of rows with refreshed positions.
        samples: usize,
        /// The number of rows for which most positions are held.
        held: usize,
    },
    /// The first or the last row has a time stamp far from all others; it was omitted.
    StrayStamp {
        /// Its line or row.
        line: Location,
        /// Its stamp (s).
        stamp: f64,
        /// The stamp of the row beside it (s).
        next: f64,
    },
    /// The time starts again: the file contains several runs.
    ClockRestart {
        /// The line or row at which the new run begins.
        line: Location,
        /// The last stamp before it (s).
        before: f64,
        /// Its first stamp in the file (s).
        after: f64,
        /// Its first stamp in the recording (s).
        placed: f64,
    },
    /// The columns are those of a known system.
    System {
        /// The system.
        system: String,
        /// The columns of time, position and torque that were used.
        columns: String,
        /// Whether the joints have numbers instead of names.
        numbered: bool,
    },
    /// The file contains several runs, according to a column that numbers them.
    Runs {
        /// Their number.
        runs: usize,
        /// The column.
        column: String,
    },
    /// Columns with their own stamps were joined with the others by time.
    Joined {
        /// Their source.
        what: String,
        /// The number of rows between two of their samples, which were interpolated.
        interpolated: usize,
        /// The number of rows before their first and after their last sample, which were omitted.
        left_out: usize,
    },
    /// Messages of a bag are earlier than ones before them; all were sorted by time.
    OutOfOrder {
        /// Their topic.
        topic: String,
        /// The first (the number of the message in the bag).
        line: Location,
        /// Their number.
        messages: u64,
        /// By how much they are earlier, at most (s).
        largest: f64,
    },
    /// Messages of a bag whose stamps are far from those around them were omitted.
    WrongStamps {
        /// Their topic.
        topic: String,
        /// The first (the number of the message in the bag).
        line: Location,
        /// Their number.
        messages: u64,
    },
    /// Something that is not used was omitted.
    LeftOut {
        /// Its description, with the reason.
        what: String,
    },
    /// A joint without any position or torque was omitted.
    JointLeftOut {
        /// The joint.
        joint: String,
        /// The column without values.
        column: String,
    },
    /// Positions that jump by a turn were made continuous.
    Unwrapped {
        /// The joint.
        joint: String,
        /// The quantity.
        quantity: Quantity,
        /// The number of jumps.
        jumps: usize,
        /// The time of the first (s).
        time: f64,
    },
    /// Positions jump between two rows; the rows before and after are separate runs.
    Jumps {
        /// The joint of the largest one in the first row with a jump.
        joint: String,
        /// The number of rows with a jump.
        jumps: usize,
        /// The time of the first row (s).
        time: f64,
        /// The size of its largest jump (rad or m).
        size: f64,
    },
    /// An optional column contains something other than numbers and was omitted.
    ColumnLeftOut {
        /// Its header.
        column: String,
        /// The first line or row with such a cell.
        line: Location,
        /// The content of that cell.
        found: String,
    },
    /// There is no velocity; it has to be differentiated from the position.
    NoVelocity,
    /// The time stamps deviate from the regular clock; rows were assigned to its ticks.
    Jitter {
        /// Root mean square (s).
        rms: f64,
        /// Largest (s).
        max: f64,
        /// The time of the largest (s).
        time: f64,
        /// The clock's period (s).
        period: f64,
    },
    /// No regular clock fits the stamps; the rows were resampled by interpolation.
    NoRegularClock {
        /// Root mean square distance of the stamps from the best clock, as a share of its period.
        share: f64,
        /// The period chosen (s).
        period: f64,
    },
    /// The rows were sampled at the times of their stamps, which are not regular; they were resampled by interpolation.
    UnevenSampling {
        /// Root mean square distance of the stamps from the best clock, as a share of its period.
        share: f64,
        /// The period of the resampled rows (s).
        period: f64,
    },
    /// Single rows are missing; their values were interpolated.
    LostRows {
        /// Their number.
        rows: usize,
        /// The number of ticks.
        of: usize,
        /// The time of the first (s).
        time: f64,
    },
    /// A gap that is too long to interpolate; the recording is divided there.
    Gap {
        /// The last time before it (s).
        from: f64,
        /// The first time after it (s).
        to: f64,
        /// The shift of the clock over the gap, as a share of the period, if the clocks on both sides differ.
        shift: f64,
    },
    /// Single samples far from their neighbours were interpolated.
    Spikes {
        /// The joint.
        joint: String,
        /// The quantity.
        quantity: Quantity,
        /// The times (s).
        times: Vec<f64>,
        /// The largest distance from the neighbours (in the quantity's unit).
        largest: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CutFile { line } => write!(f, "{line}: the file is cut in the middle of this row; it was left out"),
            Self::Duplicates { rows, line } => {
                let verb = if *rows == 1 { "row was" } else { "rows were" };
                write!(f, "{line}: {rows} {verb} left out, equal to the row before")
            }
            Self::EqualStamps { rows, line } => {
                let what = if *rows == 1 {
                    "row has the time of the row before but other values; it was"
                } else {
                    "rows have the time of the row before but other values; they were"
                };
                write!(f, "{line}: {rows} {what} placed after it")
            }
            Self::Thinned { rows, kept, span } => write!(
                f,
                "{rows} rows exceed the limit of rows in memory; they are replaced by {kept} means over {:.3} ms",
                span * 1e3
            ),
            Self::Held { rows, samples, held } => write!(
                f,
                "each sample stands in {held} rows: of {rows} rows {samples} are used, each sample once (record at the drive's rate)"
            ),
            Self::Repeated { rows, repeated } => write!(
                f,
                "{repeated} of {rows} rows repeat all values of the row before while the arm moves: they are left out (the logger wrote the \
                 last value again where none had come)"
            ),
            Self::HeldPositions { rows, samples, held } => write!(
                f,
                "positions change in one of {held} rows only, other signals more often: {samples} of {rows} rows, with new positions, are used"
            ),
            Self::StrayStamp { line, stamp, next } => write!(
                f,
                "{line}: the time stamp of {stamp} s is far from all others (the one beside it is {next} s): the row is left out"
            ),
            Self::ClockRestart { line, before, after, placed } => write!(
                f,
                "{line}: time starts again ({before} s, then {after} s): treated as another run, placed at {placed:.6} s"
            ),
            Self::ColumnLeftOut { column, line, found } => {
                write!(f, "{line}: column \"{column}\" is \"{found}\", not a number; the column was left out")
            }
            Self::System { system, columns, numbered } => {
                write!(f, "the columns are those of {system}: {columns}")?;
                if *numbered {
                    write!(f, "; its joints have numbers, and are taken in the URDF's order")?;
                }
                Ok(())
            }
            Self::Runs { runs, column } => write!(
                f,
                "{runs} runs, by column \"{column}\": each is treated as a run of its own, {RUN_PAUSE} s after the one before"
            ),
            Self::Joined { what, interpolated, left_out } => {
                write!(f, "{what} has stamps of its own and was joined by time: ")?;
                write!(
                    f,
                    "{interpolated} rows interpolated, {left_out} left out before its first stamp, after its last, or in its gaps"
                )
            }
            Self::OutOfOrder { topic, line, messages, largest } => {
                let (are, were) = match messages {
                    1 => ("message is", "was"),
                    _ => ("messages are", "were"),
                };
                write!(
                    f,
                    "{topic}: {messages} {are} earlier than one before of the same joints, by {largest:.4} s at most (the first is \
                     {line}), and {were} put in order of time; if a clock was set back there, cut \
                     the bag"
                )
            }
            Self::WrongStamps { topic, line, messages } => {
                let (have, were) = match messages {
                    1 => ("message has a stamp", "was"),
                    _ => ("messages have stamps", "were"),
                };
                write!(
                    f,
                    "{topic}: {messages} {have} far from those before and after, and {were} left out (the first is {line})"
                )
            }
            Self::LeftOut { what } => write!(f, "{what}"),
            Self::JointLeftOut { joint, column } => {
                write!(f, "{joint} was left out: column \"{column}\" has no values")
            }
            Self::Unwrapped { joint, quantity, jumps, time } => write!(
                f,
                "{}{joint}: the encoder wraps at a turn {jumps} {} (first at {time:.3} s); the positions were made continuous",
                quantity.prefix(),
                if *jumps == 1 { "time" } else { "times" }
            ),
            Self::Jumps { joint, jumps, time, size } => write!(
                f,
                "positions jump {} between two rows by more than a joint can move (first q_{joint}, by {size:.3} rad or m at {time:.3} s); the \
                 rows before and after are treated as separate runs. If the encoder lost its position, its zero differs between them: diagnose \
                 one of them only. If the data were frozen before, leave these rows out",
                if *jumps == 1 { "once".to_string() } else { format!("{jumps} times") }
            ),
            Self::NoVelocity => write!(f, "there is no velocity (qd_<joint>); it is differentiated from the position"),
            Self::Jitter { rms, max, time, period } => write!(
                f,
                "the time stamps deviate from a clock of {:.2} Hz by {:.1} % of its period (at most {:.0} %, at {time:.3} s); \
                 rows were assigned to its ticks",
                1.0 / period,
                100.0 * rms / period,
                100.0 * max / period
            ),
            Self::NoRegularClock { share, period } => write!(
                f,
                "no regular clock fits the time stamps (they deviate by {:.0} % of the period from {:.2} Hz); resampled by \
                 interpolation, which makes derivatives less accurate: record with the drive's own clock",
                100.0 * share,
                1.0 / period
            ),
            Self::UnevenSampling { share, period } => write!(
                f,
                "the rows were sampled at the times of their stamps, which deviate by {:.0} % of the period from {:.2} Hz: the \
                 positions are smooth along these times only; resampled by interpolation, which makes derivatives less accurate",
                100.0 * share,
                1.0 / period
            ),
            Self::LostRows { rows, of, time } => write!(
                f,
                "{rows} of {of} rows {}; interpolated",
                if *rows == 1 {
                    format!("is missing, at {time:.3} s")
                } else {
                    format!("are missing, one or a few at a time (the first at {time:.3} s)")
                }
            ),
            Self::Gap { from, to, shift: 0.0 } => {
                write!(f, "no rows from {from:.4} s to {to:.4} s; treated as separate segments")
            }
            Self::Gap { from, to, shift } => write!(
                f,
                "no rows from {from:.4} s to {to:.4} s, after which the samples are {shift:.2} periods off the clock of those before; treated as separate segments"
            ),
            Self::Spikes { joint, quantity, times, largest } => {
                let shown: Vec<String> = times.iter().take(5).map(|time| format!("{time:.3}")).collect();
                let more = if times.len() > shown.len() { ", …" } else { "" };
                write!(
                    f,
                    "{}{joint}: {} single-sample spike{} (up to {}) at {}{more} s; interpolated",
                    quantity.prefix(),
                    times.len(),
                    if times.len() == 1 { "" } else { "s" },
                    short(*largest),
                    shown.join(", ")
                )
            }
        }
    }
}

#[cfg(test)]
mod tests;
