//! Single samples far from their neighbours: wrong readings that are not part of the motion.
//!
//! A sample is compared with the cubic through its four neighbours. A spike has a large residual, and its neighbours
//! have small ones once it is replaced. A step (a contact, a friction reversal) is not a spike, because the samples on
//! its other side keep large residuals, and neither is anything that lasts two samples.

use crate::interpolate::lagrange;

/// The smallest ratio of a spike to the local noise.
const LOCAL: f64 = 12.0;
/// The smallest ratio of a spike to the residual that 98 % of the samples do not exceed.
const TAIL: f64 = 6.0;
/// The smallest ratio of a spike to the quantiser's step.
const STEPS: f64 = 8.0;
/// The largest residual of a spike's neighbours once it is replaced, as a share of the spike.
const NEIGHBOUR: f64 = 0.25;
/// The smallest spike, as a share of the signal's range.
const RANGE: f64 = 0.01;
/// The number of samples from which the local noise is computed.
const WINDOW: usize = 64;
/// If a larger share of the samples are spikes, they are a property of the signal.
const MOST: f64 = 0.005;

/// A spike that was replaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spike {
    /// Its sample.
    pub row: usize,
    /// Its distance from the interpolated value.
    pub height: f64,
}

/// Each sample's distance from the cubic through its four neighbours; the two at each end have none (0).
pub fn residuals(places: &[f64], values: &[f64]) -> Vec<f64> {
    let mut off = vec![0.0; values.len()];
    for k in 2..values.len().saturating_sub(2) {
        off[k] = values[k] - predicted(places, values, k);
    }
    off
}

fn predicted(places: &[f64], v: &[f64], k: usize) -> f64 {
    let even = (places[k + 2] - places[k - 2] - 4.0).abs() < 1e-9;
    if even {
        (4.0 * (v[k - 1] + v[k + 1]) - v[k - 2] - v[k + 2]) / 6.0
    } else {
        let nodes = [k - 2, k - 1, k + 1, k + 2].map(|row| (places[row], v[row]));
        lagrange(&nodes, places[k])
    }
}

/// Replaces the spikes in `values` (one piece of a signal, at `places` in ticks) and returns them.
pub fn remove(places: &[f64], values: &mut [f64]) -> Vec<Spike> {
    let count = values.len();
    if count < 16 {
        return Vec::new();
    }
    let off = residuals(places, values);
    let mut sizes: Vec<f64> = off.iter().map(|off| off.abs()).collect();
    let tail = *sizes.select_nth_unstable_by(count * 98 / 100, f64::total_cmp).1;
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    // In a short piece, a sixth of the samples are affected by one spike: rounding must not decide such a tie.
    let floor = (TAIL * tail * (1.0 - 1e-9)).max(RANGE * (high - low)).max(STEPS * smallest_step(values));
    let mut spikes: Vec<Spike> = Vec::new();
    for k in 3..count.saturating_sub(3) {
        // Few samples reach this point, so that the following may take longer.
        if off[k].abs() <= floor || off[k].abs() <= LOCAL * local_noise(&off, k) {
            continue;
        }
        let (before, after) = (values[k] - values[k - 1], values[k] - values[k + 1]);
        let stands_out = before.signum() == after.signum() && before.abs().min(after.abs()) > 0.5 * off[k].abs();
        let spoiled = spikes.last().is_some_and(|last| k - last.row < 4);
        if !stands_out || spoiled {
            continue;
        }
        let seen = values[k];
        values[k] = predicted(places, values, k);
        let quiet = [k - 1, k + 1]
            .into_iter()
            .all(|near| (values[near] - predicted(places, values, near)).abs() < NEIGHBOUR * off[k].abs());
        if quiet {
            spikes.push(Spike { row: k, height: seen - values[k] });
        } else {
            values[k] = seen;
        }
    }
    if spikes.len() as f64 > (MOST * count as f64).max(2.0) {
        for spike in &spikes {
            values[spike.row] += spike.height;
        }
        spikes.clear();
    }
    spikes
}

/// The noise of the residuals around sample `k`, without the sample itself and those that it affects.
fn local_noise(off: &[f64], k: usize) -> f64 {
    let around = k.saturating_sub(WINDOW)..(k + WINDOW).min(off.len());
    let mut sizes: Vec<f64> = around.filter(|&row| row.abs_diff(k) > 2).map(|row| off[row].abs()).collect();
    let middle = sizes.len() / 2;
    if sizes.is_empty() {
        return 0.0;
    }
    1.4826 * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The smallest difference between neighbours that is larger than rounding.
fn smallest_step(values: &[f64]) -> f64 {
    let size = values.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    let stride = (values.len() / 20_000).max(1);
    let steps = values.windows(2).step_by(stride).map(|pair| (pair[1] - pair[0]).abs());
    let smallest = steps.filter(|&step| step > 1e-9 * size).fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(count: usize) -> Vec<f64> {
        (0..count).map(|k| k as f64).collect()
    }

    fn noise(k: usize) -> f64 {
        ((k as f64 * 12.9898).sin() * 43_758.547).fract()
    }

    #[test]
    fn spikes_are_taken_out_and_nothing_else() {
        let clean: Vec<f64> = (0..2000).map(|k| (k as f64 * 0.01).sin() + 1e-4 * noise(k)).collect();
        let mut values = clean.clone();
        values[400] += 0.3;
        values[1200] -= 0.05;
        let mut at = places(2001);
        at.remove(402);
        let spikes = remove(&at, &mut values);
        assert_eq!(spikes.iter().map(|spike| spike.row).collect::<Vec<_>>(), [400, 1200]);
        assert!((spikes[0].height - 0.3).abs() < 0.02);
        // The neighbour of the spike is shifted by one tick, which makes little difference on a smooth sine.
        assert!((values[1200] - clean[1200]).abs() < 1e-3);
        assert!(remove(&places(2000), &mut clean.clone()).is_empty());
    }

    /// Of two spikes in 350 samples, the larger is exactly six times the residual that 98 % of the samples do not
    /// exceed.
    #[test]
    fn a_tie_is_not_decided_by_rounding() {
        for scale in (1..200).map(|k| 0.37 * f64::from(k)) {
            let mut values: Vec<f64> = (0..350).map(|k| scale * (f64::from(k) * 0.01).sin()).collect();
            values[40] -= 8.0 * scale;
            values[222] += 2.5 * scale;
            let spikes = remove(&places(350), &mut values);
            assert_eq!(spikes.iter().map(|spike| spike.row).collect::<Vec<_>>(), [40], "{scale}");
        }
    }

    #[test]
    fn steps_pulses_stops_and_quantised_signals_are_no_spikes() {
        let signal = |f: &dyn Fn(usize) -> f64| (0..3000).map(f).collect::<Vec<f64>>();
        let cases = [
            signal(&|k| if k > 1500 { 5.0 } else { 0.0 } + 0.01 * noise(k)),
            signal(&|k| if (700..702).contains(&k) { 5.0 } else { 0.01 * noise(k) }),
            signal(&|k| ((k as f64 * 0.003).sin() / 5e-5).round() * 5e-5),
            signal(&|k| if k > 1000 && k < 1010 { 5e-5 } else { 0.0 }),
            signal(&|k| if k == 1000 { 5e-5 } else { 0.0 }),
            signal(&|k| 3.0 * (k as f64 * 0.01).sin().signum() + 0.1 * noise(k)),
            signal(&|k| (5.0 - 0.02 * k.abs_diff(1500) as f64).max(0.0)),
        ];
        for (index, case) in cases.into_iter().enumerate() {
            assert_eq!(remove(&places(3000), &mut case.clone()), [], "case {index}");
        }
    }
}
