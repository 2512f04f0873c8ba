//! Torques that were recorded without gravity.

use effects::{Scales, sign};
use nalgebra::{DMatrix, DVector, Vector3};

use crate::data::motion::Motions;
use crate::data::rigid::Rigid;
use crate::data::statistics::{deviation, mean_square};
use crate::thresholds::{
    GRAVITY_RIDGE, LEAST_CHANNEL_ROWS, LEAST_GRAVITY, LEAST_INERTIA, NO_GRAVITY, SHOWS_GRAVITY, SOME_GRAVITY,
};

/// The joints that need torque against gravity and show none, if those that carry much weight show none: the controller reports the torques
/// without what it adds against gravity, or counterweights carry the weight. Gravity in another direction than the model's is gravity.
pub fn without(motions: &Motions, rigid: &[Rigid], scales: &Scales, gravity: &Vector3<f64>) -> Vec<usize> {
    let joints = (0..motions.dof).filter(|&joint| scales.torque[joint] > 0.0);
    let found: Vec<(usize, Shown)> =
        joints.filter_map(|joint| Some((joint, measured(motions, rigid, scales, gravity, joint)?))).collect();
    let loaded = || found.iter().filter(|(_, shown)| shown.weight >= LEAST_GRAVITY);
    let lacks = |shown: &Shown| shown.gravity < NO_GRAVITY && shown.motion > LEAST_INERTIA;
    let is_without = loaded().count() > 1 && loaded().all(|(_, shown)| lacks(shown));
    // A controller that subtracts gravity does so on every joint, also where it is small. Counterweights carry the first links only, and
    // the torque of the others shows gravity.
    let has_none = |shown: &Shown| shown.weight >= SOME_GRAVITY && shown.gravity < SHOWS_GRAVITY;
    let without = found.iter().filter(|(_, shown)| is_without && has_none(shown));
    without.map(|(joint, _)| *joint).collect()
}

/// Why these joints are not diagnosed.
pub const CLAUSE: &str = "the measured torques contain no gravity, although these joints carry weight. Either the controller reports them without the torques that it adds against gravity: record the whole torques, or add the gravity torques of the controller's model to the columns. Or counterweights or springs carry the weight: describe them with --known";

/// What a measured torque shows of gravity, and of inertia with that of the drive, over the model's.
struct Shown {
    /// Standard deviation of the model's gravity torque over that of its whole torque.
    weight: f64,
    gravity: f64,
    motion: f64,
}

/// What the torque of `joint` shows, beside friction and a constant of any size. `None` if it hardly moves, or if gravity does not load
/// it.
fn measured(
    motions: &Motions,
    rigid: &[Rigid],
    scales: &Scales,
    gravity: &Vector3<f64>,
    joint: usize,
) -> Option<Shown> {
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); 8];
    let (mut torque, mut weight, mut needed) = (Vec::new(), Vec::new(), Vec::new());
    let chunks = motions.chunks.iter().zip(rigid);
    for (chunk, rigid) in chunks.filter(|(chunk, _)| !motions.sources[chunk.recording].held_out) {
        let moving: Vec<usize> =
            (0..chunk.rows()).filter(|&row| chunk.qd[joint][chunk.tick_of(row)].abs() > scales.rest[joint]).collect();
        let filtered = |signal: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let values = chunk.filter(&(0..chunk.ticks()).map(signal).collect::<Vec<f64>>());
            moving.iter().map(|&row| values[row]).collect()
        };
        let along = |axis: usize, tick: usize| rigid.gravity[joint][axis][tick];
        let of_weight = |tick: usize| (0..3).map(|axis| gravity[axis] * along(axis, tick)).sum::<f64>();
        let signals: [&dyn Fn(usize) -> f64; 8] = [
            &|tick| along(0, tick),
            &|tick| along(1, tick),
            &|tick| along(2, tick),
            &|tick| rigid.tau[joint][tick] - of_weight(tick),
            &|tick| chunk.qdd[joint][tick],
            &|tick| sign(chunk.qd[joint][tick]),
            &|tick| chunk.qd[joint][tick],
            &|_| 1.0,
        ];
        columns.iter_mut().zip(signals).for_each(|(column, signal)| column.extend(filtered(signal)));
        torque.extend(filtered(&|tick| chunk.tau[joint][tick]));
        weight.extend(filtered(&of_weight));
        needed.extend(filtered(&|tick| rigid.tau[joint][tick]));
    }
    if torque.len() < LEAST_CHANNEL_ROWS || deviation(weight.iter()) == 0.0 {
        return None;
    }
    // Directions in which gravity has little torque are unknown: a ridge leaves them at zero.
    let scale: Vec<f64> =
        columns.iter().map(|column| 1.0 / mean_square(column.iter().copied()).sqrt().max(1e-12)).collect();
    let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / torque.len() as f64;
    let mut gram = DMatrix::from_fn(8, 8, |i, k| scale[i] * scale[k] * inner(&columns[i], &columns[k]));
    (0..8).for_each(|i| gram[(i, i)] += GRAVITY_RIDGE);
    let right = DVector::from_fn(8, |i, _| scale[i] * inner(&columns[i], &torque));
    let solution = gram.cholesky()?.solve(&right);
    let shown = |first: usize, last: usize| -> f64 {
        let at = |row: usize| (first..last).map(|k| scale[k] * solution[k] * columns[k][row]).sum::<f64>();
        deviation((0..torque.len()).map(at).collect::<Vec<f64>>().iter())
    };
    let part = |of: f64, model: f64| if model > 0.0 { of / model } else { 0.0 };
    Some(Shown {
        weight: part(deviation(weight.iter()), deviation(needed.iter())),
        gravity: part(shown(0, 3), deviation(weight.iter())),
        motion: part(shown(3, 5), deviation(columns[3].iter())),
    })
}
