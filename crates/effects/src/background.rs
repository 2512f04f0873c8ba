//! Laws of the background: columns under a prior in every fit, for errors that every model has. They are not effects and
//! are not reported.

use crate::signals::Signals;
use crate::term::{Law, Term};

/// The part of a joint's largest speed below which its friction curve bends. Source: first background.
const SLOW: f64 = 0.1;

/// Friction in the recording `of[1]` only: sgn q̇ (form 0) or q̇ (form 1) there, zero in the other recordings.
pub static OWN_FRICTION: Law = Law {
    name: "own friction",
    column: |term, joint, motion| {
        if term.of[1] != motion.recording {
            Some(vec![0.0; motion.ticks()])
        } else if term.form == 0 {
            motion.map(|k| motion.sign(joint, k))
        } else {
            Some(motion.qd[joint].clone())
        }
    },
    ..Law::PLAIN
};

/// A constant torque while the joint moves in the recording `of[1]`, zero in the other recordings. It is not in the background, but
/// compared with its friction.
pub static OWN_CONSTANT: Law = Law {
    name: "own constant",
    column: |term, joint, motion| {
        if term.of[1] == motion.recording {
            motion.map(|k| motion.sign(joint, k).abs())
        } else {
            Some(vec![0.0; motion.ticks()])
        }
    },
    ..Law::PLAIN
};

/// The deviation of a friction curve from Coulomb and viscous friction: e^(−|q̇| / a tenth of the largest speed) sgn q̇ (form
/// 0), q̇ |q̇| (form 1).
pub static FRICTION_CURVE: Law = Law { name: "friction curve", column: friction_curve, ..Law::PLAIN };

fn friction_curve(term: &Term, joint: usize, motion: &Signals<'_>) -> Option<Vec<f64>> {
    let slow = (SLOW * motion.scales.speed[joint]).max(motion.scales.rest[joint]);
    let qd = &motion.qd[joint];
    motion.map(
        |k| {
            if term.form == 0 { (-(qd[k] / slow).abs()).exp() * motion.sign(joint, k) } else { qd[k] * qd[k].abs() }
        },
    )
}

/// A constant torque; its coefficient is the offset of the torque's sensor, or of a friction curve.
pub static OFFSET: Law = Law { name: "offset", column: |_, _, motion| Some(vec![1.0; motion.ticks()]), ..Law::PLAIN };

/// The torque for a unit of one of the ten inertial parameters (`of[1]`) of a load on the last link (`of[0]`) that only some of
/// the recordings have; zero in the others. Its columns are formed from those of the link.
pub static OWN_LOAD: Law = Law { name: "own load", needs_model: true, ..Law::PLAIN };

/// The rigid torque of a joint; its coefficient is the relative error of the torque constant.
pub static GAIN: Law =
    Law { name: "gain", column: |_, joint, motion| Some(motion.of_model(joint)), needs_model: true, ..Law::PLAIN };

/// The derivative of each joint's rigid torque by time, with the opposite sign; its coefficient is the time (s) by which all measured
/// torques come later than the positions. Neither measured torques nor known friction are differentiated, because dry friction may turn
/// round late on its own.
pub static LAG: Law = Law {
    name: "lag",
    column: |_, joint, motion| {
        let torque = &motion.rigid.tau[joint];
        let last = torque.len().saturating_sub(1);
        motion.map(|k| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
            (torque[before] - torque[after]) / (motion.period * (after - before).max(1) as f64)
        })
    },
    needs_model: true,
    ..Law::PLAIN
};
