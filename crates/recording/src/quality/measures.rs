//! Properties of one signal: its range, noise, quantiser and plateaus.

use crate::Segment;
use crate::statistics::quantile;

/// The largest number of samples of an estimate.
pub const SAMPLES: usize = 100_000;

/// The smallest and the largest value.
pub fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)))
}

/// Ticks with `side` neighbours on both sides in their segment, evenly thinned to [`SAMPLES`].
pub fn inner(segments: &[Segment], side: usize) -> impl Iterator<Item = usize> + '_ {
    let total: usize = segments.iter().map(|segment| segment.ticks.len()).sum();
    let stride = (total / SAMPLES).max(1);
    segments
        .iter()
        .flat_map(move |segment| (segment.ticks.start + side..segment.ticks.end.saturating_sub(side)).step_by(stride))
}

/// The standard deviation of the white noise in a signal, from its distance to the cubic through four neighbours.
pub fn noise(values: &[f64], segments: &[Segment]) -> f64 {
    let mut off: Vec<f64> = inner(segments, 2)
        .map(|k| (values[k] - (4.0 * (values[k - 1] + values[k + 1]) - values[k - 2] - values[k + 2]) / 6.0).abs())
        .collect();
    // For white noise, the variance of the distance is (1 + 34/36) times that of the noise.
    let white = (1.0_f64 + 34.0 / 36.0).sqrt();
    let middle = 1.4826 * quantile(&mut off, 0.5);
    if middle > 0.0 {
        return middle / white;
    }
    // A quantised signal may be at rest for half of the time: the mean without the largest 5 %.
    let high = quantile(&mut off, 0.95);
    let below: Vec<f64> = off.into_iter().filter(|&off| off <= high).collect();
    let squares: f64 = below.iter().map(|off| off * off).sum();
    (squares / below.len().max(1) as f64).sqrt() / white
}

/// The step of the quantiser, if the signal's values are multiples of one.
pub fn step(values: &[f64]) -> Option<f64> {
    let stride = (values.len() / 20_000).max(1);
    let (low, high) = range(values);
    let size = low.abs().max(high.abs());
    let mut steps: Vec<f64> = values
        .windows(2)
        .step_by(stride)
        .map(|pair| (pair[1] - pair[0]).abs())
        .filter(|&step| step > 1e-9 * size)
        .collect();
    if steps.len() < 20 {
        return None;
    }
    steps.sort_by(f64::total_cmp);
    let least = 1e-7 * (high - low);
    // The smallest difference may be several steps.
    (1..=6).find_map(|part| multiples(&steps, steps[0] / f64::from(part))).filter(|step| *step > least)
}

/// The step near `step` that sorted `steps` are multiples of, if all but a few are.
fn multiples(steps: &[f64], mut step: f64) -> Option<f64> {
    const MOST: f64 = 1000.0;
    // Larger differences determine the step more precisely.
    for within in [3.0, 10.0, 30.0, 100.0, 300.0, MOST] {
        let (mut sum, mut count) = (0.0, 0.0);
        for other in steps.iter().take_while(|other| **other < within * step) {
            sum += other;
            count += (other / step).round();
        }
        if count > 0.0 {
            step = sum / count;
        }
    }
    let near = steps.partition_point(|other| *other < MOST * step);
    let off = |other: &f64| (other / step - (other / step).round()).abs();
    let fits = steps[..near].iter().filter(|other| off(other) < 0.05).count();
    (near >= 30 && fits as f64 > 0.95 * near as f64).then_some(step)
}

/// The share of the samples at an extreme value, if the signal remains there: `(value, share)` of the smallest and the
/// largest.
pub fn plateaus(values: &[f64], segments: &[Segment], step: Option<f64>) -> [Option<(f64, f64)>; 2] {
    let (low, high) = range(values);
    let near = (1e-6 * (high - low)).max(0.5 * step.filter(|step| *step < 0.02 * (high - low)).unwrap_or(0.0));
    let on = |extreme: f64| {
        let (mut count, mut longest) = (0, 0);
        for segment in segments {
            let mut run = 0;
            for &value in &values[segment.ticks.clone()] {
                run = if (value - extreme).abs() <= near { run + 1 } else { 0 };
                count += usize::from(run > 0);
                longest = longest.max(run);
            }
        }
        let share = count as f64 / values.len().max(1) as f64;
        (high > low && longest >= 5 && share > 2e-3).then_some((extreme, share))
    };
    [on(low), on(high)]
}
