//! The noise of recorded signals: white, held for some samples, or stronger just above the band of the motion.

use std::f64::consts::TAU;

use rayon::prelude::*;
use recording::RegularRecording;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use crate::data::statistics::median;
use crate::thresholds::{LEAST_CHANGES, LEAST_NOISE_BINS, LONGEST_HOLD, NOISE_BAND};

/// The standard deviations of the white noise of a recording's signals, one per joint.
pub struct WhiteNoise {
    /// The noise of the positions (rad or m).
    pub q: Vec<f64>,
    /// The noise of the torques (N m or N).
    pub tau: Vec<f64>,
}

impl WhiteNoise {
    /// The noise of `recording`.
    pub fn of(recording: &RegularRecording) -> Self {
        let of = |signals: &[Vec<f64>]| signals.par_iter().map(|signal| white_noise(signal, recording)).collect();
        Self { q: of(&recording.q), tau: of(&recording.tau) }
    }
}

/// The standard deviation of a signal's white noise: its third differences have 20 times the variance. Of a signal that is held
/// for several samples, one sample each is used.
fn white_noise(signal: &[f64], recording: &RegularRecording) -> f64 {
    let mut squares = Vec::new();
    for segment in &recording.segments {
        let values = &signal[segment.ticks.clone()];
        let present = &recording.present[segment.ticks.clone()];
        let hold = held_for(values);
        for k in 3 * hold..values.len() {
            let at = [k - 3 * hold, k - 2 * hold, k - hold, k];
            if at.iter().all(|&k| present[k]) {
                let [a, b, c, d] = at.map(|k| values[k]);
                squares.push((d - 3.0 * c + 3.0 * b - a).powi(2) / 20.0);
            }
        }
    }
    if squares.is_empty() {
        return 0.0;
    }
    // The mean of the lower nine tenths, because jumps (a reversal, a contact) are not noise. For a normal variable, the
    // mean of the squares up to their 90 % quantile is 0.6245 of the variance.
    let keep = (squares.len() * 9 / 10).max(1);
    if keep < squares.len() {
        squares.select_nth_unstable_by(keep, f64::total_cmp);
        squares.truncate(keep);
    }
    // Sorted, so that the sum does not depend on the order after the selection.
    squares.sort_unstable_by(f64::total_cmp);
    (squares[..keep].iter().sum::<f64>() / keep as f64 / 0.6245).sqrt()
}

/// The number of samples for which a logger holds each value; one if it does not hold them. A slow encoder also repeats its
/// values, but at irregular intervals.
fn held_for(values: &[f64]) -> usize {
    let changes: Vec<usize> = (1..values.len()).filter(|&k| values[k] != values[k - 1]).collect();
    let mut steps: Vec<usize> = changes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.len() < LEAST_CHANGES {
        return 1;
    }
    steps.sort_unstable();
    let usual = steps[steps.len() / 2];
    let same = steps.iter().filter(|&&step| step == usual).count();
    if 2 * same > steps.len() && usual <= LONGEST_HOLD { usual } else { 1 }
}

/// The standard deviation of a white noise with the power of `signal` just above the `cutoff` (Hz). Noise that is not white,
/// such as that of uneven time stamps, is stronger there than at the highest frequencies.
pub fn band_noise(signal: &[f64], recording: &RegularRecording, cutoff: f64) -> f64 {
    let mut strongest = 0.0_f64;
    for segment in &recording.segments {
        let values = &signal[segment.ticks.clone()];
        let n = values.len();
        let bin = 1.0 / (n as f64 * recording.period);
        let (from, to) = ((NOISE_BAND.0 * cutoff / bin) as usize, (NOISE_BAND.1 * cutoff / bin) as usize);
        if to >= n / 2 || to < from + LEAST_NOISE_BINS {
            continue;
        }
        // With the line from end to end subtracted and a Hann window, the motion does not leak into the band.
        let slope = (values[n - 1] - values[0]) / (n - 1) as f64;
        let mut power = 0.0;
        let mut spectrum: Vec<Complex<f64>> = (0..n)
            .map(|k| {
                let window = 0.5 - 0.5 * (TAU * k as f64 / n as f64).cos();
                power += window * window;
                Complex::new(window * (values[k] - values[0] - slope * k as f64), 0.0)
            })
            .collect();
        FftPlanner::new().plan_fft_forward(n).process(&mut spectrum);
        let band = spectrum[from..to].iter().map(Complex::norm_sqr).collect();
        // The median of an exponential distribution is ln 2 of its mean.
        let variance = median(band) / (std::f64::consts::LN_2 * power);
        strongest = strongest.max(variance.sqrt());
    }
    strongest
}
