//! What in a recording does not fit the robot's URDF: names, limits, signs, order, motor side.

use arm::{Arm, Workspace};
use recording::{FindingKind, Quality, RegularRecording};
use report::numbers::rounded;
use serde::Serialize;

use super::smooth::Smooth;
use super::torque_unit::{self, MOTOR_SIDE, deviation};
use crate::library::nearest;

/// A joint's torque is explained if its residual has at most this share of its variance.
const EXPLAINED: f64 = 0.2;
/// An assumption must reduce the mean log residual of the joints by at least this much.
const GAIN: f64 = 2.0;
/// An assumption must be better than the next one by at least this reduction of the mean log residual.
const LEAD: f64 = 1.0;
/// A torque more than this times the model's is in another unit.
const OTHER_UNIT: f64 = 100.0;
/// Something that does not fit.
#[derive(Debug, Serialize)]
pub struct Misfit {
    /// The joint, if it is about one.
    pub joint: Option<String>,
    /// What was found, and the remedy.
    pub text: String,
    /// Whether it must be corrected before the robot can be diagnosed.
    #[serde(skip)]
    pub spoils: bool,
}

/// What in `regular` does not fit `arm`.
pub fn check(arm: &Arm, regular: &RegularRecording, quality: &Quality) -> Vec<Misfit> {
    let mut misfits = names(arm, regular);
    for (joint, measured) in arm.joints().iter().filter_map(|joint| {
        let found = quality.joints.iter().find(|quality| quality.joint == joint.name)?;
        Some((joint, found))
    }) {
        let mut add = |text: String| {
            misfits.push(Misfit {
                joint: Some(joint.name.clone()),
                text,
                spoils: false,
            });
        };
        let limits = joint.limits;
        let (low, high) = measured.q_range;
        if low < limits.lower - 1e-2 || high > limits.upper + 1e-2 {
            add(format!(
                "positions {} … {} exceed the URDF's limits {:.3} … {:.3}; check unit, zero and sign, or the limits",
                rounded(low, 4),
                rounded(high, 4),
                limits.lower,
                limits.upper
            ));
        }
        let torque = measured.tau_range.0.abs().max(measured.tau_range.1.abs());
        if limits.effort > 0.0 && torque > 1.05 * limits.effort {
            add(format!(
                "the torque reaches {torque:.4}, above the URDF's effort limit {:.4}; check its unit and side of the gear",
                limits.effort
            ));
        }
    }
    let order: Option<Vec<usize>> = arm
        .joints()
        .iter()
        .map(|joint| regular.joints.iter().position(|name| *name == joint.name))
        .collect();
    if let Some(order) = order {
        let moves: Vec<bool> = order.iter().map(|&joint| quality.joints[joint].moves).collect();
        let smooth = Smooth::of(regular, &order);
        // Positions in degrees or of another joint leave nothing to compare torques with.
        let doubted = quality.findings.iter().any(|finding| {
            matches!(
                finding.kind,
                FindingKind::TimeUnit | FindingKind::Degrees | FindingKind::VelocityUnit | FindingKind::VelocitySwapped
            )
        });
        if smooth.len() > 100 && !doubted {
            misfits.extend(torques(arm, &smooth, &moves));
        }
    }
    misfits
}

fn names(arm: &Arm, regular: &RegularRecording) -> Vec<Misfit> {
    let of_arm: Vec<String> = arm.joints().iter().map(|joint| joint.name.clone()).collect();
    let missing = |from: &[String], within: &[String], what: &str| -> Vec<Misfit> {
        let lost = from.iter().filter(|name| !within.contains(name));
        lost.map(|name| {
            let free: Vec<String> = within.iter().filter(|other| !from.contains(other)).cloned().collect();
            let hint = nearest(name, &free).map_or(String::new(), |other| format!("; is \"{other}\" meant?"));
            Misfit {
                joint: Some(name.clone()),
                text: format!("{what}{hint} Name the columns as the URDF does, or give a column map (--map)"),
                spoils: false,
            }
        })
        .collect()
    };
    let is_fixed = |joint: &String| arm.fixed_joints().iter().any(|fixed| fixed.name == *joint);
    let recorded: Vec<String> = regular
        .joints
        .iter()
        .filter(|joint| !is_fixed(joint))
        .cloned()
        .collect();
    let mut misfits = missing(
        &recorded,
        &of_arm,
        "is in the recording, but the URDF has no such joint",
    );
    misfits.extend(missing(
        &of_arm,
        &regular.joints,
        "is in the URDF, but the recording has no such joint",
    ));
    misfits
}

/// How the recording may have been meant.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Supposition {
    AsItIs,
    /// A joint's position has the other sign.
    Flipped(usize),
    /// A joint's torque has.
    TorqueFlipped(usize),
    /// The positions and torques of two joints are swapped.
    Swapped(usize, usize),
    /// The torques alone are.
    TorquesSwapped(usize, usize),
    /// The positions alone are.
    PositionsSwapped(usize, usize),
}

impl Supposition {
    /// Whether both are about the signs of one joint.
    fn same_joint(self, other: Self) -> bool {
        let joint = |supposition| match supposition {
            Self::Flipped(joint) | Self::TorqueFlipped(joint) => Some(joint),
            _ => None,
        };
        joint(self).is_some() && joint(self) == joint(other)
    }
}

/// The fit of measured torques by the model's, with dry and viscous friction and an offset.
pub(super) struct Fit {
    /// The residual share of each joint's variance.
    left: Vec<f64>,
    /// The factor of the model's torque.
    pub(super) factor: Vec<f64>,
    /// The residual share without the model's torque.
    without: Vec<f64>,
    /// The measured torque's standard deviation over the model's.
    pub(super) size: Vec<f64>,
}

impl Fit {
    /// Whether the model's torque is needed to explain the joint's.
    pub(super) fn told_by_model(&self, joint: usize) -> bool {
        self.left[joint] < EXPLAINED && self.without[joint] > 3.0 * self.left[joint]
    }

    fn score(&self) -> f64 {
        self.left.iter().map(|left| left.max(0.01).ln()).sum()
    }
}

/// Assumptions concern moving joints only, because a resting joint gives too little information.
fn torques(arm: &Arm, smooth: &Smooth, moves: &[bool]) -> Vec<Misfit> {
    let dof = arm.dof();
    let names: Vec<&str> = arm.joints().iter().map(|joint| joint.name.as_str()).collect();
    let mut suppositions: Vec<Supposition> = (0..dof)
        .filter(|&joint| moves[joint])
        .flat_map(|joint| [Supposition::Flipped(joint), Supposition::TorqueFlipped(joint)])
        .collect();
    for first in 0..dof {
        for second in (first + 1..dof).filter(|&second| moves[first] && moves[second]) {
            suppositions.push(Supposition::Swapped(first, second));
            suppositions.push(Supposition::TorquesSwapped(first, second));
            suppositions.push(Supposition::PositionsSwapped(first, second));
        }
    }
    let as_it_is = fit(arm, smooth, Supposition::AsItIs);
    let mut scored: Vec<(f64, Supposition, Fit)> = suppositions
        .into_iter()
        .map(|supposition| {
            let fit = fit(arm, smooth, supposition);
            (as_it_is.score() - fit.score(), supposition, fit)
        })
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let told = |joint: Option<usize>, text: String| Misfit {
        joint: joint.map(|joint| names[joint].to_owned()),
        text,
        spoils: false,
    };
    if let Some(text) = torque_unit::of(moves, &as_it_is) {
        return vec![Misfit {
            joint: None,
            text,
            spoils: true,
        }];
    }
    let remedy = "correct the header, or map the columns (--map)";
    if let Some((gain, best, fit)) = scored.first() {
        let next = scored[1..].iter().find(|(_, other, _)| !best.same_joint(*other));
        let lead = gain - next.map_or(0.0, |next| next.0);
        let rival = scored
            .get(1)
            .is_some_and(|(next, other, _)| best.same_joint(*other) && gain - next < LEAD);
        let good =
            |joint: &usize| fit.left[*joint] < EXPLAINED && as_it_is.left[*joint] > 3.0 * fit.left[*joint].max(0.02);
        let swapped = |what: &str, a: usize, b: usize| {
            let text = format!("the {what} of {} and {} seem swapped; {remedy}", names[a], names[b]);
            vec![told(None, text)]
        };
        if *gain > GAIN && lead > LEAD {
            match *best {
                Supposition::Flipped(joint) | Supposition::TorqueFlipped(joint) if good(&joint) => {
                    let text = if rival {
                        "the torque or the position has the sign opposite to the URDF's axis; invert one (tau_sign = -1, or \
                         sign and tau_sign, in a column map)"
                    } else if matches!(best, Supposition::TorqueFlipped(_)) {
                        "the torque has the sign opposite to the URDF's axis; invert it (tau_sign = -1 in a column map)"
                    } else if fit.factor[joint] < 0.0 {
                        "position and torque have the sign opposite to the URDF's axis; invert both (sign = -1 in a column map)"
                    } else {
                        "the position has the sign opposite to the URDF's axis; invert it (sign = -1 and tau_sign = -1 in a \
                         column map)"
                    };
                    return vec![told(Some(joint), text.into())];
                }
                Supposition::Swapped(a, b) if good(&a) && good(&b) => return swapped("columns", a, b),
                Supposition::TorquesSwapped(a, b) if good(&a) && good(&b) => return swapped("torques", a, b),
                // All joints' torques depend on the positions: that one of the two is explained is enough.
                Supposition::PositionsSwapped(a, b) if good(&a) || good(&b) => {
                    return swapped("positions", a, b);
                }
                _ => {}
            }
        }
    }
    let mut misfits = Vec::new();
    for (joint, &factor) in as_it_is.factor.iter().enumerate() {
        let matters = moves[joint] && as_it_is.told_by_model(joint);
        let size = factor.abs();
        if matters && factor > 0.0 && !(MOTOR_SIDE..OTHER_UNIT).contains(&size) {
            let what = if size < 1.0 {
                "motor side, or a current"
            } else {
                "another unit"
            };
            let text = format!(
                "the torque is {size:.2e} times the model's: {what}? Give tau_scale (about {:.3}) in a column map",
                1.0 / size
            );
            misfits.push(told(Some(joint), text));
        }
    }
    misfits
}

fn fit(arm: &Arm, smooth: &Smooth, supposition: Supposition) -> Fit {
    let dof = arm.dof();
    let count = smooth.len();
    let mut source: Vec<usize> = (0..dof).collect();
    let mut torque_source = source.clone();
    let mut sign = vec![1.0; dof];
    match supposition {
        Supposition::AsItIs | Supposition::TorqueFlipped(_) => {}
        Supposition::Flipped(joint) => sign[joint] = -1.0,
        Supposition::Swapped(a, b) => {
            source.swap(a, b);
            torque_source.swap(a, b);
        }
        Supposition::TorquesSwapped(a, b) => torque_source.swap(a, b),
        Supposition::PositionsSwapped(a, b) => source.swap(a, b),
    }
    // The model by the motion as supposed.
    let mut workspace = Workspace::new(arm);
    let mut model = vec![vec![0.0; count]; dof];
    let mut tau = vec![0.0; dof];
    for k in 0..count {
        let pick = |signal: &[Vec<f64>]| -> Vec<f64> { (0..dof).map(|j| sign[j] * signal[source[j]][k]).collect() };
        let (q, qd, qdd) = (pick(&smooth.q), pick(&smooth.qd), pick(&smooth.qdd));
        arm.inverse_dynamics(&mut workspace, &q, &qd, &qdd, &mut tau);
        for (joint, tau) in tau.iter().enumerate() {
            model[joint][k] = *tau;
        }
    }
    let mut fit = Fit {
        left: Vec::new(),
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
        let (left, factor) = regress(&[&model[joint], &dry, speed], measured);
        // A joint whose position is flipped may have its torque flipped along, one whose torque is must;
        // otherwise a negative factor explains nothing.
        let explains = match supposition {
            Supposition::Flipped(flipped) if flipped == joint => true,
            Supposition::TorqueFlipped(flipped) if flipped == joint => factor < 0.0,
            _ => factor >= 0.0,
        };
        fit.left.push(if explains { left } else { without });
        fit.factor.push(factor);
        fit.without.push(without);
        fit.size
            .push(deviation(measured) / deviation(&model[joint]).max(f64::MIN_POSITIVE));
    }
    fit
}

/// The residual variance of `measured` after `columns` and an offset (Gram-Schmidt, the first
/// column last), and the factor of the first column.
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
