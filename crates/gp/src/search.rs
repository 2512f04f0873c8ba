//! Maximum marginal likelihood: a grid of starts on few samples, then L-BFGS, then L-BFGS on all samples; one length scale without
//! noise has a search of its own.

mod noise_free;

use crate::climb::{self, climb};
use crate::data::TrainingSet;
use crate::error::GpError;
use crate::kernel::Points;
use crate::likelihood::{Factored, Precision};
use crate::options::{FitOptions, LengthScales};
use crate::starts::{Bounds, LENGTH_FACTORS, RELATIVE_NOISES, shapes};

/// Samples the starts are tried on.
const FEW: usize = 256;

/// The relative noise up to which a search on few samples is assumed to have found the function.
const RESOLVED: f64 = 0.03;

/// The result of the search: length scales (one, or one per input) and relative noise ρ.
pub(crate) struct Found {
    pub(crate) lengths: Vec<f64>,
    pub(crate) rho: f64,
    /// C factored there for the scaled samples, with [`Precision::POSTERIOR`], if it was.
    pub(crate) factored: Option<(Factored, Points)>,
}

/// Maximises the likelihood of `training` (targets of unit size, not all zero), with ρ at least `floor`.
pub(crate) fn search(training: &TrainingSet, options: &FitOptions, floor: f64) -> Result<Found, GpError> {
    let shapes = shapes(training, options.lengths);
    if options.lengths == LengthScales::Isotropic
        && options.inducing.is_none_or(|inducing| inducing >= training.samples())
        && let Some(found) = noise_free::search(training, shapes[0][0], options.starts, floor)
    {
        return Ok(found);
    }
    let bounds = Bounds::new(&shapes[0], floor);
    let few = training.thinned(FEW);
    // On few samples, only the neighbourhood of an optimum is needed.
    let on_few = Likelihood::new(&few, &bounds, options, 0.05);

    let mut grid = Vec::new();
    for shape in &shapes {
        for factor in LENGTH_FACTORS {
            for relative in RELATIVE_NOISES {
                let rho = relative.max(2.0 * floor);
                let mut at: Vec<f64> = shape.iter().map(|l| (l * factor).ln()).collect();
                at.push(rho.ln());
                let free = bounds.free_from_log(&at);
                grid.push((on_few.value(&free), free));
            }
        }
    }
    // A stable sort: equal values keep the order of the grid.
    grid.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut chosen: Vec<Vec<f64>> = Vec::new();
    for (_, free) in grid {
        // Neighbouring starts climb to the same optimum.
        let distant = |other: &Vec<f64>| other.iter().zip(&free).any(|(a, b)| (a - b).abs() > NEIGHBOURHOOD);
        if chosen.len() < options.starts && chosen.iter().all(distant) {
            chosen.push(free);
        }
    }

    // A likelihood ratio of 1.003 is no evidence.
    let on_all = Likelihood::new(training, &bounds, options, 0.003);
    let mut best = (f64::NEG_INFINITY, Vec::new());
    for start in &chosen {
        let (_, free) = climb(&on_few, start, options.max_iterations)?;
        let value = on_all.value(&free);
        if value > best.0 || best.1.is_empty() {
            best = (value, free);
        }
    }
    if on_all.found(&best.1).rho > RESOLVED {
        // Mostly noise: or a function too fine for few samples to tell from it. All samples may tell.
        for shape in &shapes {
            for factor in LENGTH_FACTORS {
                let mut at: Vec<f64> = shape.iter().map(|l| (l * factor).ln()).collect();
                at.push(RESOLVED.max(2.0 * floor).ln());
                let free = bounds.free_from_log(&at);
                let value = on_all.value(&free);
                if value > best.0 {
                    best = (value, free);
                }
            }
        }
    }
    if training.samples() > 4 * FEW {
        // Halfway there on the geometric mean of few and all: first steps are long, and some of them lead to a high rank.
        let between = training.thinned((FEW * training.samples()).isqrt());
        let on_between = Likelihood::new(&between, &bounds, options, 0.05);
        best = climb(&on_between, &best.1, options.max_iterations)?;
        if options.inducing.is_some() {
            // Few noisy samples may have set an input aside, where no slope leads back from: once more from all inputs alike.
            let start = best_start(&on_between, &shapes, &bounds, floor);
            let other = climb(&on_between, &start, options.max_iterations)?;
            if other.0 > best.0 {
                best = other;
            }
        }
    }
    let (_, free) = climb(&on_all, &best.1, options.max_iterations)?;
    Ok(on_all.found(&free))
}

/// The best of the starts with every input at the same multiple of its scale.
fn best_start(likelihood: &Likelihood<'_>, shapes: &[Vec<f64>], bounds: &Bounds, floor: f64) -> Vec<f64> {
    let mut best = (f64::NEG_INFINITY, Vec::new());
    for shape in shapes {
        for factor in LENGTH_FACTORS {
            for relative in [RESOLVED * 1e-3, RESOLVED] {
                let mut at: Vec<f64> = shape.iter().map(|l| (l * factor).ln()).collect();
                at.push(relative.max(2.0 * floor).ln());
                let free = bounds.free_from_log(&at);
                let value = likelihood.value(&free);
                if value > best.0 || best.1.is_empty() {
                    best = (value, free);
                }
            }
        }
    }
    best.1
}

/// Grid points closer than this, in every logarithm, count as one start.
const NEIGHBOURHOOD: f64 = 1.5;

/// The likelihood of one data set as a function of the free parameters.
struct Likelihood<'a> {
    training: &'a TrainingSet,
    bounds: &'a Bounds,
    lengths: LengthScales,
    inducing: Option<usize>,
    /// Gains that are no gain, nats.
    tolerance: f64,
}

impl<'a> Likelihood<'a> {
    fn new(training: &'a TrainingSet, bounds: &'a Bounds, options: &FitOptions, tolerance: f64) -> Self {
        Self { training, bounds, lengths: options.lengths, inducing: options.inducing, tolerance }
    }

    fn factored(&self, free: &[f64], precision: Precision) -> (Factored, Points) {
        let found = self.found(free);
        let lengths = match self.lengths {
            LengthScales::Isotropic => vec![found.lengths[0]; self.training.dim()],
            LengthScales::PerInput => found.lengths,
        };
        let points = self.training.scaled(&lengths);
        let targets = self.training.targets();
        let factored = Factored::new(&points, targets, found.rho, precision, self.inducing);
        (factored, points)
    }

    /// Log marginal likelihood; minus infinity where it cannot be computed.
    fn value(&self, free: &[f64]) -> f64 {
        let value = self.factored(free, Precision::VALUE).0.evaluation().profiled();
        if value.is_nan() { f64::NEG_INFINITY } else { value }
    }

    fn found(&self, free: &[f64]) -> Found {
        let mut lengths: Vec<f64> = self.bounds.log_from_free(free);
        for value in &mut lengths {
            *value = value.exp();
        }
        let rho = lengths.pop().unwrap_or(f64::NAN);
        Found { lengths, rho, factored: None }
    }
}

impl climb::Likelihood for Likelihood<'_> {
    fn value_and_gradient(&self, free: &[f64]) -> Option<(f64, Vec<f64>)> {
        let (factored, points) = self.factored(free, Precision::SEARCH);
        let value = factored.evaluation().profiled();
        let by_log = factored.gradient(&points);
        if !value.is_finite() || by_log.iter().any(|g| !g.is_finite()) {
            return None;
        }
        let (by_length, by_rho) = by_log.split_at(self.training.dim());
        let mut gradient = match self.lengths {
            LengthScales::Isotropic => vec![by_length.iter().sum()],
            LengthScales::PerInput => by_length.to_vec(),
        };
        gradient.extend(by_rho);
        for (g, slope) in gradient.iter_mut().zip(self.bounds.slopes(free)) {
            *g *= slope;
        }
        Some((value, gradient))
    }

    fn observations(&self) -> f64 {
        self.training.samples() as f64
    }

    fn negligible(&self, free: &[f64]) -> f64 {
        let rounding = f64::EPSILON * self.training.samples() as f64 / self.found(free).rho;
        self.tolerance + 0.5 * rounding
    }
}
