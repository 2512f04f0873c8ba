//! Corrections of a recording's columns, and the recording with each.

use std::f64::consts::{FRAC_PI_2, PI};

use arm::{Arm, JointKind, Vector3};
use recording::RegularRecording;

use super::thresholds::OTHER_BASE;

/// What may be wrong in a recording's columns, and is corrected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Correction {
    AsItIs,
    /// A joint's position has the opposite sign.
    Flipped(usize),
    /// A joint's torque has the opposite sign.
    TorqueFlipped(usize),
    /// A joint's position and torque have the opposite sign.
    BothFlipped(usize),
    /// The positions and torques of two joints are swapped.
    Swapped(usize, usize),
    /// The torques of two joints are swapped.
    TorquesSwapped(usize, usize),
    /// The positions of two joints are swapped.
    PositionsSwapped(usize, usize),
    /// A joint's zero is wrong; the second value must be added to its position (rad).
    Zero(usize, f64),
    /// All positions are in a unit of this size (rad).
    Unit(f64),
    /// The positions of one joint are in a unit of this size (rad).
    UnitOf(usize, f64),
    /// All torques have the other sign, or all positions, or all of both.
    AllTorquesFlipped,
    AllPositionsFlipped,
    AllFlipped,
    /// The columns of all joints are in the opposite order, or those of the torques alone.
    Reversed,
    TorquesReversed,
    /// Gravity has another direction (base frame), as on a wall or a ceiling. That is an effect and not an error of the
    /// recording. It is among the corrections so that it is not taken for a wrong zero.
    Gravity(Vector3<f64>),
}

impl Correction {
    /// All corrections for an arm, of single joints only if they move: a resting joint gives too little information.
    pub fn all(arm: &Arm, moves: &[bool]) -> Vec<Self> {
        let dof = arm.dof();
        let mut all = Vec::new();
        for joint in (0..dof).filter(|&joint| moves[joint]) {
            all.extend([Self::Flipped(joint), Self::TorqueFlipped(joint), Self::BothFlipped(joint)]);
            if arm.joints()[joint].kind == JointKind::Revolute {
                all.extend([FRAC_PI_2, -FRAC_PI_2, PI].map(|offset| Self::Zero(joint, offset)));
            }
        }
        for first in 0..dof {
            for second in (first + 1..dof).filter(|&second| moves[first] && moves[second]) {
                all.push(Self::Swapped(first, second));
                all.push(Self::TorquesSwapped(first, second));
                all.push(Self::PositionsSwapped(first, second));
            }
        }
        if moves.iter().filter(|moves| **moves).count() > 1 {
            all.extend([Self::AllTorquesFlipped, Self::AllPositionsFlipped, Self::AllFlipped]);
        }
        // In an arm of three joints or fewer, the opposite order is a swap of two joints.
        if dof > 3 {
            all.extend([Self::Reversed, Self::TorquesReversed]);
        }
        all.extend(Self::bases(arm));
        all
    }

    /// The attitudes of the base on walls and on a ceiling.
    pub fn bases(arm: &Arm) -> Vec<Self> {
        let strength = arm.gravity().norm();
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let directions = axes.into_iter().flat_map(|axis| [axis * strength, -axis * strength]);
        let others = directions.filter(|gravity| (gravity - arm.gravity()).norm() > OTHER_BASE * strength);
        others.map(Self::Gravity).collect()
    }

    /// The arm with this correction.
    pub fn arm(self, arm: &Arm) -> Arm {
        match self {
            Self::Gravity(gravity) => arm.clone().with_gravity(gravity),
            _ => arm.clone(),
        }
    }

    /// From which columns the joints of `arm` are read.
    pub fn reading(self, arm: &Arm) -> Vec<JointReading> {
        let dof = arm.dof();
        let as_it_is =
            |joint: usize| JointReading { position: joint, torque: joint, scale: 1.0, offset: 0.0, torque_sign: 1.0 };
        let mut list: Vec<JointReading> = (0..dof).map(as_it_is).collect();
        match self {
            Self::AsItIs | Self::Gravity(_) => {}
            Self::Zero(joint, added) => list[joint].offset = added,
            Self::Flipped(joint) => list[joint].scale = -1.0,
            Self::TorqueFlipped(joint) => list[joint].torque_sign = -1.0,
            Self::BothFlipped(joint) => (list[joint].scale, list[joint].torque_sign) = (-1.0, -1.0),
            Self::Unit(factor) => {
                let turning = list.iter_mut().zip(arm.joints());
                turning
                    .filter(|(_, joint)| joint.kind == JointKind::Revolute)
                    .for_each(|(reading, _)| reading.scale = factor);
            }
            Self::UnitOf(joint, factor) => list[joint].scale = factor,
            Self::AllTorquesFlipped => list.iter_mut().for_each(|reading| reading.torque_sign = -1.0),
            Self::AllPositionsFlipped => list.iter_mut().for_each(|reading| reading.scale = -1.0),
            Self::AllFlipped => list.iter_mut().for_each(|reading| (reading.scale, reading.torque_sign) = (-1.0, -1.0)),
            Self::Reversed => (0..dof).for_each(|j| (list[j].position, list[j].torque) = (dof - 1 - j, dof - 1 - j)),
            Self::TorquesReversed => (0..dof).for_each(|j| list[j].torque = dof - 1 - j),
            Self::Swapped(a, b) => {
                (list[a].position, list[a].torque, list[b].position, list[b].torque) = (b, b, a, a);
            }
            Self::TorquesSwapped(a, b) => (list[a].torque, list[b].torque) = (b, a),
            Self::PositionsSwapped(a, b) => (list[a].position, list[b].position) = (b, a),
        }
        list
    }

    /// `recording`, with the joints of `arm` in its order, as it would be read.
    pub fn applied(self, arm: &Arm, recording: &RegularRecording) -> RegularRecording {
        let mut new = recording.clone();
        for (joint, reading) in self.reading(arm).into_iter().enumerate() {
            let motion = |value: &f64| reading.scale * value;
            let of = |signal: &recording::Signal| signal[reading.position].iter().map(motion).collect();
            new.q[joint] = recording.q[reading.position].iter().map(|q| motion(q) + reading.offset).collect();
            if let (Some(new), Some(old)) = (&mut new.qd, &recording.qd) {
                new[joint] = of(old);
            }
            if let (Some(new), Some(old)) = (&mut new.qdd, &recording.qdd) {
                new[joint] = of(old);
            }
            new.tau[joint] = recording.tau[reading.torque].iter().map(|tau| reading.torque_sign * tau).collect();
        }
        new
    }

    /// The joint, if it concerns one.
    pub fn joint(self) -> Option<usize> {
        match self {
            Self::Flipped(joint) | Self::TorqueFlipped(joint) | Self::BothFlipped(joint) | Self::Zero(joint, _) => {
                Some(joint)
            }
            _ => None,
        }
    }

    /// The joints whose columns it concerns.
    pub fn joints(self, arm: &Arm) -> Vec<usize> {
        let (as_it_is, read) = (Self::AsItIs.reading(arm), self.reading(arm));
        (0..arm.dof()).filter(|&joint| read[joint] != as_it_is[joint]).collect()
    }

    /// Whether friction shows it, because its work has the other sign.
    pub fn is_of_a_sign_of_friction(self) -> bool {
        matches!(self, Self::Flipped(_) | Self::TorqueFlipped(_) | Self::AllTorquesFlipped | Self::AllPositionsFlipped)
    }
}

/// From which columns a joint is read, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointReading {
    /// The joint whose columns hold its position, velocity and acceleration.
    pub position: usize,
    /// The joint whose column holds its torque.
    pub torque: usize,
    /// The factor of position, velocity and acceleration.
    pub scale: f64,
    /// What must be added to the position (rad).
    pub offset: f64,
    /// The factor of the torque.
    pub torque_sign: f64,
}
