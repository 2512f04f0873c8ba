//! Suppositions about a recording, and how well the model explains it under each.

use std::f64::consts::{FRAC_PI_2, PI};

use arm::{Arm, JointKind, Vector3, Workspace};

use super::smooth::Smooth;

/// A joint's torque is explained if its residual has at most this share of its variance.
pub const EXPLAINED: f64 = 0.2;

/// A supposition about a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Supposition {
    AsItIs,
    /// A joint's position has the opposite sign.
    Flipped(usize),
    /// A joint's torque has the opposite sign.
    TorqueFlipped(usize),
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
    /// recording. It is among the suppositions so that it is not taken for a wrong zero.
    Gravity(Vector3<f64>),
}

impl Supposition {
    /// All suppositions on an arm, of which single joints only if they move: a resting joint gives too little information.
    pub fn all(arm: &Arm, moves: &[bool]) -> Vec<Self> {
        let dof = arm.dof();
        let mut all = Vec::new();
        for joint in (0..dof).filter(|&joint| moves[joint]) {
            all.extend([Self::Flipped(joint), Self::TorqueFlipped(joint)]);
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
        let strength = arm.gravity().norm();
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let directions = axes.into_iter().flat_map(|axis| [axis * strength, -axis * strength]);
        let others = directions.filter(|gravity| (gravity - arm.gravity()).norm() > 0.1 * strength);
        all.extend(others.map(Self::Gravity));
        all
    }

    /// Whether it is about the signs of all joints.
    pub fn is_of_all_signs(self) -> bool {
        matches!(
            self,
            Self::AllTorquesFlipped | Self::AllPositionsFlipped | Self::AllFlipped
        )
    }

    /// Whether both are about the signs of all joints. A motion with small accelerations hardly distinguishes these
    /// suppositions.
    pub fn same_signs(self, other: Self) -> bool {
        self.is_of_all_signs() && other.is_of_all_signs()
    }

    /// What is wrong, in a few words; `None` for a supposition that is never mentioned beside another one.
    pub fn words(self, names: &[&str]) -> Option<String> {
        Some(match self {
            Self::AsItIs | Self::Unit(_) | Self::UnitOf(..) | Self::Gravity(_) => return None,
            Self::Flipped(joint) => format!("the position of {} has the other sign", names[joint]),
            Self::TorqueFlipped(joint) => format!("the torque of {} has the other sign", names[joint]),
            Self::Swapped(a, b) => format!("the columns of {} and {} are swapped", names[a], names[b]),
            Self::TorquesSwapped(a, b) => format!("the torques of {} and {} are swapped", names[a], names[b]),
            Self::PositionsSwapped(a, b) => format!("the positions of {} and {} are swapped", names[a], names[b]),
            Self::Zero(joint, _) => format!("the zero of {} is off by a quarter or half of a turn", names[joint]),
            Self::AllTorquesFlipped => "all torques have the other sign".to_owned(),
            Self::AllPositionsFlipped => "all positions have the other sign".to_owned(),
            Self::AllFlipped => "all positions and torques have the other sign".to_owned(),
            Self::Reversed => "all columns are in the opposite order".to_owned(),
            Self::TorquesReversed => "all torques are in the opposite order".to_owned(),
        })
    }

    /// Whether both are about the signs or the zero of one joint.
    pub fn same_joint(self, other: Self) -> bool {
        let joint = |supposition| match supposition {
            Self::Flipped(joint) | Self::TorqueFlipped(joint) | Self::Zero(joint, _) => Some(joint),
            _ => None,
        };
        joint(self).is_some() && joint(self) == joint(other)
    }
}

/// The fit of measured torques by the model's, with dry and viscous friction and an offset.
pub struct Fit {
    /// The residual variance over the variance of the torque, by joint.
    pub residual_share: Vec<f64>,
    /// The factor of the model's torque, by joint.
    pub factor: Vec<f64>,
    /// The residual variance over the variance of the torque in a fit without the model's torque, by joint.
    pub without: Vec<f64>,
    /// The standard deviation of the measured torque over that of the model's, by joint.
    pub size: Vec<f64>,
}

impl Fit {
    /// Whether the model's torque is needed to explain the joint's.
    pub fn needs_model(&self, joint: usize) -> bool {
        self.residual_share[joint] < EXPLAINED && self.without[joint] > 3.0 * self.residual_share[joint]
    }

    /// Whether the model, with its own sign, is needed and sufficient to explain at least half of the joints that move.
    pub fn explains_most(&self, moves: &[bool]) -> bool {
        let is_explained = |&joint: &usize| self.needs_model(joint) && self.factor[joint] > 0.0;
        let explained = (0..self.residual_share.len()).filter(is_explained).count();
        2 * explained >= moves.iter().filter(|moves| **moves).count()
    }

    /// The sum of the logarithms of the joints' residuals.
    pub fn score(&self) -> f64 {
        self.residual_share
            .iter()
            .map(|residual_share| residual_share.max(0.01).ln())
            .sum()
    }
}

/// The standard deviation of `values`, with their number as the divisor.
fn deviation(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// The fit of the torques by the model of `arm` under a `supposition`.
pub fn fit(arm: &Arm, smooth: &Smooth, supposition: Supposition) -> Fit {
    let turned;
    let arm = if let Supposition::Gravity(gravity) = supposition {
        turned = arm.clone().with_gravity(gravity);
        &turned
    } else {
        arm
    };
    let dof = arm.dof();
    let count = smooth.len();
    let mut source: Vec<usize> = (0..dof).collect();
    let mut torque_source = source.clone();
    let mut sign = vec![1.0; dof];
    let mut scale = vec![1.0; dof];
    let mut torque_sign = 1.0;
    let mut offset = vec![0.0; dof];
    match supposition {
        Supposition::AsItIs | Supposition::TorqueFlipped(_) | Supposition::Gravity(_) => {}
        Supposition::Zero(joint, added) => offset[joint] = added,
        Supposition::Flipped(joint) => sign[joint] = -1.0,
        Supposition::Unit(factor) => {
            for (scale, joint) in scale.iter_mut().zip(arm.joints()) {
                if joint.kind == JointKind::Revolute {
                    *scale = factor;
                }
            }
        }
        Supposition::UnitOf(joint, factor) => scale[joint] = factor,
        Supposition::AllTorquesFlipped => torque_sign = -1.0,
        Supposition::AllPositionsFlipped => sign.fill(-1.0),
        Supposition::AllFlipped => {
            sign.fill(-1.0);
            torque_sign = -1.0;
        }
        Supposition::Reversed => {
            source.reverse();
            torque_source.reverse();
        }
        Supposition::TorquesReversed => torque_source.reverse(),
        Supposition::Swapped(a, b) => {
            source.swap(a, b);
            torque_source.swap(a, b);
        }
        Supposition::TorquesSwapped(a, b) => torque_source.swap(a, b),
        Supposition::PositionsSwapped(a, b) => source.swap(a, b),
    }
    // The model along the supposed motion.
    let mut workspace = Workspace::new(arm);
    let mut model = vec![vec![0.0; count]; dof];
    let mut tau = vec![0.0; dof];
    for k in 0..count {
        let pick =
            |signal: &[Vec<f64>]| -> Vec<f64> { (0..dof).map(|j| sign[j] * scale[j] * signal[source[j]][k]).collect() };
        let (mut q, qd, qdd) = (pick(&smooth.q), pick(&smooth.qd), pick(&smooth.qdd));
        q.iter_mut().zip(&offset).for_each(|(q, offset)| *q += offset);
        arm.inverse_dynamics(&mut workspace, &q, &qd, &qdd, &mut tau);
        for (joint, tau) in tau.iter().enumerate() {
            model[joint][k] = *tau;
        }
    }
    let mut fit = Fit {
        residual_share: Vec::new(),
        factor: Vec::new(),
        without: Vec::new(),
        size: Vec::new(),
    };
    for joint in 0..dof {
        let speed = &smooth.qd[source[joint]];
        let top = speed.iter().fold(1e-9_f64, |top, speed| top.max(speed.abs()));
        let dry: Vec<f64> = speed.iter().map(|speed| (speed / (0.02 * top)).tanh()).collect();
        let measured = &smooth.tau[torque_source[joint]];
        let (without, _) = regress(&[&dry, speed], measured);
        let (residual_share, factor) = regress(&[&model[joint], &dry, speed], measured);
        // A negative factor counts as an explanation only for a joint whose torque is supposed to be inverted, or whose
        // position is and whose torque may be inverted too.
        let explains = match supposition {
            Supposition::Flipped(flipped) if flipped == joint => true,
            Supposition::TorqueFlipped(flipped) if flipped == joint => factor < 0.0,
            _ => torque_sign * factor >= 0.0,
        };
        fit.residual_share.push(if explains { residual_share } else { without });
        fit.factor.push(factor);
        fit.without.push(without);
        fit.size
            .push(deviation(measured) / deviation(&model[joint]).max(f64::MIN_POSITIVE));
    }
    fit
}

/// The residual variance of `measured` after a least-squares fit of `columns` and an offset, over its variance, and the
/// factor of the first column (Gram-Schmidt orthogonalisation with the first column last).
fn regress(columns: &[&Vec<f64>], measured: &[f64]) -> (f64, f64) {
    let centred = |values: &[f64]| -> Vec<f64> {
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        values.iter().map(|value| value - mean).collect()
    };
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut rest = centred(measured);
    let total = dot(&rest, &rest);
    if total <= 0.0 {
        return (1.0, 0.0);
    }
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut factor = 0.0;
    for column in columns.iter().rev() {
        let mut column = centred(column);
        let before = dot(&column, &column);
        for other in &basis {
            let share = dot(&column, other) / dot(other, other);
            column
                .iter_mut()
                .zip(other)
                .for_each(|(value, other)| *value -= share * other);
        }
        let after = dot(&column, &column);
        factor = 0.0;
        if after > 1e-9 * before && after > 0.0 {
            factor = dot(&rest, &column) / after;
            rest.iter_mut()
                .zip(&column)
                .for_each(|(value, column)| *value -= factor * column);
            basis.push(column);
        }
    }
    (dot(&rest, &rest) / total, factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A simulated arm of seven joints with a URDF wrong by 30 %: the centres of mass of light links lie on the other side
    /// of their axes. Inverting all signs fits better, but the heavy links are explained without it.
    #[test]
    fn light_links_do_not_decide_on_the_signs_of_the_arm() {
        let fit = |residual_share: [f64; 7], factor: [f64; 7]| Fit {
            residual_share: residual_share.to_vec(),
            factor: factor.to_vec(),
            without: vec![0.95; 7],
            size: vec![1.0; 7],
        };
        let residual_share = [0.05, 0.01, 0.80, 0.01, 0.97, 0.02, 0.80];
        let mirrored = fit(residual_share, [0.50, 0.88, 0.18, 0.94, 0.0, 1.26, -1.0]);
        assert!(mirrored.explains_most(&[true; 7]));
        let inverted = fit(residual_share, [-0.50, -0.88, 0.18, -0.94, 0.0, -1.26, -1.0]);
        assert!(!inverted.explains_most(&[true; 7]));
        let unknown = fit([0.8; 7], [0.2; 7]);
        assert!(!unknown.explains_most(&[true; 7]));
    }
}
