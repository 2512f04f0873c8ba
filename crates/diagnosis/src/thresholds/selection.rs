//! Thresholds of phase 4: which effects keep their name.

/// The least share of a drive's inertia, which every drive has, in the joint's torque.
pub const LEAST_DRIVE: f64 = 0.01;
/// The least share of an unmodelled form in what the nominal model misses of a joint's torque.
pub const LEAST_OF_MISMATCH: f64 = 0.05;
/// What varies by less than this part of its mean is nearly constant, so that its size counts instead of its standard deviation:
/// an offset, or friction of a joint that never turns back.
pub const NEARLY_CONSTANT: f64 = 0.2;
/// An effect below this part of a joint's torque does nothing in a recording, which then does not say whether it predicts.
pub const IDLE_EFFECT: f64 = 0.002;
/// The part of its torque's standard deviation by which an effect of another joint may increase the error of a joint.
pub const HARMLESS: f64 = 0.001;
/// The relative growth of a joint's held-out error beyond which it is predicted worse.
pub const WORSE: f64 = 0.01;
/// An effect that the background could stand for may predict worse than the background by this part.
pub const AS_WELL: f64 = 0.1;
/// The length of the pieces of recordings of which every other is fitted, where the held-out recordings do not test an
/// effect (s).
pub const GAIN_PIECE: f64 = 2.0;
/// The part of an effect's power that every other piece holds at least; otherwise the pieces are parts of its power.
pub const LEAST_OF_HALF: f64 = 0.1;
/// The number of such parts.
pub const POWER_PIECES: f64 = 8.0;
/// With fewer moving rows the error is that of all rows.
pub const LEAST_ROWS: usize = 10;
/// The lag of the residual's autocorrelation (s): beyond the filter's memory.
pub const RESIDUAL_LAG: f64 = 0.1;
/// A joint with a larger error (NRMSE) than this is predicted worse than by a constant.
pub const HOPELESS: f64 = 1.0;
/// An error (NRMSE) below this says that something of the torque is explained.
pub const PARTLY: f64 = 0.8;
/// The least share of an effect in the joint's torque with which it is named although another explains nearly as much in its place.
/// Source: simulated cases of four sets; of twelve such names below 3 %, none was right.
pub const LEAST_UNDECIDED: f64 = 0.03;
/// How much more than its best alternative a smaller effect explains at least (nats), and a payload or a factor on inertials of any
/// size. Source: simulated cases of seven sets; of six such payloads and factors, none was right.
pub const UNDECIDED_NATS: f64 = 2.0;
/// A constant beside unmodelled structure on its joint is this multiple of all that the named effects leave there. Source:
/// constants that stood for a part of that structure reached 0.9 in five simulated cases; the offset of joint 1 of an iiwa 14 has
/// 3.3.
pub const ABOVE_THE_REST: f64 = 2.5;
/// The evidence of a rotor inertia from which its prediction is also tested without fitting the rest again (nats). Source: 180
/// simulated cases and 15 others; eight true ones from 28 nats on were refused otherwise, and a false one had 12.
pub const CLEAR_DRIVE: f64 = 20.0;
/// The least share of an effect in the joint's torque in the final fit, where the background may have taken most of it.
pub const LEAST_FINAL_SHARE: f64 = 0.01;
/// The evidence of an effect, beside the background that is best without it, with which it is named although its main parameter may
/// be that of no effect (nats).
pub const CLEAR_THOUGH_UNDETERMINED: f64 = 20.0;
/// No further search is made once so many names were refused by the final fit.
pub const MOST_REFUSED: usize = 3;
/// A time for whose sake the fit is so much worse is outside the 95 % interval of an onset (nats). Source: half the square of
/// 1.96, and as much again for what residuals remember and the filter smears.
pub const ONSET_INTERVAL: f64 = 2.0 * 1.92;
/// The part of its duration by which a push that sets in gently seems to begin later.
pub const PUSH_START: f64 = 0.1;
/// The part of what the background of all links explains (nats) that one missing body must explain alone.
pub const NEARLY_ALL: f64 = 0.7;
/// The part of the last link's mass in the URDF, its tool included, that a missing tool has at least: a URDF may be off by less
/// without one.
pub const LEAST_OF_THE_LINK: f64 = 0.3;
