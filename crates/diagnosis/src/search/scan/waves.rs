//! Sinusoids in time, found by a periodogram of unevenly spaced samples.

use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use super::{explained_by_two, peaks, power, samples};
use crate::data::motion::Motions;
use crate::regression::table::Table;
use crate::thresholds::{WAVE_CUTOFF, WAVE_FREQUENCIES};

/// The number of bins per period of the highest frequency; each sample goes to the nearest bin.
const BINS: f64 = 8.0;

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
    let samples = samples(table, motions, joint, residual, fitted);
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return Vec::new();
    };
    let span = (last.time - first.time).max(1.0);
    let (low, high) = (
        TAU * WAVE_FREQUENCIES.0,
        TAU * WAVE_FREQUENCIES.1.min(WAVE_CUTOFF * motions.cutoff),
    );
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
        bins[(((sample.time - first.time) / bin).round() as usize).min(size - 1)] += Complex::new(sample.residual, 1.0);
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
        power(&samples, |sample| {
            ((omega * sample.time).sin(), (omega * sample.time).cos())
        })
    })
}
