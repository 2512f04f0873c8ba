//! A fitted Gaussian process: fitting, and prediction.

mod file;

use serde::{Deserialize, Serialize};

use crate::conditioning::{Conditioning, floor};
use crate::data::{Hyperparameters, Lengths, TrainingSet};
use crate::error::GpError;
use crate::kernel::Points;
use crate::likelihood::{Factored, Precision};
use crate::options::{FitOptions, LengthScales};
use crate::posterior::Posterior;
use crate::range::Range;
use crate::search::search;
use crate::starts::shapes;
use file::Saved;

/// Scratch for [`Gp::mean_and_variance`]; it grows on first use, and nothing is allocated afterwards.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    kernel: Vec<f64>,
}

/// A Gaussian process conditioned on data: zero prior mean, squared-exponential kernel.
///
/// Immutable: any number of threads may predict with it at once, each with its own [`Workspace`].
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Saved", into = "Saved")]
pub struct Gp {
    hyperparameters: Hyperparameters,
    log_marginal_likelihood: f64,
    conditioning: Conditioning,
    /// Variance at unit amplitude; empty of points if every target is zero.
    posterior: Posterior,
}

impl Gp {
    /// Fits hyperparameters by maximum marginal likelihood, and conditions on the data. Deterministic, single-threaded.
    ///
    /// The amplitude is profiled out: amplitude² = yᵀ C⁻¹ y / n with C = K / amplitude² + ρ I. L-BFGS with analytic gradients then seeks
    /// the logarithms of the length scales and of ρ, from the best points of a fixed grid of multiples of the data's own scales
    /// on at most 256 samples, and from the best of those optima on all samples (on a part of them in between, if they are many).
    ///
    /// One length scale for samples without noise is found without gradients, ρ at its floor: from values on a part of the samples, a
    /// few for each rank of the kernel matrix, each of which counts as if it had been measured several times. All samples are
    /// factored once, and must confirm that there is no noise and that the part stands for them.
    ///
    /// Targets that are all zero need no function: amplitude and noise are then 0, as are mean and variance everywhere, and the likelihood
    /// is unbounded (infinite).
    ///
    /// # Errors
    /// [`GpError::OutOfRange`] for options out of range; [`GpError::Likelihood`] if no likelihood is finite; [`GpError::Search`].
    ///
    /// Source: Rasmussen and Williams 2006, section 5.4.1.
    pub fn fit(training: &TrainingSet, options: &FitOptions) -> Result<Self, GpError> {
        let asked = options.min_relative_noise;
        if !(0.0..=1.0).contains(&asked) {
            return Err(GpError::OutOfRange { name: "min_relative_noise", value: asked, requirement: "from 0 to 1" });
        }
        if options.starts == 0 {
            return Err(GpError::OutOfRange { name: "starts", value: 0.0, requirement: "at least 1" });
        }
        if options.inducing == Some(0) {
            return Err(GpError::OutOfRange { name: "inducing", value: 0.0, requirement: "at least 1" });
        }
        let floor = floor(training.samples()).max(asked);
        let scale = target_scale(training);
        if scale == 0.0 {
            return Ok(Self::of_zero_targets(training, options.lengths, floor));
        }
        let unit = training.clone().with_targets_divided(scale);
        let found = search(&unit, options, floor)?;
        let lengths = match options.lengths {
            LengthScales::Isotropic => Lengths::Isotropic(found.lengths[0]),
            LengthScales::PerInput => Lengths::PerInput(found.lengths),
        };
        // Within a tenth of a per cent of the bound counts as at it: the smooth bound is never quite reached.
        let added = if found.rho <= 1.001 * floor { floor } else { 0.0 };
        let noise = (found.rho, floor, added);
        let factored = found.factored.unwrap_or_else(|| factored(&unit, &lengths, found.rho, options.inducing));
        Self::condition(&unit, scale, None, lengths, noise, factored)
    }

    /// Conditions on the data at given hyperparameters.
    ///
    /// Exact, but where the noise variance is less than n ε amplitude²: it is then raised to that, and [`Gp::conditioning`] says so.
    ///
    /// # Errors
    /// [`GpError::OutOfRange`] and [`GpError::Lengths`] for unusable hyperparameters; [`GpError::Likelihood`] if the likelihood overflows.
    ///
    /// Source: Rasmussen and Williams 2006, algorithm 2.1.
    pub fn with_hyperparameters(training: &TrainingSet, hyperparameters: &Hyperparameters) -> Result<Self, GpError> {
        hyperparameters.validate(training.dim())?;
        let floor = floor(training.samples());
        let asked = (hyperparameters.noise / hyperparameters.amplitude).powi(2);
        let rho = asked.max(floor);
        let scale = match target_scale(training) {
            0.0 => 1.0,
            scale => scale,
        };
        let unit = training.clone().with_targets_divided(scale);
        let amplitude = Some(hyperparameters.amplitude);
        let lengths = hyperparameters.lengths.clone();
        let factored = factored(&unit, &lengths, rho, None);
        Self::condition(&unit, scale, amplitude, lengths, (rho, floor, rho - asked), factored)
    }

    /// Conditions on targets divided by `scale`; `amplitude` in the target's unit, the likeliest if `None`; with ρ, its floor,
    /// and the part of it that was added; and with C factored for the scaled samples.
    fn condition(
        unit: &TrainingSet,
        scale: f64,
        amplitude: Option<f64>,
        lengths: Lengths,
        (rho, floor, added): (f64, f64, f64),
        (factored, points): (Factored, Points),
    ) -> Result<Self, GpError> {
        let evaluation = factored.evaluation();
        let unit_amplitude = match amplitude {
            Some(amplitude) => amplitude / scale,
            None => evaluation.best_amplitude_squared().sqrt(),
        };
        let samples = unit.samples();
        let log_marginal_likelihood = evaluation.log_likelihood(unit_amplitude.powi(2)) - samples as f64 * scale.ln();
        let amplitude = amplitude.unwrap_or(unit_amplitude * scale);
        if !log_marginal_likelihood.is_finite() || !amplitude.is_normal() {
            return Err(GpError::Likelihood(format!(
                "at {lengths:?}, relative noise {rho:e} and amplitude {amplitude:e} it is {log_marginal_likelihood}"
            )));
        }
        let each = lengths.each(unit.dim());
        let (rank, neglected) = factored.rank_and_neglected();
        let likelihood_gap = factored.gap(unit.targets(), unit_amplitude.powi(2));
        Ok(Self {
            hyperparameters: Hyperparameters { amplitude, noise: amplitude * rho.sqrt(), lengths },
            log_marginal_likelihood,
            conditioning: Conditioning { samples, rank, relative_noise: rho, floor, added, neglected, likelihood_gap },
            posterior: Posterior::of(&factored, &points, each, scale),
        })
    }

    fn of_zero_targets(training: &TrainingSet, lengths: LengthScales, floor: f64) -> Self {
        let mut shape = shapes(training, lengths).swap_remove(0);
        let lengths = match lengths {
            LengthScales::Isotropic => Lengths::Isotropic(shape.swap_remove(0)),
            LengthScales::PerInput => Lengths::PerInput(shape),
        };
        Self {
            posterior: Posterior::empty(lengths.each(training.dim())),
            hyperparameters: Hyperparameters { amplitude: 0.0, lengths, noise: 0.0 },
            log_marginal_likelihood: f64::INFINITY,
            conditioning: Conditioning {
                samples: training.samples(),
                rank: 0,
                relative_noise: 0.0,
                floor,
                added: 0.0,
                neglected: 0.0,
                likelihood_gap: None,
            },
        }
    }

    /// The hyperparameters; the noise includes the value that was added to the diagonal.
    pub fn hyperparameters(&self) -> &Hyperparameters {
        &self.hyperparameters
    }

    /// Log marginal likelihood of the training targets, nats.
    pub fn log_marginal_likelihood(&self) -> f64 {
        self.log_marginal_likelihood
    }

    /// How the kernel matrix was conditioned: the addition to its diagonal, and the reason.
    pub fn conditioning(&self) -> &Conditioning {
        &self.conditioning
    }

    /// Numerical rank of the kernel matrix, as found.
    pub fn rank(&self) -> usize {
        self.conditioning.rank
    }

    /// Number of kernel values a mean costs: the rank where the noise is near the floor, else the number of samples.
    pub fn support(&self) -> usize {
        self.posterior.points.len()
    }

    /// Number of inputs.
    pub fn dim(&self) -> usize {
        self.posterior.lengths.len()
    }

    /// Posterior mean at `x` (`dim` inputs), in the target's unit; allocates nothing.
    ///
    /// NaN if an input is NaN; the prior mean, 0, far from the data and so for infinite inputs.
    ///
    /// # Panics
    /// If `x` is not of length `dim`.
    ///
    /// Source: Rasmussen and Williams 2006, eq. 2.25.
    pub fn mean(&self, x: &[f64]) -> f64 {
        assert_eq!(x.len(), self.dim(), "inputs given and expected");
        self.posterior.mean(x)
    }

    /// Posterior mean, and variance of the function (noise not included), at `x` (`dim` inputs), in the target's unit and its square.
    ///
    /// The mean is that of [`Gp::mean`], bit for bit; the variance is never negative, and NaN only if an input is NaN.
    ///
    /// # Panics
    /// If `x` is not of length `dim`.
    ///
    /// Source: Rasmussen and Williams 2006, eqs 2.25 and 2.26.
    pub fn mean_and_variance(&self, x: &[f64], workspace: &mut Workspace) -> (f64, f64) {
        let mean = self.mean(x);
        let unit = self.posterior.variance(x, &mut workspace.kernel);
        (mean, self.hyperparameters.amplitude.powi(2) * unit)
    }

    /// The range of the regression, for calls that cannot afford [`Gp::mean_and_variance`].
    pub fn range(&self) -> Range {
        Range::of(&self.posterior, self.conditioning.relative_noise)
    }
}

/// C for `unit` scaled by `lengths`, factored as exactly as rounding allows, or approximated.
fn factored(unit: &TrainingSet, lengths: &Lengths, rho: f64, inducing: Option<usize>) -> (Factored, Points) {
    let points = unit.scaled(&lengths.each(unit.dim()));
    let factored = Factored::new(&points, unit.targets(), rho, Precision::POSTERIOR, inducing);
    (factored, points)
}

/// The largest magnitude among the targets.
fn target_scale(training: &TrainingSet) -> f64 {
    let magnitudes = training.targets().iter().map(|y| y.abs());
    magnitudes.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
