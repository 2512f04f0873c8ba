//! Thresholds of the checks of recordings against a URDF: units of time, position and torque, then signs, order and zeros. They decide
//! whether recordings are diagnosed as they were read. `docs/thresholds.md` lists them.

use std::ops::Range;

/// The largest time between rows of a recording that shows a drive's motion (s).
pub const SLOWEST_PERIOD: f64 = 0.1;
/// The largest speed of a robot, as a multiple of the URDF's limit; many URDFs have limits of the normal operation.
pub const MOST_SPEED: f64 = 5.0;
/// The relative deviation from one of the ratio of positions' slopes, in another unit, to the recorded velocities with which they are in
/// that unit.
pub const SAME_SLOPE: f64 = 0.04;
/// The ratio of a position's slope to the recorded velocity with which both are in the same unit.
pub const SAME_UNIT: Range<f64> = 0.5..2.0;
/// The ratio of the recorded velocities to the positions' slopes with which the time stamps are probably right, where the speeds of all
/// joints are far beyond the URDF's limits.
pub const SAME_SPEED: Range<f64> = 0.8..1.25;
/// Positions that span more than this may be in another unit (rad).
pub const MOST_SPAN: f64 = 2.0 * std::f64::consts::TAU;
/// Positions may be in another unit if they also span more than this multiple of the URDF's range. Many motions exceed the URDF's
/// limits slightly.
pub const BEYOND_RANGE: f64 = 1.5;
/// Positions in another unit may exceed the URDF's limits by this part of their range.
pub const SLACK: f64 = 0.1;
/// Positions may exceed the URDF's limits by this without a warning (rad or m).
pub const LIMIT_SLACK: f64 = 1e-2;
/// Positions that exceed the URDF's limits by at most this are not moved into them by whole turns (rad), because many motions exceed them
/// slightly.
pub const TURNS_SLACK: f64 = 0.1;
/// The factor by which torques may exceed the URDF's effort limit without a warning.
pub const EFFORT_SLACK: f64 = 1.05;
/// A unit of the positions must be better than another by at least this reduction of the mean log residual.
pub const UNIT_LEAD: f64 = 0.5;
/// The factors of the model's torques that positions in turns may have.
pub const TURN_FACTORS: Range<f64> = 0.3..3.0;
/// One joint's positions are in degrees if that reduces the sum of the joints' log residuals by at least this much.
pub const ONE_IN_DEGREES: f64 = 2.0;
/// A column map may not increase the sum of the joints' log residuals by more than this. Factors of torques do not change it.
pub const WORSE: f64 = 0.5;

/// The least number of instants from which the model's torques are judged.
pub const LEAST_INSTANTS: usize = 100;
/// For the judgement of torques, a joint moves if its position changes by more than this (rad or m).
pub const MOVES: f64 = 0.01;
/// The model explains a joint's torque if the residual has less than this share of the torque's variance.
pub const EXPLAINED_BY_MODEL: f64 = 0.2;
/// The model is needed to explain a joint's torque if the residual variance without it is larger by more than this factor.
pub const NEEDS_MODEL: f64 = 3.0;
/// A residual variance below this part of the torque's variance counts as this part, because such residuals show no wrong reading.
pub const LEAST_RESIDUAL: f64 = 0.01;
/// A joint's torque is not explained if its residual has more than this share of its variance.
pub const NOT_EXPLAINED: f64 = 0.5;
/// The ratios of a torque to the model's that a wrong URDF may have.
pub const OF_SIZE: Range<f64> = 0.1..10.0;
/// The least ratio of a torque to the model's on the joint's side; a payload only makes it larger.
pub const MOTOR_SIDE: f64 = 0.05;
/// A torque that exceeds the model's by more than this factor is in another unit.
pub const OTHER_UNIT: f64 = 100.0;
/// With this ratio on all joints, the torques are in another unit; no payload is so heavy.
pub const LARGE_EVERYWHERE: f64 = 30.0;
/// With less than this ratio on all joints, the torques are motor currents or in another unit.
pub const SMALL_EVERYWHERE: f64 = 0.2;
/// The torques are also motor currents or in another unit if half of the joints have a ratio below [`SMALL_EVERYWHERE`] and all others
/// a ratio below this one: torque constants differ from drive to drive, and a payload and friction make the ratio larger.
pub const SMALL_BESIDE: f64 = 0.7;
/// The torques are in a decimal unit if their ratio to the model's, over that unit's, is in this range: the masses of a URDF are accurate
/// to about a third.
pub const NEAR_UNIT: Range<f64> = 0.5..2.0;

/// The number of corrections of the columns (signs, order, zeros) that are weighed by their evidence.
pub const WEIGHED: usize = 8;
/// A base on a wall or on a ceiling is another one than the URDF's if gravity differs by more than this part.
pub const OTHER_BASE: f64 = 0.1;
/// A correction is weighed if it reduces the sum of the joints' log residuals in a recording by this much: the model is that of the
/// URDF, so that other inertial parameters may hide most of the reduction.
pub const WORTH_WEIGHING: f64 = 0.05;
/// A correction of a joint whose torque is hardly explained, or of the joint before it, is also weighed if it increases the sum by less
/// than this for each recording: the model's part of such a torque may be small.
pub const NOT_CONTRADICTED: f64 = 0.5;
/// Recordings contradict each other on a correction if it changes the sum by more than this, up in one and down in another.
pub const CONTRADICTS: f64 = 2.0;
/// The evidence from which a correction is reported (nats). Source: of 184 simulated cases with URDFs exact or wrong by 3 to 30 %, whose
/// recordings are as they should be, one has a correction of more than 20 nats: 67, for the zero of a last joint whose torque is
/// explained without it. Of 430 perturbed recordings of 16 robots, nine in ten have more than 100.
pub const REPORTED: f64 = 20.0;
/// The evidence from which a correction is certain (nats). Source: as for [`REPORTED`].
pub const CERTAIN: f64 = 40.0;
/// The evidence from which a correction is reported if the torque is nearly explained without it (nats). Source: 184
/// simulated cases that are read as they should be, of which one has a warning; with 60 nats, and friction that could
/// drive a joint, four had one.
pub const REPORTED_WHERE_EXPLAINED: f64 = 100.0;
/// The evidence from which a correction is certain if the torque is nearly explained without it (nats). Source: as for
/// [`REPORTED_WHERE_EXPLAINED`]; none of these cases is refused.
pub const CERTAIN_WHERE_EXPLAINED: f64 = 200.0;
/// The evidence that an effect outside the catalogue on one of the joints does not put into doubt (nats).
pub const OVERWHELMING: f64 = 500.0;
/// The least share of the variance of a joint's torque that is unexplained without a correction; below it, the torque is nearly
/// explained.
pub const UNEXPLAINED: f64 = 0.02;
/// The factor by which a correction must reduce the unexplained share of a torque; otherwise, the torque counts as nearly explained.
pub const REDUCED: f64 = 3.0;
/// A correction that reduces no joint's unexplained share by more than this factor is not certain, whatever its evidence: long recordings
/// show small differences of models that are both wrong. Source: `prove`, seed 28113002, case 064, in which the zero of a last joint was
/// moved by a quarter of a turn for 0.021 % in the place of 0.022 %.
pub const HARDLY_REDUCED: f64 = 1.2;
/// The evidence of one joint's torque with which the joint supports a correction (nats).
pub const SUPPORTS: f64 = 15.0;
/// At most one in this many joints of a correction may contradict it.
pub const ONE_CONTRADICTS_IN: usize = 3;
/// A correction is the only one if the next one has less evidence by this much (nats).
pub const LEAD: f64 = 10.0;
/// A correction that moves positions beyond the URDF's limits by this much more than they are is not certain (rad or m).
pub const BEYOND_LIMITS: f64 = 0.3;
/// The share of the variance of a joint's torque that may remain with correct columns.
pub const MAY_REMAIN: f64 = 0.3;
/// In the check of signs, zeros and order, the part of a joint's largest speed below which its direction of motion is not certain.
pub const DIRECTION_UNCERTAIN: f64 = 0.02;
