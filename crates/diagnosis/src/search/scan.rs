//! Suggests candidates from the residual: the time of a contact, the period of a ripple.

use effects::Scales;
use nalgebra::{Matrix3, Vector3};

use crate::data::Data;
use crate::data::motion::Motions;
use crate::regression::fit::Fit;
use crate::regression::small::{FORCE_RIDGE, ForceFit, explained};
use crate::regression::table::Table;
use crate::thresholds::{
    CONTACT_DURATIONS, CONTACT_PIECE, LEAST_RIPPLE_PHASE, MOST_OF_A_RECORDING, MOST_RIPPLE_PERIODS, RIPPLE_SPEED,
};

mod onsets;
mod waves;

pub use onsets::onsets;
pub use waves::waves;

/// The largest number of samples of the coarse scan for ripples.
const MOST_SAMPLES: usize = 6000;

/// The residual of every joint's y on all rows.
pub fn residuals(table: &Table, fit: &Fit) -> Vec<Vec<f64>> {
    (0..table.dof()).map(|joint| table.residual(joint, &fit.columns, &fit.coefficients)).collect()
}

/// The windows (s) in which a force on the tool explains most of the residual, best first; `force` are the columns of a force
/// that always acts.
pub fn contacts(
    table: &Table,
    times: &[f64],
    residual: &[Vec<f64>],
    weights: &[f64],
    force: [usize; 3],
    fitted: &[bool],
    most: usize,
) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64, f64)> = Vec::new();
    for (recording, rows) in table.rows.iter().enumerate() {
        if !fitted[recording] || rows.len() < 10 {
            continue;
        }
        // Sums from the first row on: the matrix (6), the right side (3).
        let mut sums = vec![[0.0; 9]; rows.len() + 1];
        for (k, row) in rows.clone().enumerate() {
            let mut sum = sums[k];
            for joint in 0..table.dof() {
                let this = &table.joints[joint];
                if !this.moving[row] {
                    continue;
                }
                let w = weights[joint];
                let x = force.map(|column| table.place[joint][column].map_or(0.0, |place| this.x[place][row]));
                let r = residual[joint][row];
                let products = [
                    x[0] * x[0],
                    x[0] * x[1],
                    x[0] * x[2],
                    x[1] * x[1],
                    x[1] * x[2],
                    x[2] * x[2],
                    x[0] * r,
                    x[1] * r,
                    x[2] * r,
                ];
                for (sum, product) in sum.iter_mut().zip(products) {
                    *sum += w * product;
                }
            }
            sums[k + 1] = sum;
        }
        let step = (times[rows.end - 1] - times[rows.start]) / (rows.len() - 1) as f64;
        let most = MOST_OF_A_RECORDING * step * rows.len() as f64;
        let usual = trace(&sums[rows.len()]) / rows.len() as f64;
        for duration in CONTACT_DURATIONS.into_iter().filter(|&duration| duration <= most) {
            let length = ((duration / step).round() as usize).max(3);
            let hop = (length / 5).max(1);
            let least = LEAST_FELT * usual * length as f64;
            let mut from = 0;
            while from + length <= rows.len() {
                let gain = force_gain(&sums[from], &sums[from + length], least);
                found.push((gain, times[rows.start + from], times[rows.start + from + length - 1]));
                from += hop;
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)));
    let mut best: Vec<(f64, f64)> = Vec::new();
    for &(_, from, to) in &found {
        if best.len() == most {
            break;
        }
        let overlaps = best.iter().any(|&(a, b)| from < b && a < to);
        if !overlaps {
            best.push((from, to));
        }
    }
    best
}

/// The least power of a force in a window, as a part of its usual power. Below it, only joints move through whose axes the force passes, and
/// the sums hold rounding. Source: a window on a simulated arm with a part of 1e-20.
const LEAST_FELT: f64 = 1e-6;

/// What a force on the tool explains between two sums; nothing if its power is below `least`.
fn force_gain(before: &[f64; 9], after: &[f64; 9], least: f64) -> f64 {
    let d: [f64; 9] = std::array::from_fn(|k| after[k] - before[k]);
    if trace(&d) <= least {
        return 0.0;
    }
    let matrix = Matrix3::new(d[0], d[1], d[2], d[1], d[3], d[4], d[2], d[4], d[5]);
    explained(matrix, &Vector3::new(d[6], d[7], d[8]), FORCE_RIDGE)
}

/// The trace of the matrix in sums.
fn trace(sums: &[f64; 9]) -> f64 {
    sums[0] + sums[3] + sums[5]
}

/// The numbers of periods (rad of phase per rad or m) of a ripple on `joint` that explain most of its residual: peaks, best
/// first.
pub fn ripples(
    table: &Table,
    motions: &Motions,
    scales: &Scales,
    joint: usize,
    residual: &[f64],
    fitted: &[bool],
    most: usize,
) -> Vec<f64> {
    let range = scales.range[joint].max(1e-6);
    let samples = samples(table, motions, joint, residual, fitted);
    // The gain of the filter at the usual speed.
    let usual = RIPPLE_SPEED * scales.speed[joint];
    let most_periods = (2.0 * std::f64::consts::PI * motions.cutoff / usual).min(MOST_RIPPLE_PERIODS);
    let step = 1.5 / range;
    let least = LEAST_RIPPLE_PHASE / scales.swept[joint].clamp(1e-6, range);
    let at = |samples: &[Sample], periods: f64| {
        power(samples, |sample| {
            // The filter weakens fast ripples.
            let gain = motions.chunks[0].kernel.gain(periods * sample.qd);
            (gain * (periods * sample.q).sin(), gain * (periods * sample.q).cos())
        })
    };
    let count = ((most_periods - least) / step).ceil().max(0.0) as usize;
    let every = samples.len().div_ceil(MOST_SAMPLES).max(1);
    let coarse: Vec<Sample> = samples.iter().step_by(every).copied().collect();
    let values = spectrum(&coarse, motions.chunks[0].kernel.width(), least, step, count);
    // A maximum at the lower end is that of a slower function of the position, and takes no other's place.
    let mut found = peaks(least, step, &values, most + 1, |periods| at(&samples, periods));
    found.retain(|&periods| periods >= least);
    found.truncate(most);
    found
}

#[derive(Clone, Copy)]
struct Sample {
    time: f64,
    q: f64,
    qd: f64,
    residual: f64,
}

fn samples(table: &Table, motions: &Motions, joint: usize, residual: &[f64], fitted: &[bool]) -> Vec<Sample> {
    let mut samples = Vec::new();
    let mut row = 0;
    for chunk in &motions.chunks {
        for k in 0..chunk.rows() {
            let tick = chunk.tick_of(k);
            if fitted[chunk.recording] && table.joints[joint].moving[row] {
                samples.push(Sample {
                    time: chunk.time(tick),
                    q: chunk.q[joint][tick],
                    qd: chunk.qd[joint][tick],
                    residual: residual[row],
                });
            }
            row += 1;
        }
    }
    samples
}

/// The number of successive entries of a [`spectrum`] that are computed by multiplication before sines and exponentials are
/// evaluated again.
const MULTIPLIED: usize = 32;

/// The powers that ripples explain at `count` numbers of periods from `least` on, in steps of `step`, after a filter of a
/// `width` (s). The gain e^(−a p²) at p = p₀ + j s follows from that at p₀ by the factors e^(−2 a p₀ s)ʲ and e^(−a s² j²),
/// and the sine by a rotation.
fn spectrum(samples: &[Sample], width: f64, least: f64, step: f64, count: usize) -> Vec<f64> {
    let mut sums = vec![[[0.0; MULTIPLIED]; 5]; count.div_ceil(MULTIPLIED)];
    let lanes = std::array::from_fn::<f64, MULTIPLIED, _>(|j| j as f64);
    for sample in samples {
        let a = 0.5 * (width * sample.qd).powi(2);
        let turns = lanes.map(|j| (j * step * sample.q).sin_cos());
        let bend = lanes.map(|j| (-a * (step * j).powi(2)).exp());
        for (block, [ss, sc, cc, sr, cr]) in sums.iter_mut().enumerate() {
            let from = least + step * (block * MULTIPLIED) as f64;
            let first = (-a * from * from).exp();
            if first < NOTHING {
                break;
            }
            let (sine, cosine) = (from * sample.q).sin_cos();
            let slope = powers((-2.0 * a * from * step).exp());
            for j in 0..MULTIPLIED {
                let periods = from + step * lanes[j];
                // The gain of the filter.
                let gain = (1.0 + a * periods * periods) * (first * slope[j] * bend[j]);
                let (turned, along) = turns[j];
                let s = gain * (sine * along + cosine * turned);
                let c = gain * (cosine * along - sine * turned);
                ss[j] += s * s;
                sc[j] += s * c;
                cc[j] += c * c;
                sr[j] += s * sample.residual;
                cr[j] += c * sample.residual;
            }
        }
    }
    let at = |k: usize| {
        let [ss, sc, cc, sr, cr] = sums[k / MULTIPLIED].map(|sums| sums[k % MULTIPLIED]);
        explained_by_two(ss, sc, cc, sr, cr)
    };
    (0..count).map(at).collect()
}

/// Gains below this count as zero.
const NOTHING: f64 = 1e-30;

/// The powers of a number, from one on.
fn powers(base: f64) -> [f64; MULTIPLIED] {
    let mut powers = [1.0; MULTIPLIED];
    for j in 1..4 {
        powers[j] = powers[j - 1] * base;
    }
    let fourth = powers[3] * base;
    for j in 4..MULTIPLIED {
        powers[j] = powers[j - 4] * fourth;
    }
    powers
}

/// The part of the residual's power that a sine and a cosine explain.
fn power(samples: &[Sample], pair: impl Fn(&Sample) -> (f64, f64)) -> f64 {
    let (mut ss, mut sc, mut cc, mut sr, mut cr) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for sample in samples {
        let (s, c) = pair(sample);
        ss += s * s;
        sc += s * c;
        cc += c * c;
        sr += s * sample.residual;
        cr += c * sample.residual;
    }
    explained_by_two(ss, sc, cc, sr, cr)
}

/// The part that two columns with these inner products explain.
fn explained_by_two(ss: f64, sc: f64, cc: f64, sr: f64, cr: f64) -> f64 {
    let determinant = ss * cc - sc * sc;
    if determinant <= 1e-9 * (ss + cc).powi(2) {
        return 0.0;
    }
    (cc * sr * sr - 2.0 * sc * sr * cr + ss * cr * cr) / determinant
}

/// The highest local maxima of `values`, on a grid that begins at `from`; refined on `f` by golden-section search.
fn peaks(from: f64, step: f64, values: &[f64], most: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let count = values.len();
    let at = |k: usize| from + step * k as f64;
    let mut tops: Vec<(f64, f64)> = (0..count)
        .filter(|&k| (k == 0 || values[k] >= values[k - 1]) && (k + 1 == count || values[k] > values[k + 1]))
        .map(|k| (values[k], at(k)))
        .collect();
    tops.sort_by(|a, b| b.0.total_cmp(&a.0));
    tops.truncate(most);
    tops.iter().map(|&(_, x)| golden(x - step, x + step, &f)).collect()
}

/// The maximum of `f` between two places, by golden-section search.
pub fn golden(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    for _ in 0..14 {
        if fa > fb {
            (high, b, fb) = (b, a, fa);
            a = high - ratio * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + ratio * (high - low);
            fb = f(b);
        }
    }
    0.5 * (low + high)
}

/// The relative reduction of the residual `without` a contact in its window: its force is fitted to every other piece of
/// the window and tested on the rest.
pub fn contact_gain(data: &Data, table: &Table, without: &Fit, columns: &[usize]) -> f64 {
    let residual = residuals(table, without);
    let times = data.motions.row_times();
    let mut fit = ForceFit::default();
    for row in table.rows_of(|recording| data.fitted[recording]) {
        let piece = ((times[row] - data.motions.begins) / CONTACT_PIECE).floor() as i64;
        for joint in 0..table.dof() {
            let this = &table.joints[joint];
            let mut x = Vector3::zeros();
            for (value, &column) in x.iter_mut().zip(columns) {
                *value = table.place[joint][column].map_or(0.0, |place| this.x[place][row]);
            }
            if !this.moving[row] || x.iter().all(|&v| v == 0.0) {
                continue;
            }
            fit.add(piece % 2 == 0, without.weights[joint], residual[joint][row], x);
        }
    }
    let Some((_, [before, after])) = fit.solved() else {
        return 0.0;
    };
    if before > 0.0 { 1.0 - (after / before).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In a window in which only a joint moves through whose axis the force passes, rounding leaves a part of the right side and
    /// nothing of the matrix.
    #[test]
    fn a_force_that_no_joint_feels_explains_nothing() {
        let before = [1e8, 0.0, 0.0, 1e8, 0.0, 1e8, 1e-3, 0.0, 0.0];
        let mut after = before;
        after[6] += 1e-18;
        assert!(force_gain(&before, &after, 0.0) == 0.0);
        after[6] = 2e-3;
        assert!(force_gain(&before, &after, 1.0) == 0.0);
        after[0] += 1e4;
        assert!(force_gain(&before, &after, 1.0) > 0.0);
    }
}
