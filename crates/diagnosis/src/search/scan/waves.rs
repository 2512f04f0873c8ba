//! Sinusoids in time, found by a periodogram of unevenly spaced samples.

use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use super::{Sample, explained_by_two, peaks, power, samples};
use crate::data::motion::Motions;
use crate::regression::table::Table;
use crate::thresholds::{WAVE_CUTOFF, WAVE_FREQUENCIES};

/// The number of bins per period of the highest frequency; each sample goes to the nearest bin.
const BINS: f64 = 8.0;
/// The longest time in which sinusoids are searched (s). The transform grows with it, and recordings may be days apart.
const LONGEST: f64 = 10_000.0;

/// The frequencies (rad/s) of sinusoids in time that explain most of the residual of `joint`: peaks, best first.
///
/// The least-squares periodogram of Lomb (1976), its sums by one Fourier transform of binned samples (after Press and
/// Rybicki 1989); the peaks are then refined on the samples themselves.
pub fn waves(
    table: &Table,
    motions: &Motions,
    joint: usize,
    residual: &[f64],
    fitted: &[bool],
    most: usize,
) -> Vec<f64> {
    let samples = densest(samples(table, motions, joint, residual, fitted));
    let Some(first) = samples.iter().map(|sample| sample.time).reduce(f64::min) else {
        return Vec::new();
    };
    let last = samples.iter().fold(first, |last, sample| last.max(sample.time));
    let span = (last - first).max(1.0);
    let (low, high) = (TAU * WAVE_FREQUENCIES.0, TAU * WAVE_FREQUENCIES.1.min(WAVE_CUTOFF * motions.cutoff));
    if high <= low {
        return Vec::new();
    }
    let bin = TAU / (BINS * high);
    // Frequencies no further apart than 2 rad over the span.
    let size = (TAU * span / (2.0 * bin)).ceil() as usize;
    let size = size.max((span / bin) as usize + 1).next_power_of_two();
    // Residuals and ones in one transform: both are real.
    let mut bins = vec![Complex::new(0.0, 0.0); size];
    for sample in &samples {
        bins[(((sample.time - first) / bin).round() as usize).min(size - 1)] += Complex::new(sample.residual, 1.0);
    }
    FftPlanner::new().plan_fft_forward(size).process(&mut bins);
    let step = TAU / (size as f64 * bin);
    let n = samples.len() as f64;
    let at = |k: usize| -> f64 {
        let (z, mirrored) = (bins[k], bins[size - k].conj());
        let residual = (z + mirrored) / 2.0;
        let (z, mirrored) = (bins[2 * k], bins[size - 2 * k].conj());
        let ones = (z - mirrored) / Complex::new(0.0, 2.0);
        let (ss, sc, cc) = ((n - ones.re) / 2.0, -ones.im / 2.0, (n + ones.re) / 2.0);
        explained_by_two(ss, sc, cc, -residual.im, residual.re)
    };
    let from = ((low / step) as usize).max(1);
    let to = ((high / step).ceil() as usize).min(size / 2 - 1);
    let values: Vec<f64> = (from..=to).map(at).collect();
    peaks(from as f64 * step, step, &values, most, |omega| {
        power(&samples, |sample| ((omega * sample.time).sin(), (omega * sample.time).cos()))
    })
}

/// All samples, or those of the window of length [`LONGEST`] that has the most samples.
fn densest(samples: Vec<Sample>) -> Vec<Sample> {
    let mut times: Vec<f64> = samples.iter().map(|sample| sample.time).collect();
    times.sort_by(f64::total_cmp);
    let count = |from: usize| times.partition_point(|time| *time <= times[from] + LONGEST) - from;
    // Of windows with equally many samples, the first one.
    let Some(from) = (0..times.len()).rev().max_by_key(|&from| count(from)) else {
        return samples;
    };
    let span = times[from]..=times[from] + LONGEST;
    samples.into_iter().filter(|sample| span.contains(&sample.time)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_densest_hours_of_several_days_are_searched() {
        let at = |time: f64| Sample { time, q: 0.0, qd: 0.0, residual: 1.0 };
        let day = 86_400.0;
        let times = [0.0, 10.0, day, day + 10.0, day + 9000.0, 400.0 * day];
        let kept: Vec<f64> = densest(times.map(at).into()).iter().map(|sample| sample.time).collect();
        assert_eq!(kept, times[2..5]);
        let short = [5.0, 3.0, 9000.0];
        let kept: Vec<f64> = densest(short.map(at).into()).iter().map(|sample| sample.time).collect();
        assert_eq!(kept, short);
    }
}
