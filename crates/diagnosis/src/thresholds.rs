//! Thresholds that several phases of the diagnosis share.

/// The residual that the best model may have, as a share of the standard deviation of the joint's torque.
pub const TOLERANCE: f64 = 0.006;
/// The velocity deadband as a share of the joint's largest speed: below it, the joint counts as resting.
pub const REST: f64 = 0.015;
/// Below this cut-off (Hz) delays, springs and gaps between drive and link cannot be told from each other.
pub const LEAST_FOR_DYNAMICS: f64 = 5.0;
/// A row moves steadily if the joint moves within this many widths of the second filter around it.
pub const CORE: f64 = 1.2;
/// A row is in a fast reversal if the joint moves within [`CORE`] widths of it and reaches this multiple of that speed there.
pub const REVERSAL: f64 = 4.0;
/// A joint that stays within this part of its range does not move.
pub const YIELDING: f64 = 0.02;
/// The part of its torque's standard deviation by which an effect of another joint may increase the error of a joint.
pub const HARMLESS: f64 = 0.001;
/// The usual cut-off (Hz).
pub const CUTOFF: f64 = 12.0;
/// The part of a recording that contacts cover at most. A push is short beside the recording: those that are concealed in
/// cases last 0.4 to 1.5 s of 25 s. What acts longer is a load, or something else that the model lacks, and a free force in a long window
/// takes whatever that is.
pub const MOST_OF_A_RECORDING: f64 = 0.15;
