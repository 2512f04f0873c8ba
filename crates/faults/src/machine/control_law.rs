//! The control laws of a machine: the position loop of the recordings, or an external controller.

use super::parts::Parts;
use crate::motion::Reference;
use crate::robot::Robot;

/// The damping ratio of the position loop, and the bounds of its natural frequency (rad/s).
const DAMPING: f64 = 0.8;
const FREQUENCIES: (f64, f64) = (20.7, 30.0);
/// The steady-state position error under a torque as large as the joint's own gravity torque (rad or m).
const STEADY_STATE_ERROR: f64 = 0.05;

/// The initial state of a machine at rest.
pub(crate) struct Begin<'a> {
    /// The time on the recordings' clock (s).
    pub time: f64,
    /// The positions that its encoders report (rad or m).
    pub q: &'a [f64],
    /// The torques that its drives held before (N m or N).
    pub holding: &'a [f64],
}

/// The inputs of a controller at a tick of 1 ms; one entry per joint.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// The number of the tick, from 0.
    pub tick: usize,
    /// Encoder positions (rad or m).
    pub q: &'a [f64],
    /// Velocities from the encoders through a [`crate::VelocityFilter`] (rad/s or m/s).
    pub qd: &'a [f64],
}

/// Computes the drives' torques once per tick.
pub(crate) trait ControlLaw {
    /// Writes the commanded torques for the coming tick to `torque` (N m or N).
    fn command(&mut self, seen: &Measured<'_>, torque: &mut [f64]);
}

impl<F: FnMut(&Measured<'_>, &mut [f64])> ControlLaw for F {
    fn command(&mut self, seen: &Measured<'_>, torque: &mut [f64]) {
        self(seen, torque);
    }
}

/// The loop of the recordings: proportional-derivative feedback and the feed-forward of the user's model.
pub(super) struct PositionLoop<'a> {
    reference: &'a Reference,
    gains: Vec<(f64, f64)>,
}

impl<'a> PositionLoop<'a> {
    pub(super) fn new(reference: &'a Reference, robot: &Robot, parts: &Parts) -> Self {
        let joints = 0..robot.arm().dof();
        Self { reference, gains: joints.map(|j| gains(robot, j, parts.more_rotor(j))).collect() }
    }
}

impl ControlLaw for PositionLoop<'_> {
    fn command(&mut self, seen: &Measured<'_>, torque: &mut [f64]) {
        for (j, torque) in torque.iter_mut().enumerate() {
            let at = seen.tick * self.gains.len() + j;
            let (q, qd, ff) = (self.reference.q[at], self.reference.qd[at], self.reference.ff[at]);
            *torque = ff + self.gains[j].0 * (q - seen.q[j]) + self.gains[j].1 * (qd - seen.qd[j]);
        }
    }
}

/// Proportional and derivative gain of the position loop of joint `j`, whose rotor has the inertia `more` in addition
/// to the known one.
fn gains(robot: &Robot, j: usize, more: f64) -> (f64, f64) {
    let inertia = robot.inertia(j) + more;
    // A light wrist without rotors needs a higher gain, or the load would deflect it too far.
    let holds = (robot.holding(j) / STEADY_STATE_ERROR / inertia).sqrt();
    let frequency = holds.clamp(FREQUENCIES.0, FREQUENCIES.1);
    (inertia * frequency * frequency, 2.0 * DAMPING * frequency * inertia)
}
