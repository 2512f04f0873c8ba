//! Limits of a motion, joint by joint.

use arm::{Arm, JointKind, Workspace};
use rand::Rng;
use torque::{Motion, Reference};

use super::ExcitationError;
use crate::report::JointLimits;
use crate::thresholds::{LIMIT_MARGIN, WITHIN_LIMITS};

/// The part of the allowed torque that may be needed for holding the arm where the search starts, and the number of places that
/// are tried.
const HELD: f64 = 0.8;
const PLACES: usize = 2000;
/// The range of a revolute joint without position limits, to either side (rad).
const HALF_TURN: f64 = std::f64::consts::PI;

/// The limits of a joint; infinite where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionLimits {
    /// Lowest and highest position (rad or m).
    pub position: [f64; 2],
    /// Largest speed (rad/s or m/s).
    pub velocity: f64,
    /// Largest acceleration (rad/s² or m/s²).
    pub acceleration: f64,
    /// Largest torque (N m) or force (N).
    pub effort: f64,
}

impl MotionLimits {
    /// The limits in the URDF, one per joint; a URDF has none for the acceleration.
    pub fn of(arm: &Arm) -> Vec<Self> {
        let of = |joint: &arm::Joint| Self {
            position: [joint.limits.lower, joint.limits.upper],
            velocity: joint.limits.velocity,
            acceleration: f64::INFINITY,
            effort: joint.limits.effort,
        };
        arm.joints().iter().map(of).collect()
    }
}

/// The allowed motion of each joint: the limits with a margin.
#[derive(Clone, Debug)]
pub struct Allowed {
    names: Vec<String>,
    /// The middle between the position limits (rad or m).
    pub middle: Vec<f64>,
    /// The allowed distance from the middle (rad or m).
    pub room: Vec<f64>,
    /// The allowed speed (rad/s or m/s).
    pub velocity: Vec<f64>,
    /// The allowed acceleration (rad/s² or m/s²); infinite where it is not limited.
    pub acceleration: Vec<f64>,
    /// The allowed torque (N m or N); infinite where it is not limited.
    pub torque: Vec<f64>,
}

/// The demands of a motion on a joint, and the allowed values; infinite where acceleration or torque are not limited.
#[derive(Clone, Debug, PartialEq)]
pub struct JointUse {
    /// Position, speed and torque.
    pub limits: JointLimits,
    /// Largest acceleration (rad/s² or m/s²).
    pub acceleration: f64,
    /// The allowed acceleration (rad/s² or m/s²).
    pub acceleration_allowed: f64,
}

impl JointUse {
    /// The ratio of position (about `centre`), velocity or acceleration to the allowed value; at most 1 within the limits.
    pub fn beyond_motion(&self, centre: f64) -> f64 {
        let JointLimits { position: [low, high], position_allowed: [least, most], .. } = self.limits;
        let above = (high - centre) / (most - centre);
        let below = (centre - low) / (centre - least);
        let fast = self.limits.velocity / self.limits.velocity_allowed;
        let quick = self.acceleration / self.acceleration_allowed;
        above.max(below).max(fast).max(quick)
    }
}

impl Allowed {
    /// The allowed motion of the joints of `arm` with `limits`.
    ///
    /// # Errors
    /// If a limit that is needed is missing, or leaves no room.
    pub fn new(arm: &Arm, limits: &[MotionLimits]) -> Result<Self, ExcitationError> {
        let mut allowed = Self {
            names: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
            middle: Vec::new(),
            room: Vec::new(),
            velocity: Vec::new(),
            acceleration: Vec::new(),
            torque: Vec::new(),
        };
        for (joint, limits) in arm.joints().iter().zip(limits) {
            let unlimited = |what| ExcitationError::Unlimited { joint: joint.name.clone(), what };
            let no_room = |what, value: String| ExcitationError::NoRoom { joint: joint.name.clone(), what, value };
            let [mut lower, mut upper] = limits.position;
            if joint.kind == JointKind::Revolute && lower == f64::NEG_INFINITY && upper == f64::INFINITY {
                (lower, upper) = (-HALF_TURN, HALF_TURN);
            }
            if !(lower.is_finite() && upper.is_finite()) {
                return Err(unlimited("position"));
            }
            if lower >= upper {
                return Err(no_room("position", format!("{lower}:{upper}")));
            }
            if !limits.velocity.is_finite() {
                return Err(unlimited("velocity"));
            }
            for (what, value) in
                [("velocity", limits.velocity), ("acceleration", limits.acceleration), ("effort", limits.effort)]
            {
                if value.is_nan() || value <= 0.0 {
                    return Err(no_room(what, value.to_string()));
                }
            }
            allowed.middle.push(0.5 * (lower + upper));
            allowed.room.push((0.5 - LIMIT_MARGIN) * (upper - lower));
            allowed.velocity.push(WITHIN_LIMITS * limits.velocity);
            allowed.acceleration.push(WITHIN_LIMITS * limits.acceleration);
            allowed.torque.push(WITHIN_LIMITS * limits.effort);
        }
        Ok(allowed)
    }

    /// The demands of `reference` on each joint over `duration` (s) by the model of `arm`, evaluated at `hertz`.
    pub fn needed(
        &self,
        arm: &Arm,
        workspace: &mut Workspace,
        reference: &Reference,
        duration: f64,
        hertz: f64,
    ) -> Vec<JointUse> {
        let dof = arm.dof();
        let joints = self.names.iter().enumerate().map(|(j, joint)| JointUse {
            limits: JointLimits::at_rest(joint, (self.middle[j], self.room[j]), self.velocity[j], self.torque[j]),
            acceleration: 0.0,
            acceleration_allowed: self.acceleration[j],
        });
        let mut needed: Vec<JointUse> = joints.collect();
        let mut motion = Motion::new(dof);
        let mut torque = vec![0.0; dof];
        for k in 0..=(duration * hertz) as usize {
            reference.at(k as f64 / hertz, &mut motion);
            arm.inverse_dynamics(workspace, &motion.q, &motion.qd, &motion.qdd, &mut torque);
            for (j, needed) in needed.iter_mut().enumerate() {
                needed.limits.include(motion.q[j], motion.qd[j], torque[j]);
                needed.acceleration = needed.acceleration.max(motion.qdd[j].abs());
            }
        }
        needed
    }

    /// A place at which no joint needs more than [`HELD`] of its torque to hold the arm, relative to the room about the middle:
    /// the middle itself, or a random place.
    ///
    /// # Errors
    /// [`ExcitationError::TooWeak`], if there is no such place among many random ones.
    pub fn holdable(&self, arm: &Arm, random: &mut impl Rng) -> Result<Vec<f64>, ExcitationError> {
        let mut workspace = Workspace::new(arm);
        let mut place = vec![0.0; arm.dof()];
        for _ in 0..PLACES {
            let torque = self.static_torque(arm, &mut workspace, &self.at(&place));
            if torque.iter().zip(&self.torque).all(|(torque, most)| torque.abs() <= HELD * most) {
                return Ok(place);
            }
            place.fill_with(|| random.random_range(-0.9..0.9));
        }
        Err(self.too_weak(arm, &mut workspace, &self.middle))
    }

    /// The positions (rad or m) of a place given relative to the room.
    fn at(&self, place: &[f64]) -> Vec<f64> {
        let parts = self.middle.iter().zip(&self.room).zip(place);
        parts.map(|((middle, room), part)| middle + room * part).collect()
    }

    fn static_torque(&self, arm: &Arm, workspace: &mut Workspace, q: &[f64]) -> Vec<f64> {
        let still = vec![0.0; q.len()];
        let mut torque = vec![0.0; q.len()];
        arm.inverse_dynamics(workspace, q, &still, &still, &mut torque);
        torque
    }

    /// The joint that is too weak to hold the arm at the positions `q`, if there is one.
    pub fn too_weak(&self, arm: &Arm, workspace: &mut Workspace, q: &[f64]) -> ExcitationError {
        let torque = self.static_torque(arm, workspace, q);
        let part = |j: &usize| torque[*j].abs() / self.torque[*j];
        let weakest = (0..q.len()).max_by(|a, b| part(a).total_cmp(&part(b))).unwrap_or(0);
        ExcitationError::TooWeak {
            joint: self.names[weakest].clone(),
            torque: torque[weakest].abs(),
            allowed: self.torque[weakest],
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// An arm that cannot be held at the middle of its ranges is held at another place; one that cannot be held at any place is
    /// refused.
    #[test]
    fn a_place_is_found_at_which_the_arm_can_be_held() {
        let text = include_str!("../../../../assets/puma560.urdf");
        let arm = Arm::from_urdf_text(text, "puma560.urdf").expect("an arm");
        let free = Allowed::new(&arm, &MotionLimits::of(&arm)).expect("limits");
        let mut workspace = Workspace::new(&arm);
        let at_the_middle = free.static_torque(&arm, &mut workspace, &free.middle)[1].abs();
        assert!(at_the_middle > 1.0, "{at_the_middle} N m");
        let mut with = |part: f64| {
            let mut allowed = free.clone();
            allowed.torque[1] = part * at_the_middle;
            let place = allowed.holdable(&arm, &mut ChaCha8Rng::seed_from_u64(0))?;
            Ok::<f64, ExcitationError>(allowed.static_torque(&arm, &mut workspace, &allowed.at(&place))[1].abs())
        };
        let held = with(0.6).expect("a place");
        assert!(held <= HELD * 0.6 * at_the_middle, "{held} of {at_the_middle} N m");
        let refusal = with(1e-7).expect_err("no joint is that weak").to_string();
        assert!(refusal.contains("joint2"), "{refusal}");
    }
}
