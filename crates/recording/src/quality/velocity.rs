//! The slopes of the positions, compared with the recorded velocity.

use super::JointQuality;
use super::measures::{self, inner};
use super::slopes::Slopes;
use crate::RegularRecording;

/// The longest lag that is considered, in s and in ticks.
const LONGEST_LAG: f64 = 0.1;
const MOST_TICKS: usize = 80;
/// The largest number of samples of a correlation.
const SAMPLES: usize = 20_000;

/// The correlation of two signals over `ticks`, the second one delayed by `lag`, and the slope of the second with
/// respect to the first.
fn correlate(first: &[f64], second: &[f64], ticks: &[usize], lag: isize) -> (f64, f64) {
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for &tick in ticks {
        let (x, y) = (first[tick], second[tick.wrapping_add_signed(lag)]);
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    if xx > 0.0 && yy > 0.0 { (xy / (xx * yy).sqrt(), xy / xx) } else { (0.0, 0.0) }
}

/// The largest correlation at any lag up to ±`limit`.
fn likeness(first: &[f64], second: &[f64], ticks: &[usize], limit: isize) -> f64 {
    let at = |lag: isize| correlate(first, second, ticks, lag).0.abs();
    (-limit..=limit).map(at).fold(0.0, f64::max)
}

/// Compares the recorded velocities with the slopes of the positions and writes the result to `joints`; returns pairs
/// of joints (position, velocity) whose velocities are exchanged.
pub fn compare(regular: &RegularRecording, motions: &[Slopes], joints: &mut [JointQuality]) -> Vec<(usize, usize)> {
    let Some(qd) = &regular.qd else { return Vec::new() };
    let reach = ((LONGEST_LAG / regular.period) as usize).clamp(4, MOST_TICKS);
    let Some(side) = motions.first().map(|motion| motion.side + reach) else {
        return Vec::new();
    };
    let mut ticks: Vec<usize> = inner(&regular.segments, side).collect();
    let stride = (ticks.len() / SAMPLES).max(1);
    ticks = ticks.into_iter().step_by(stride).collect();
    if ticks.len() < 50 {
        return Vec::new();
    }
    let mut swapped = Vec::new();
    for (joint, motion) in motions.iter().enumerate() {
        if !joints[joint].moves {
            continue;
        }
        let at = |lag: isize| correlate(&motion.speed, &qd[joint], &ticks, lag);
        let limit = reach as isize;
        let best = (-limit..=limit).fold(0, |best: isize, lag| {
            let better = at(lag).0.abs() > at(best).0.abs();
            if better { lag } else { best }
        });
        let (correlation, ratio) = at(best);
        joints[joint].velocity_correlation = Some(correlation);
        if correlation.abs() > 0.8 && best.abs() < limit {
            // The peak of the parabola through three correlations.
            let (before, after) = (at(best - 1).0.abs(), at(best + 1).0.abs());
            let bend = before - 2.0 * correlation.abs() + after;
            let part = if bend < 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
            joints[joint].velocity_lag = Some((best as f64 + part) * regular.period);
            joints[joint].velocity_ratio = Some(ratio);
        }
        if correlation.abs() < 0.9 {
            let other = (0..qd.len())
                .filter(|&other| other != joint)
                .map(|other| (other, likeness(&motion.speed, &qd[other], &ticks, limit)))
                .max_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((other, found)) = other
                && found > 0.95
            {
                swapped.push((joint, other));
            }
        }
    }
    for (joint, quality) in joints.iter_mut().enumerate() {
        quality.qd_noise = Some(measures::noise(&qd[joint], &regular.segments));
    }
    swapped
}
