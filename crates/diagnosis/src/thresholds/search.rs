//! Thresholds of phase 3: which candidates there are, and which of them are taken.

/// Below this cut-off delays, springs and gaps between drive and link cannot be told from each other (Hz).
pub const LEAST_FOR_DYNAMICS: f64 = 5.0;
/// A candidate whose torque is this multiple of what it is to explain cancels another one, and is impossible.
pub const LARGEST_TORQUE_SHARE: f64 = 3.0;
/// The part of a recording that contacts cover at most. A push is short beside the recording; what acts longer is a load, or
/// something else that the model lacks, and a free force in a long window takes whatever that is. Source: the pushes that are
/// injected into simulated cases last 0.4 to 1.5 s of 25 s.
pub const MOST_OF_A_RECORDING: f64 = 0.15;
/// The durations of contact that are tried (s).
pub const CONTACT_DURATIONS: [f64; 7] = [0.2, 0.35, 0.6, 1.0, 1.6, 2.5, 4.0];
/// The windows of contact that a residual suggests, at most.
pub const MOST_CONTACTS: usize = 4;
/// The length of the pieces of a contact's window of which every other is fitted (s).
pub const CONTACT_PIECE: f64 = 0.15;
/// The periods of a ripple that a residual suggests on a joint, at most.
pub const MOST_RIPPLES: usize = 3;
/// The phase through which the slowest ripple passes over the joint's range (rad).
pub const LEAST_RIPPLE_PHASE: f64 = 16.0;
/// The periods of the quickest ripple (rad of phase per rad or m).
pub const MOST_RIPPLE_PERIODS: f64 = 400.0;
/// The part of the largest speed at which the filter must pass a ripple.
pub const RIPPLE_SPEED: f64 = 0.4;
/// The sinusoids in time that a residual suggests on a joint, at most.
pub const MOST_WAVES: usize = 2;
/// The lowest and the highest frequency of a sinusoid in time (Hz).
pub const WAVE_FREQUENCIES: (f64, f64) = (0.3, 8.0);
/// The highest frequency of a sinusoid in time as a part of the cut-off.
pub const WAVE_CUTOFF: f64 = 0.7;
/// The time from either end of the recordings to the first onset that is tried (s).
pub const ONSET_FROM_END: f64 = 2.0;
/// Where so many drives' inertias are left out of a model, all drives' are likely to be.
pub const TELLING_DRIVES: usize = 2;
/// The evidence that each drive's inertia beyond [`TELLING_DRIVES`] need not bring (nats): beside a gap that is never crossed,
/// which is an encoder's offset with a drive's inertia, the two then stand for themselves.
pub const KNOWN_DRIVE: f64 = 3.0;
/// The gain that an exchange of a candidate for another must bring (nats).
pub const SWAP_GAIN: f64 = 0.5;
