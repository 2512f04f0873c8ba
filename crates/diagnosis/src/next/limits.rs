//! Limits of a proposed motion, and the check that it stays within them.

use arm::Arm;
use effects::Effect;
use effects::drive::TORQUE_SATURATION;
use torque::{Corrected, Motion, Prediction, Reference, TorqueError, Workspace};

use crate::data::Data;
use crate::data::statistics::median;
use crate::report::JointLimits;
use crate::thresholds::{
    BEYOND_RECORDED, BEYOND_UNEXPLAINED, FASTER_UNLIMITED, HELD_STILL, LIMIT_MARGIN, STRONGER_UNLIMITED, WITHIN_LIMITS,
};

/// The allowed motion of each joint.
pub struct Limits {
    /// The joints.
    pub names: Vec<String>,
    /// The middle of the motion (rad or m).
    pub middle: Vec<f64>,
    /// The allowed distance from the middle (rad or m).
    pub room: Vec<f64>,
    /// The allowed speed (rad/s or m/s).
    pub speed: Vec<f64>,
    /// The allowed torque (N m or N).
    pub torque: Vec<f64>,
    /// The corrected model, whose torques bound what a motion may need.
    pub model: Corrected,
}

impl Limits {
    /// The limits for the arm `arm` of `data`. Torques are those of `arm` with `effects`, which are known or found, and which
    /// `explain` the recordings or not. A torque limit among them bounds what a motion may need.
    ///
    /// # Errors
    /// If the effects cannot be added to the model.
    pub fn new(data: &Data, (arm, effects): (&Arm, &[Effect]), explain: bool) -> Result<Self, TorqueError> {
        let is_limit = |effect: &&Effect| effect.is(&TORQUE_SATURATION);
        let (found, others): (Vec<&Effect>, Vec<&Effect>) = effects.iter().partition(is_limit);
        let with = |effects: Vec<&Effect>| Corrected::new(arm, &effects.into_iter().cloned().collect::<Vec<_>>());
        let (found, model) = (with(found)?, with(others)?);
        let (wider, faster) = if explain { BEYOND_RECORDED } else { BEYOND_UNEXPLAINED };
        let joints = data.arm.joints();
        let scales = &data.scales;
        let typical = {
            let moving = (0..joints.len()).filter(|&j| scales.speed[j] > scales.rest[j]);
            median(moving.map(|j| 0.5 * scales.range[j]).collect())
        };
        let mut limits = Self {
            names: joints.iter().map(|joint| joint.name.clone()).collect(),
            middle: scales.middle.iter().map(|&middle| rounded(middle)).collect(),
            room: Vec::new(),
            speed: Vec::new(),
            torque: Vec::new(),
            model,
        };
        let fastest = scales.speed.iter().copied().fold(0.0, f64::max);
        for (j, joint) in joints.iter().enumerate() {
            let (lower, upper) = (joint.limits.lower, joint.limits.upper);
            let free = if (upper - lower).is_finite() { LIMIT_MARGIN * (upper - lower) } else { 0.0 };
            // The recorded motion may be beyond the URDF's limits.
            if upper - free >= lower + free {
                limits.middle[j] = rounded_into(limits.middle[j], lower + free, upper - free);
            }
            let middle = limits.middle[j];
            let to_a_limit = (upper - free - middle).min(middle - lower - free).max(0.0);
            // A joint that was held still may move as the others do.
            let recorded = 0.5 * scales.range[j];
            let (half, speed) = if scales.speed[j] > scales.rest[j] {
                (wider * recorded, scales.speed[j])
            } else {
                (typical, HELD_STILL * fastest)
            };
            limits.room.push(half.min(to_a_limit));
            limits.speed.push(if joint.limits.velocity.is_finite() {
                (WITHIN_LIMITS * joint.limits.velocity).min(faster * speed)
            } else {
                FASTER_UNLIMITED.min(faster) * speed
            });
            let torque = data.measured[j].iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
            let allowed = if joint.limits.effort.is_finite() {
                // A drive that gave this torque in the recordings can give it again.
                (WITHIN_LIMITS * joint.limits.effort).max(torque.min(joint.limits.effort))
            } else {
                STRONGER_UNLIMITED * torque
            };
            limits.torque.push(allowed.min(found.torque_limits()[j]));
        }
        Ok(limits)
    }

    /// The demands of `reference` on each joint over `duration` (s), evaluated at `hertz`.
    pub fn needed(&self, reference: &Reference, duration: f64, hertz: f64) -> Vec<JointLimits> {
        let dof = self.names.len();
        let joints = self.names.iter().enumerate().map(|(j, joint)| {
            JointLimits::at_rest(joint, (self.middle[j], self.room[j]), self.speed[j], self.torque[j])
        });
        let mut needed: Vec<JointLimits> = joints.collect();
        let mut motion = Motion::new(dof);
        let mut workspace = Workspace::new(dof);
        let mut prediction = Prediction::new(dof);
        for k in 0..=(duration * hertz) as usize {
            let time = k as f64 / hertz;
            reference.at(time, &mut motion);
            let (q, qd, qdd) = (&motion.q, &motion.qd, &motion.qdd);
            // The time is the motion's own: a contact is not repeated, and a drive is warm.
            self.model.predict_at(f64::INFINITY, &mut workspace, q, qd, qdd, &mut prediction);
            for (j, needed) in needed.iter_mut().enumerate() {
                needed.include(q[j], qd[j], prediction.torque(j));
            }
        }
        needed
    }
}

/// Rounds to four decimals, as in the scenario's file.
pub fn rounded(value: f64) -> f64 {
    (1e4 * value).round() / 1e4
}

/// The nearest position between two bounds, rounded to four decimals without exceeding them.
fn rounded_into(value: f64, low: f64, high: f64) -> f64 {
    rounded(value).max((1e4 * low).ceil() / 1e4).min((1e4 * high).floor() / 1e4)
}

/// The largest ratio of `needed` to the allowed values: of room, of speed, and of torque.
pub fn taken(needed: &[JointLimits]) -> [f64; 3] {
    let share = |of: f64, allowed: f64| if of > 0.0 { of / allowed.max(1e-300) } else { 0.0 };
    let most = |pick: &dyn Fn(&JointLimits) -> f64| needed.iter().map(pick).fold(0.0, f64::max);
    let room = |joint: &JointLimits| {
        let [low, high] = joint.position_allowed;
        let middle = 0.5 * (low + high);
        share((joint.position[1] - middle).max(middle - joint.position[0]), 0.5 * (high - low))
    };
    [
        most(&room),
        most(&|joint| share(joint.velocity, joint.velocity_allowed)),
        most(&|joint| share(joint.torque, joint.torque_allowed)),
    ]
}

#[cfg(test)]
mod tests {
    use super::rounded_into;

    /// A recorded range beyond a limit is brought within it, and rounding does not exceed the limit again.
    #[test]
    fn a_middle_is_within_its_limits() {
        assert_eq!(rounded_into(0.025_83, -3.0718, -0.219_94), -0.22);
        assert_eq!(rounded_into(-4.0, -2.999_96, 1.0), -2.9999);
        assert_eq!(rounded_into(0.123_456, f64::NEG_INFINITY, f64::INFINITY), 0.1235);
    }
}
