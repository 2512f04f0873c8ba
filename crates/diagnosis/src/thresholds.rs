//! The numbers that the diagnosis was tuned with.

/// The error that the best model may leave, as a share of a joint's torque spread.
pub const TOLERANCE: f64 = 0.006;
/// Below this share of its largest speed a joint rests.
pub const REST: f64 = 0.015;
/// Below this cut-off (Hz) delays, springs and gaps between drive and link cannot be told from each other.
pub const LEAST_FOR_DYNAMICS: f64 = 5.0;
/// A row moves steadily if the joint moves within so many widths of the second filter …
pub const CORE: f64 = 1.2;
/// … and through a quick reversal if it moves there and, within them, somewhere so many times as fast as that.
pub const REVERSAL: f64 = 4.0;
/// A joint that stays within this part of its range does not move.
pub const YIELDING: f64 = 0.02;
/// A joint's error that is less than this part of its torque's spread needs no explanation: what another joint's effect does to it …
pub const EXPLAINED: f64 = 0.03;
/// … may be wrong by this part.
pub const HARMLESS: f64 = 0.001;
/// The usual cut-off (Hz).
pub const CUTOFF: f64 = 12.0;
