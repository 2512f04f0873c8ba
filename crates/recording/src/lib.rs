//! Recordings of joint motion and torque in SI units, their files, their clock and their quality.
//!
//! A simulation and a robot both make a [`Recording`]: time, positions, velocities and torques of named joints, on the
//! joint side, in s, rad (m), rad/s (m/s) and N m (N). [`Recording::regular`] assigns its rows to the regular clock on
//! which the drive sampled; [`Quality`] describes the recording before anything is fitted to it.
//!
//! ```
//! use recording::{Quality, Recording};
//!
//! let recording = Recording::read("../../examples/double_pendulum/r143339.csv.gz".as_ref())?;
//! let (regular, warnings) = recording.regular()?;
//! assert_eq!(recording.joints, ["joint1", "joint2"]);
//! assert!((1.0 / regular.period - 500.0).abs() < 0.1);
//! for warning in recording.warnings.iter().chain(&warnings) {
//!     println!("{warning}");
//! }
//! assert!(Quality::of(&recording, &regular).joints[0].moves);
//! # Ok::<(), recording::RecordingError>(())
//! ```

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod arrays;
mod bag_course;
mod bag_order;
mod bag_windows;
mod bytes;
mod cdr;
mod channels;
mod clock;
mod column_map;
mod csv_write;
mod dialect;
mod doubt;
mod draft;
mod error;
mod format;
mod gathered;
mod header;
mod held;
mod input;
mod interpolate;
mod joint_state;
mod jumps;
mod location;
mod origin;
mod parts;
mod quality;
mod quantity;
mod regular;
mod rows;
mod series;
mod spikes;
mod stamp;
pub mod statistics;
mod stray;
mod table;
mod thinned;
mod toml_error;
mod torque_lag;
mod units;
mod warning;
mod whole_file;
mod windows;
mod wraps;

pub use column_map::ColumnMap;
pub use error::{RecordingError, write_remedy};
pub use location::Location;
pub use origin::{Origin, OriginColumn};
pub use quality::{Finding, FindingKind, JointQuality, Quality};
pub use quantity::Quantity;
pub use regular::{RegularRecording, Segment};
pub use table::Column;
pub use toml_error::{nearest, toml_reason, unknown_key};
pub use warning::Warning;
pub use whole_file::write_whole;

/// One quantity of every joint: `signal[joint][sample]`.
pub type Signal = Vec<Vec<f64>>;

/// One quantity of some joints: `signal[joint]` is `None` where it was not recorded. Empty if no joint has it.
pub type PartialSignal = Vec<Option<Vec<f64>>>;

/// Motion and torque of named joints over time; every channel has one value per sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// The joints' names, in the order of every [`Signal`].
    pub joints: Vec<String>,
    /// Time stamps (s), increasing.
    pub time: Vec<f64>,
    /// Positions (rad or m).
    pub q: Signal,
    /// Velocities (rad/s or m/s), where they are known.
    pub qd: Option<Signal>,
    /// Accelerations (rad/s² or m/s²), where they are known: a simulation knows them.
    pub qdd: Option<Signal>,
    /// Torques (N m) or forces (N) at the joint.
    pub tau: Signal,
    /// Positions from a second encoder, on the link's side (rad or m).
    pub q_secondary: PartialSignal,
    /// Torques computed from motor currents, at the joint (N m or N).
    pub tau_current: PartialSignal,
    /// Motor currents (A).
    pub current: PartialSignal,
    /// Temperatures (°C).
    pub temperature: PartialSignal,
    /// Other columns, by their header.
    pub others: Vec<(String, Vec<f64>)>,
    /// The samples at which a further run begins, if a file contains several.
    pub breaks: Vec<usize>,
    /// What was corrected or omitted while reading.
    pub warnings: Vec<Warning>,
    /// The second since 1970 from which `time` is counted, if stamps are dates; `None` if the file has a clock of its
    /// own.
    pub epoch: Option<i64>,
    /// The time that was recorded and is not held, where windows of a long file were read (s).
    pub left_out: f64,
    /// The columns from which it was read; `None` if it was not read.
    pub origin: Option<Origin>,
}

impl Recording {
    /// The number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// The time from the first stamp to the last (s).
    pub fn duration(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }
}
