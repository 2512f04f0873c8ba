//! Recordings of joint motion and torque in SI units, and their files.
//!
//! A simulation and a robot both make a [`Recording`]: time, positions, velocities and torques of
//! named joints, on the joint side, in s, rad (m), rad/s (m/s) and N m (N).

mod csv_file;
mod error;
mod whole_file;

pub use error::RecordingError;
pub use whole_file::write_whole;

/// One quantity of every joint: `signal[joint][sample]`.
pub type Signal = Vec<Vec<f64>>;

/// Motion and torque of named joints over time; every channel has one value a sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// The joints' names, in the order of every [`Signal`].
    pub joints: Vec<String>,
    /// Time stamps (s).
    pub time: Vec<f64>,
    /// Positions (rad or m).
    pub q: Signal,
    /// Velocities (rad/s or m/s), where they are known.
    pub qd: Option<Signal>,
    /// Accelerations (rad/s² or m/s²), where they are known: a simulation knows them.
    pub qdd: Option<Signal>,
    /// Torques (N m) or forces (N) at the joint.
    pub tau: Signal,
    /// Other columns, by their header.
    pub others: Vec<(String, Vec<f64>)>,
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
}
