//! Detects torque channels without a torque: dead and idle channels, other quantities, other signals.

use std::ops::Range;

use effects::{Scales, sign};
use nalgebra::{DMatrix, DVector};

use crate::data::input::Input;
use crate::data::measure;
use crate::data::motion::Motions;
use crate::data::rigid::Rigid;
use crate::data::statistics::{deviation, mean_square, quantile_of_sorted};
use crate::thresholds::{
    CHANNEL_FOLDS, CHANNEL_LIMITS, CHANNEL_LOADS, CHANNEL_MOVES, CHANNEL_RIDGE, CHANNEL_STEP, COARSE_CHANNEL,
    COARSE_PART, EXPLAINED_STRETCHES, EXPLAINS_THE_LIMITED, FAR_TOO_SMALL, IDLE_CHANNEL, LEAST_CHANNEL_ROWS, UNRELATED,
};

/// Why a channel holds no torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Why {
    /// It is almost constant while the torques of the model or of other joints vary.
    Dead,
    /// It shows one value in this part of the samples in motion.
    Idle(f64),
    /// It shows only this number of values in nearly all samples in motion.
    Coarse(usize),
    /// Its root mean square is this multiple of the model's.
    FarTooSmall(f64),
    /// Neither the model nor friction, position, weight or masses of any size explain more than this part of its power.
    Unrelated(f64),
}

impl Why {
    /// Why the joint is not diagnosed, as a clause.
    pub fn clause(self) -> String {
        match self {
            Self::Dead => {
                "the measured torque is almost constant while the model's, or that of other joints, varies".to_owned()
            }
            Self::Idle(part) => format!(
                "the torque channel shows one and the same value in {:.0} % of the samples in which the joint moves; it is not a measured torque",
                100.0 * part
            ),
            Self::Coarse(values) => format!(
                "the torque channel shows only {values} different values in nearly all samples in which the joint moves; its steps are too coarse for a diagnosis: record it with finer digits"
            ),
            Self::FarTooSmall(part) => format!(
                "the torque channel is {part:.4} times what the model needs to hold and move the joint; it is not a torque in SI units (is it a current, or a percentage?)"
            ),
            Self::Unrelated(part) => format!(
                "neither masses nor friction of any size explain more than {:.0} % of the torque channel's power; it is not the torque of this joint",
                100.0 * part
            ),
        }
    }
}

/// The joints whose channels hold no torque, with the reason. `scales` give the speeds of the joints and the variation of the
/// channels. What contradicts the model counts only if `by_model`: with wrong signs, every channel may.
pub fn without_torque(
    inputs: &[Input<'_>],
    motions: &Motions,
    rigid: &[Rigid],
    scales: &Scales,
    by_model: bool,
) -> Vec<(usize, Why)> {
    let dead = measure::dead(motions, rigid, &scales.torque);
    let list: Vec<(usize, Why)> = (0..motions.dof)
        .filter_map(|joint| {
            let why = if dead.contains(&joint) {
                Some(Why::Dead)
            } else {
                let of_another_kind = || of_another_kind(motions, rigid, scales, joint);
                idle_or_coarse(inputs, joint).or_else(|| by_model.then(of_another_kind).flatten())
            };
            Some((joint, why?))
        })
        .collect();
    // If no joint is explained, the model is wrong, and not all channels.
    let is_all = list.len() == motions.dof;
    let stays = |(_, why): &(usize, Why)| is_all && matches!(why, Why::Unrelated(_));
    list.into_iter().filter(|one| !stays(one)).collect()
}

/// The first samples that are counted, as a multiple of those that a coarse channel may leave out. Source: nearly all of them are left
/// out by the most frequent values of a channel that is not coarse.
const COUNTED_FIRST: f64 = 3.0;

/// Whether most samples in motion have one value, or nearly all have few.
fn idle_or_coarse(inputs: &[Input<'_>], joint: usize) -> Option<Why> {
    let speed = |input: &Input<'_>, tick: usize| {
        let q = &input.recording.q[joint];
        (q[tick + CHANNEL_STEP] - q[tick - CHANNEL_STEP]).abs() / input.recording.period
    };
    let ticks = |input: &Input<'_>| CHANNEL_STEP..input.recording.len().saturating_sub(CHANNEL_STEP);
    let fitted = || inputs.iter().filter(|input| !input.held_out);
    let largest = fitted().flat_map(|input| ticks(input).map(move |tick| speed(input, tick)));
    let least = CHANNEL_MOVES * largest.fold(0.0, f64::max);
    // −0 equals 0.
    let bits = |input: &Input<'_>, tick: usize| (input.recording.tau[joint][tick] + 0.0).to_bits();
    let moving = |input: &Input<'_>| ticks(input).filter(|&tick| speed(input, tick) > least).collect::<Vec<usize>>();
    let mut values: Vec<u64> =
        fitted().flat_map(|input| moving(input).into_iter().map(|tick| bits(input, tick))).collect();
    let all = values.len();
    if all < LEAST_CHANNEL_ROWS {
        return None;
    }
    if !may_be_few(&values) {
        return None;
    }
    let counts = counts(&mut values);
    let part = |values: usize| counts.iter().take(values).sum::<usize>() as f64 / all as f64;
    if part(1) > IDLE_CHANNEL {
        return Some(Why::Idle(part(1)));
    }
    let values = (1..=counts.len()).find(|&values| part(values) > COARSE_PART)?;
    (values <= COARSE_CHANNEL).then_some(Why::Coarse(values))
}

/// How often each value occurs, the most frequent first.
fn counts(values: &mut [u64]) -> Vec<usize> {
    values.sort_unstable();
    let mut counts: Vec<usize> = values.chunk_by(|a, b| a == b).map(<[u64]>::len).collect();
    counts.sort_unstable_by(|a, b| b.cmp(a));
    counts
}

/// Whether a channel with these values may be idle or coarse: a test without sorting all of them. A value of more than half of all wins
/// a vote in which different values cancel each other, and what few values leave out of the first samples, they leave out of all.
fn may_be_few(values: &[u64]) -> bool {
    let all = values.len() as f64;
    let vote = |(winner, votes): (u64, usize), &value: &u64| match votes {
        0 => (value, 1),
        _ if winner == value => (winner, votes + 1),
        _ => (winner, votes - 1),
    };
    let (winner, _) = values.iter().fold((0, 0), vote);
    let is_idle = values.iter().filter(|&&value| value == winner).count() as f64 > IDLE_CHANNEL * all;
    let first = ((COUNTED_FIRST * (1.0 - COARSE_PART) * all).ceil() as usize).min(values.len());
    let counts = counts(&mut values[..first].to_vec());
    let left_out: usize = counts.iter().skip(COARSE_CHANNEL).sum();
    is_idle || all - left_out as f64 >= COARSE_PART * all
}

/// The moving rows of a joint in the training recordings.
struct Rows {
    /// Measured torque (N m or N).
    torque: Vec<f64>,
    /// The torque of the nominal model (N m or N).
    needed: Vec<f64>,
    /// Columns of friction, a constant and the model.
    plain: Vec<Vec<f64>>,
    /// Further columns: positions, weight and masses of any size.
    more: Vec<Vec<f64>>,
    /// The recording of each row.
    recording: Vec<usize>,
}

impl Rows {
    /// The rows of each recording, in quarters where these have enough.
    fn stretches(&self) -> Vec<Range<usize>> {
        let recordings = self.recording.chunk_by(|a, b| a == b);
        let mut stretches = Vec::new();
        let mut start = 0;
        for rows in recordings.map(<[usize]>::len) {
            let quarter = rows / 4;
            if quarter >= LEAST_CHANNEL_ROWS {
                stretches.extend((0..4).map(|k| start + k * quarter..start + (k + 1) * quarter));
            } else if rows >= LEAST_CHANNEL_ROWS {
                stretches.push(start..start + rows);
            }
            start += rows;
        }
        stretches
    }
}

/// Why the channel is not the joint's torque, judged by the model and by regressions; `None` if it may be.
fn of_another_kind(motions: &Motions, rigid: &[Rigid], scales: &Scales, joint: usize) -> Option<Why> {
    let rows = rows(motions, rigid, scales, joint);
    if rows.torque.len() < LEAST_CHANNEL_ROWS {
        return None;
    }
    let power = |signal: &[f64]| mean_square(signal.iter().copied());
    let size = (power(&rows.torque) / power(&rows.needed).max(f64::MIN_POSITIVE)).sqrt();
    if size < FAR_TOO_SMALL {
        return Some(Why::FarTooSmall(size));
    }
    let all: Vec<&Vec<f64>> = rows.plain.iter().chain(&rows.more).collect();
    let plain: Vec<&Vec<f64>> = rows.plain.iter().collect();
    let error = cross_validated(&plain, &rows.torque).min(cross_validated(&all, &rows.torque));
    let is_limited = || {
        // A drive that reports the torque that is commanded reaches its limit: only the part below the limit moves the joint.
        let mut sizes: Vec<f64> = rows.torque.iter().map(|tau| tau.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let limits = CHANNEL_LIMITS.map(|share| quantile_of_sorted(&sizes, share));
        let clipped = |limit: f64| rows.torque.iter().map(|tau| tau.clamp(-limit, limit)).collect::<Vec<f64>>();
        limits.into_iter().any(|limit| cross_validated(&all, &clipped(limit)) < EXPLAINS_THE_LIMITED)
    };
    // A load that the arm holds in some of the recordings only, or a part of one, is in no sum of the columns over all rows.
    let is_explained_in_stretches = || {
        let judged = |rows_of: Range<usize>| {
            let part = |column: &&Vec<f64>| column[rows_of.clone()].to_vec();
            let columns: Vec<Vec<f64>> = all.iter().map(part).collect();
            let columns: Vec<&Vec<f64>> = columns.iter().collect();
            let torque = &rows.torque[rows_of];
            deviation(torque.iter()) > 0.0 && cross_validated(&columns, torque) < EXPLAINS_THE_LIMITED
        };
        let stretches: Vec<bool> = rows.stretches().into_iter().map(judged).collect();
        let explained = stretches.iter().filter(|is_explained| **is_explained).count();
        explained as f64 > EXPLAINED_STRETCHES * stretches.len() as f64
    };
    (error > UNRELATED && !is_limited() && !is_explained_in_stretches())
        .then(|| Why::Unrelated((1.0 - error * error).max(0.0)))
}

fn rows(motions: &Motions, rigid: &[Rigid], scales: &Scales, joint: usize) -> Rows {
    let mut rows = Rows {
        torque: Vec::new(),
        needed: Vec::new(),
        plain: vec![Vec::new(); 4],
        more: Vec::new(),
        recording: Vec::new(),
    };
    for (chunk, rigid) in motions.chunks.iter().zip(rigid) {
        if motions.sources[chunk.recording].held_out {
            continue;
        }
        let moving: Vec<usize> =
            (0..chunk.rows()).filter(|&row| chunk.qd[joint][chunk.tick_of(row)].abs() > scales.rest[joint]).collect();
        let filtered = |signal: &[f64]| -> Vec<f64> {
            let values = chunk.filter(signal);
            moving.iter().map(|&row| values[row]).collect()
        };
        let (q, qd) = (&chunk.q[joint], &chunk.qd[joint]);
        let of = |signal: &[f64], f: fn(f64) -> f64| -> Vec<f64> {
            filtered(&signal.iter().map(|&value| f(value)).collect::<Vec<f64>>())
        };
        rows.torque.extend(filtered(&chunk.tau[joint]));
        let needed = filtered(&rigid.tau[joint]);
        rows.needed.extend(&needed);
        rows.recording.extend(std::iter::repeat_n(chunk.recording, moving.len()));
        let plain = [needed, of(qd, sign), filtered(qd), vec![1.0; moving.len()]];
        rows.plain.iter_mut().zip(plain).for_each(|(column, values)| column.extend(values));
        let mut more = vec![filtered(q), of(q, f64::sin), of(q, f64::cos), filtered(&chunk.qdd[joint])];
        more.extend(rigid.links[joint].iter().skip(joint).map(|column| filtered(column)));
        more.extend(rigid.gravity[joint].iter().map(|column| filtered(column)));
        more.extend(rigid.payload[joint].iter().take(CHANNEL_LOADS).map(|column| filtered(column)));
        rows.more.resize(more.len(), Vec::new());
        rows.more.iter_mut().zip(more).for_each(|(column, values)| column.extend(values));
    }
    rows
}

/// The cross-validated NRMSE of a least-squares fit of `y` by `columns`: each of [`CHANNEL_FOLDS`] stretches is predicted by the
/// fit of the others and their mean.
fn cross_validated(columns: &[&Vec<f64>], y: &[f64]) -> f64 {
    let n = columns.len();
    let scaled: Vec<f64> =
        columns.iter().map(|column| 1.0 / mean_square(column.iter().copied()).sqrt().max(1e-12)).collect();
    let x = |row: usize| DVector::from_fn(n, |k, _| scaled[k] * columns[k][row]);
    let length = y.len().div_ceil(CHANNEL_FOLDS);
    let folds: Vec<Range<usize>> =
        (0..CHANNEL_FOLDS).map(|fold| (fold * length).min(y.len())..((fold + 1) * length).min(y.len())).collect();
    let sums: Vec<(DMatrix<f64>, DVector<f64>, f64)> = folds
        .iter()
        .map(|fold| {
            let (mut gram, mut right, mut sum) = (DMatrix::zeros(n, n), DVector::zeros(n), 0.0);
            for row in fold.clone() {
                let x = x(row);
                gram.ger(1.0, &x, &x, 1.0);
                right.axpy(y[row], &x, 1.0);
                sum += y[row];
            }
            (gram, right, sum)
        })
        .collect();
    let (mut with, mut without) = (0.0, 0.0);
    for (k, fold) in folds.iter().enumerate() {
        let rest = (0..CHANNEL_FOLDS).filter(|&other| other != k);
        let rows = (y.len() - fold.len()).max(1) as f64;
        let (mut gram, mut right, mut sum) = (DMatrix::identity(n, n) * (CHANNEL_RIDGE * rows), DVector::zeros(n), 0.0);
        for other in rest {
            gram += &sums[other].0;
            right += &sums[other].1;
            sum += sums[other].2;
        }
        let Some(solution) = gram.cholesky().map(|factor| factor.solve(&right)) else {
            return 0.0;
        };
        for row in fold.clone() {
            with += (y[row] - solution.dot(&x(row))).powi(2);
            without += (y[row] - sum / rows).powi(2);
        }
    }
    if without > 0.0 { (with / without).sqrt() } else { 0.0 }
}
