//! The length scale of samples without noise, from a part of them that stands for all.

use std::cell::RefCell;

use super::Found;
use crate::data::TrainingSet;
use crate::likelihood::{Factored, Precision};
use crate::line::{Goal, Line, Maximum};
use crate::starts::LENGTH_FACTORS;

/// Samples on which noise is looked for, and on which length scales are tried first.
const FIRST: usize = 128;

/// Relative noises that noise-free samples are compared with.
const NOISES: [f64; 2] = [1e-4, 1e-1];

/// The difference by which the likelihood with noise must be larger to count, nats for each sample. If it is smaller, the search without
/// noise continues with more samples, which decide.
const MARGIN: f64 = 0.1;

/// The number of samples for each rank of the kernel matrix from which a part of them represents all. Measured on the paper's data: the
/// error of the length scale of so many samples costs at most 0.3 nats, that of half as many 10.
const PER_RANK: f64 = 2.7;

/// The difference of likelihoods next to the maximum from which it is computed, nats: enough to stand out from rounding.
const NEAR: f64 = 20.0;

/// The goal of the search on a part that does not represent all samples.
const ROUGH: Goal = Goal { negligible: 2.0, near: None };

/// The goal of the search on the last part.
const FINE: Goal = Goal { negligible: 0.1, near: Some(NEAR) };

/// The expected distance that the maximum moves from the next part to the one after, as a share of its last distance.
const SHIFT: f64 = 0.4;

/// The largest difference between the likelihood of all samples and that of the part, nats for each sample: the quadratic form is
/// then larger by a tenth.
const REPRESENTED: f64 = 0.05;

/// Maximises the likelihood of `training` in one length scale, with the relative noise at its `floor`; `None` if noise makes it
/// likelier. `scale` is the data's own.
///
/// A part of the samples, m of n, is searched in place of all, as if each had been measured n / m times with the same result.
/// Where m is a few times the numerical rank, that has the maximum of all samples, and its curvature.
pub(crate) fn search(training: &TrainingSet, scale: f64, starts: usize, floor: f64) -> Option<Found> {
    let n = training.samples();
    let first = Part::new(training, FIRST, floor);
    let grid: Vec<f64> = LENGTH_FACTORS.iter().map(|factor| (scale * factor).ln()).collect();
    let range = ((scale * 1e-4).ln(), (scale * 1e6).ln());
    if first.is_noisy(&grid, range) {
        return None;
    }
    let mut part = Part::new(training, 2 * FIRST, floor);
    let starts = first.hills(&grid, starts).into_iter();
    let climbed = starts.map(|start| part.climb(range, [start, start + 0.5], None));
    let mut best = climbed.reduce(|a, b| if b.maximum.value > a.maximum.value { b } else { a })?;
    let mut shift = 0.0;
    loop {
        let m = part.samples();
        let mut enough = enough(best.rank);
        let top = best.maximum.top;
        if best.fine {
            let points = training.scaled(&vec![top.exp(); training.dim()]);
            let factored = Factored::new(&points, training.targets(), floor, Precision::POSTERIOR, None);
            // Where the rank is not far below n, nothing tells noise from a fine function.
            if leaves_more_than(0.1, &factored, n).unwrap_or(true) {
                return None;
            }
            let off = (factored.evaluation().profiled() - best.maximum.value).abs();
            if m == n || off <= REPRESENTED * n as f64 {
                return Some(Found { lengths: vec![top.exp()], rho: floor, factored: Some((factored, points)) });
            }
            enough = 2 * m;
        }
        let count = enough.min(2 * m);
        part = Part::new(training, if 4 * count > 3 * n { n } else { count }, floor);
        let curvature = best.maximum.curvature;
        let step = curvature.map_or(0.1, |curvature| (2.0 * NEAR / curvature).sqrt().clamp(1e-3, 0.5));
        let next = top + shift;
        best = part.climb(range, [next, next + step], curvature);
        shift = SHIFT * (best.maximum.top - top);
    }
}

/// Whether the residual of the targets under C, at the floor of the noise, exceeds `share` of the residual that noise of that variance has. The
/// derivative of the likelihood by the logarithm of the noise is minus half the degrees of freedom left if it leaves nothing, and
/// 0 if it leaves as much as the noise. `None` if C has no low rank.
fn leaves_more_than(share: f64, factored: &Factored, samples: usize) -> Option<bool> {
    let Factored::LowRank(low_rank) = factored else {
        return None;
    };
    let free = samples - low_rank.pivoted().rank();
    Some(low_rank.slope_by_noise() >= -0.5 * (1.0 - share) * free as f64)
}

/// The number of samples that represent all.
fn enough(rank: usize) -> usize {
    (PER_RANK * rank as f64) as usize
}

/// The result of the search on one part.
struct Climbed {
    maximum: Maximum,
    /// The numerical rank there.
    rank: usize,
    /// Whether the part represents all samples, and its maximum was found.
    fine: bool,
}

/// Part of the samples.
struct Part {
    training: TrainingSet,
    /// The number of all samples.
    all: usize,
    floor: f64,
}

impl Part {
    fn new(training: &TrainingSet, count: usize, floor: f64) -> Self {
        Self { training: training.thinned(count), all: training.samples(), floor }
    }

    fn samples(&self) -> usize {
        self.training.samples()
    }

    fn with_noise(&self, log: f64, rho: f64) -> Factored {
        let points = self.training.scaled(&vec![log.exp(); self.training.dim()]);
        let most = self.samples() * 3 / 5;
        Factored::up_to_rank(most, &points, self.training.targets(), rho, Precision::VALUE)
    }

    /// C with the noise of n / m samples' mean.
    fn factored(&self, log: f64) -> Factored {
        let share = self.samples() as f64 / self.all as f64;
        self.with_noise(log, self.floor * share)
    }

    /// The log marginal likelihood of all samples, if each of the part's were there n / m times, and the numerical rank.
    fn value_and_rank(&self, log: f64) -> (f64, usize) {
        let factored = self.factored(log);
        let evaluation = factored.evaluation().repeated(self.all, self.floor);
        (evaluation.profiled(), factored.rank_and_neglected().0)
    }

    /// Climbs the hill at `starts`: roughly, and to the top if the part stands for all there.
    fn climb(&self, range: (f64, f64), starts: [f64; 2], curvature: Option<f64>) -> Climbed {
        let ranks = RefCell::new(Vec::new());
        let mut line = Line::new(range, |log| {
            let (value, rank) = self.value_and_rank(log);
            ranks.borrow_mut().push((log, rank));
            value
        });
        for start in starts {
            line.look(start);
        }
        let rank_at = |maximum: Maximum| {
            let ranks = ranks.borrow();
            let rank = ranks.iter().find(|(log, _)| *log == maximum.at);
            rank.map_or(self.samples(), |(_, rank)| *rank)
        };
        let stands_for_all = |rank| self.samples() == self.all || 10 * self.samples() >= 9 * enough(rank);
        let mut maximum = line.climb(curvature, ROUGH);
        let mut rank = rank_at(maximum);
        if stands_for_all(rank) {
            maximum = line.climb(maximum.curvature, FINE);
            rank = rank_at(maximum);
        }
        let fine = stands_for_all(rank);
        Climbed { maximum, rank, fine }
    }

    /// The log marginal likelihood of the part's samples themselves.
    fn own_value(&self, log: f64, rho: f64) -> f64 {
        self.with_noise(log, rho).evaluation().profiled()
    }

    /// Whether the part's samples are likelier with noise than without.
    fn is_noisy(&self, grid: &[f64], range: (f64, f64)) -> bool {
        let noisy = NOISES.iter().flat_map(|rho| grid.iter().map(|log| self.own_value(*log, rho.max(self.floor))));
        let noisy = noisy.fold(f64::NEG_INFINITY, f64::max);
        let mut line = Line::new(range, |log| self.own_value(log, self.floor));
        for log in grid {
            line.look(*log);
        }
        let noise_free = line.climb(None, ROUGH);
        let factored = self.with_noise(noise_free.at, self.floor);
        if leaves_more_than(0.9, &factored, self.samples()).unwrap_or(false) {
            return true;
        }
        let noise_free = noise_free.value;
        noise_free + MARGIN * self.samples() as f64 <= noisy
    }

    /// The places of the grid from which it falls on both sides, the highest `count` of them.
    fn hills(&self, grid: &[f64], count: usize) -> Vec<f64> {
        let values: Vec<(f64, f64)> = grid.iter().map(|log| (self.value_and_rank(*log).0, *log)).collect();
        let top = |i: &usize| {
            let value = values[*i].0;
            (*i == 0 || values[i - 1].0 <= value) && values.get(i + 1).is_none_or(|next| next.0 < value)
        };
        let tops: Vec<usize> = (0..values.len()).filter(top).collect();
        let mut tops: Vec<(f64, f64)> = tops.into_iter().map(|i| values[i]).collect();
        tops.sort_by(|a, b| b.0.total_cmp(&a.0));
        tops.into_iter().take(count).map(|(_, log)| log).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FitOptions, Gp};

    /// Two inputs along a path that crosses itself, and a smooth function of them with `noise`; from `n` samples.
    fn path(n: usize, noise: f64) -> TrainingSet {
        let input = |i: usize, d: usize| {
            let time = 12.0 * i as f64 / n as f64;
            ((1.0 + 0.37 * d as f64) * time).sin() + 0.3 * (2.1 * time + d as f64).cos()
        };
        let inputs: Vec<f64> = (0..2 * n).map(|at| input(at / 2, at % 2)).collect();
        let targets: Vec<f64> =
            inputs.chunks_exact(2).enumerate().map(|(i, x)| (1.5 * x[0]).sin() * x[1] + noise * scatter(i)).collect();
        TrainingSet::new(2, &inputs, &targets).expect("valid")
    }

    /// About of unit variance, and alike at no two samples near each other.
    fn scatter(i: usize) -> f64 {
        let share = |step: f64| (i as f64 * step).fract() - 0.5;
        2.0 * (share(0.754_877_666) + share(0.569_840_291) + share(0.412_345_67))
    }

    fn floor(training: &TrainingSet) -> f64 {
        f64::EPSILON * training.samples() as f64
    }

    #[test]
    fn a_part_says_what_its_samples_would_say_repeated() {
        let part = path(40, 0.1);
        let rows = (0..120).flat_map(|i| part.row(i / 3).to_vec());
        let targets: Vec<f64> = (0..120).map(|i| part.targets()[i / 3]).collect();
        let repeated = TrainingSet::new(2, &rows.collect::<Vec<f64>>(), &targets).expect("valid");
        for (length, rho) in [(0.5, 1e-2), (0.2, 1e-4)] {
            let evaluation = |set: &TrainingSet, rho: f64| {
                let points = set.scaled(&[length; 2]);
                Factored::up_to_rank(0, &points, set.targets(), rho, Precision::VALUE).evaluation()
            };
            let expected = evaluation(&repeated, rho).profiled();
            let found = evaluation(&part, rho / 3.0).repeated(120, rho).profiled();
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} and {expected}");
        }
    }

    #[test]
    fn the_length_found_is_the_likeliest_for_all_samples() {
        let training = path(1200, 0.0);
        let floor = floor(&training);
        let found = search(&training, 1.0, 4, floor).expect("there is no noise");
        assert_eq!(found.rho, floor);
        let all = Part::new(&training, training.samples(), floor);
        let top = found.lengths[0].ln();
        let value = all.own_value(top, floor);
        for step in [-1.0, -0.3, -0.1, -0.03, 0.03, 0.1, 0.3, 1.0] {
            let other = all.own_value(top + step, floor);
            assert!(other < value + 1.0, "{step}: {other} and {value}");
        }
    }

    #[test]
    fn noise_is_left_to_the_search_for_it() {
        for noise in [1e-6, 1e-4, 1e-2, 0.3] {
            let training = path(600, noise);
            assert!(search(&training, 1.0, 4, floor(&training)).is_none(), "{noise}");
            let gp = Gp::fit(&training, &FitOptions::default()).expect("fits");
            let found = gp.hyperparameters().noise;
            assert!((0.7..1.4).contains(&(found / noise)), "{noise}: {found}");
        }
    }
}
