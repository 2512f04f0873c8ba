//! Thresholds of the proposed next experiment: when two effects count as distinguished, and how far a motion may go.

/// A confusion counts as resolved if the evidence exceeds what is needed by this factor, because the prediction is not perfect.
pub const SURELY_RESOLVED: f64 = 1.2;
/// That factor where links, friction or torque constants are wrong, too. The motion determines them better, or has a friction of its own, which
/// the prediction does not know. Source: 14 simulated follow-up recordings of arms with wrong URDFs, in which six of seven promises with a
/// factor below 3 were not kept, and all but one of seven above.
pub const SURELY_RESOLVED_BESIDE: f64 = 3.0;
/// The range of the evidence over the needed one in which more evidence counts as better.
pub const COUNTED: (f64, f64) = (0.05, 4.0);
/// The weight of a smaller detectable size relative to a resolved confusion.
pub const WEIGHT_OF_SIZES: f64 = 0.1;
/// The ratio of detectable sizes below which an effect counts as more detectable.
pub const MORE_DETECTABLE: f64 = 0.8;
/// Evidence below this (nats), or below this part of the needed evidence, counts as none: the two effects have the same torque.
pub const ALIAS: (f64, f64) = (1.0, 0.1);
/// The part of a joint's range that a proposed motion keeps free at either end.
pub const LIMIT_MARGIN: f64 = 0.05;
/// The part of a velocity, acceleration and effort limit that a proposed motion may use: the controller needs the rest.
pub const WITHIN_LIMITS: f64 = 0.8;
/// The largest distance from the middle of the recorded range, as a multiple of the recorded distance, and the largest speed as
/// a multiple of the recorded one. The environment beyond is unknown.
pub const BEYOND_RECORDED: (f64, f64) = (1.5, 3.0);
/// The two multiples of [`BEYOND_RECORDED`] if the findings do not explain the recordings, because the torque beyond the recorded
/// range is unknown then.
pub const BEYOND_UNEXPLAINED: (f64, f64) = (1.0, 1.5);
/// Without a velocity limit in the URDF: the largest speed as a multiple of the recorded one.
pub const FASTER_UNLIMITED: f64 = 2.0;
/// Without an effort limit in the URDF: the largest torque as a multiple of the recorded one.
pub const STRONGER_UNLIMITED: f64 = 1.5;
/// The largest speed of a joint that was held still, as a part of that of the fastest joint.
pub const HELD_STILL: f64 = 0.3;
/// The parts of the allowed speed with which each motion is tried.
pub const TRIED_SPEEDS: [f64; 2] = [0.4, 1.0];
/// The parts of the allowed distance from the middle with which each motion is tried.
pub const TRIED_AMPLITUDES: [f64; 2] = [0.65, 1.0];
/// The parts of the distance that the large slow sine and the small fast one of a motion take.
pub const SLOW_AND_FAST: (f64, f64) = (0.7, 0.3);
