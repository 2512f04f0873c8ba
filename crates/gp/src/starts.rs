//! The starts of the likelihood search, and its bounds.

use crate::data::TrainingSet;
use crate::options::LengthScales;

/// Length scales of the starts, as multiples of the scales of the data.
pub(crate) const LENGTH_FACTORS: [f64; 7] = [0.025, 0.1, 0.4, 1.5, 6.0, 24.0, 96.0];

/// Relative noises of the starts: noise variance / amplitude².
pub(crate) const RELATIVE_NOISES: [f64; 4] = [0.0, 1e-8, 1e-4, 1e-1];

/// The number of pairs of samples whose median distance is computed.
const PAIRS: usize = 1000;

/// The scales of the data, of which the initial length scales are multiples.
///
/// Isotropic: the median distance between samples. One per input: either the median distance for every input, or each
/// input's standard deviation times √dim. A constant input gets the overall scale; the likelihood does not depend on
/// it.
pub(crate) fn shapes(training: &TrainingSet, lengths: LengthScales) -> Vec<Vec<f64>> {
    let median = median_distance(training);
    match lengths {
        LengthScales::Isotropic => vec![vec![median]],
        LengthScales::PerInput => {
            let dim = training.dim();
            let deviations = (0..dim).map(|d| {
                let scale = standard_deviation(training, d) * (dim as f64).sqrt();
                if scale > 0.0 { scale } else { median }
            });
            vec![deviations.collect(), vec![median; dim]]
        }
    }
}

fn standard_deviation(training: &TrainingSet, d: usize) -> f64 {
    let n = training.samples() as f64;
    let column = || (0..training.samples()).map(|i| training.row(i)[d]);
    let mean = column().sum::<f64>() / n;
    (column().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// Median distance over pairs of samples taken at a fixed stride; 1 if all samples coincide.
fn median_distance(training: &TrainingSet) -> f64 {
    let n = training.samples();
    let mut distances: Vec<f64> = (0..PAIRS)
        .map(|t| {
            // A stride that does not divide n pairs near samples and distant ones equally.
            let i = t * 7919 % n;
            let j = (i + 1 + t * 104_729 % n.max(2).saturating_sub(1)) % n;
            let pairs = training.row(i).iter().zip(training.row(j));
            pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        })
        .filter(|distance| *distance > 0.0)
        .collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied().unwrap_or(1.0)
}

/// Bounds on the logarithms of length scales and relative noise, kept by a smooth change of variable:
/// bounded = middle + half tanh((free - middle) / half), close to the identity except near the bounds.
pub(crate) struct Bounds {
    middles: Vec<f64>,
    halves: Vec<f64>,
}

impl Bounds {
    /// Lengths from 1e-4 to 1e6 times the data's scale; relative noise from `floor` to 1e4.
    pub(crate) fn new(shape: &[f64], floor: f64) -> Self {
        let ranges = shape.iter().map(|length| (length * 1e-4, length * 1e6)).chain([(floor, 1e4)]);
        Self::of_logs(ranges.map(|(low, high)| (low.ln(), high.ln())))
    }

    /// Bounds from the lowest and the highest logarithm of each parameter.
    pub(crate) fn of_logs(ranges: impl Iterator<Item = (f64, f64)>) -> Self {
        let (middles, halves) = ranges.map(|(low, high)| ((low + high) / 2.0, (high - low) / 2.0)).unzip();
        Self { middles, halves }
    }

    pub(crate) fn log_from_free(&self, free: &[f64]) -> Vec<f64> {
        let bounds = self.middles.iter().zip(&self.halves);
        let bounded = |(free, (middle, half)): (&f64, (&f64, &f64))| middle + half * ((free - middle) / half).tanh();
        free.iter().zip(bounds).map(bounded).collect()
    }

    /// The inverse transformation, for points strictly within the bounds.
    pub(crate) fn free_from_log(&self, log: &[f64]) -> Vec<f64> {
        let bounds = self.middles.iter().zip(&self.halves);
        let freed = |(log, (middle, half)): (&f64, (&f64, &f64))| {
            let share = ((log - middle) / half).clamp(-0.999_999, 0.999_999);
            middle + half * share.atanh()
        };
        log.iter().zip(bounds).map(freed).collect()
    }

    /// d bounded / d free.
    pub(crate) fn slopes(&self, free: &[f64]) -> Vec<f64> {
        let bounds = self.middles.iter().zip(&self.halves);
        let slope = |(free, (middle, half)): (&f64, (&f64, &f64))| 1.0 - ((free - middle) / half).tanh().powi(2);
        free.iter().zip(bounds).map(slope).collect()
    }
}
