//! Regression of all joints' torques at once: Gaussian processes of an arm's kinetic and potential energy, and of its friction.

mod contraction;
mod covariance;
mod factors;
mod file;
mod lanes;
mod likelihood;
mod mean;
mod posterior;
mod prior;
mod range;
mod samples;
mod search;

pub use posterior::LagrangianWorkspace;
pub use prior::LagrangianPrior;
pub use range::LagrangianRange;
pub use samples::{JointType, TorqueSamples};

use crate::conditioning::floor;
use crate::error::GpError;
use likelihood::Factored;
use posterior::Posterior;

/// Options of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct LagrangianOptions {
    /// Number of starts that are climbed from, the best ones of a fixed grid; at least 1.
    pub starts: usize,
    /// Iterations of L-BFGS from each start.
    pub max_iterations: u64,
    /// Samples, evenly distributed, of which the last search maximises the likelihood; at least 1.
    pub search_samples: usize,
    /// Samples, evenly distributed, that carry the posterior; at least 1.
    pub support: usize,
    /// Samples, evenly distributed, from which the posterior is computed if the torques are noisy; at least 1.
    pub samples: usize,
}

impl Default for LagrangianOptions {
    fn default() -> Self {
        Self { starts: 4, max_iterations: 50, search_samples: 96, support: 250, samples: 2000 }
    }
}

/// How the posterior of a [`LagrangianGp`] was computed.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LagrangianConditioning {
    /// Number of samples given.
    pub given: usize,
    /// Number of samples from which the posterior was computed.
    pub samples: usize,
    /// Number of samples that carry it.
    pub support: usize,
    /// The noise variance of each joint as a share of the mean prior variance of all joints, torques being measured in the root
    /// mean square of their joint's.
    pub relative_noise: Vec<f64>,
    /// The smallest allowed share, which keeps the covariance matrix positive definite despite rounding.
    pub floor: f64,
}

/// Torques of an arm whose energies are Gaussian processes, conditioned on samples of motion and torque.
///
/// The torque of joint j is d/dt ∂L/∂q̇_j − ∂L/∂q_j of L = T − U, plus friction, with the covariances of [`LagrangianPrior`].
/// A torque on any joint informs about all joints, and whatever is learned conserves energy (but for friction).
///
/// Immutable: any number of threads may predict with it at once, each with its own [`LagrangianWorkspace`].
#[derive(Clone, Debug)]
pub struct LagrangianGp {
    prior: LagrangianPrior,
    /// Standard deviations (N m or N).
    noise: Vec<f64>,
    log_marginal_likelihood: f64,
    conditioning: LagrangianConditioning,
    posterior: Posterior,
}

impl LagrangianGp {
    /// Fits the hyperparameters by maximum marginal likelihood, and conditions on the samples. Deterministic, single-threaded.
    ///
    /// Torques are measured in the root mean square of their joint's, so that their units are of no account. The amplitude of all
    /// energies is profiled out; L-BFGS with exact gradients seeks the logarithms of the other hyperparameters and of one relative
    /// noise a joint, from the best points of a fixed grid on few samples, and from the best of those optima on
    /// [`LagrangianOptions::search_samples`].
    ///
    /// Samples of a continuous motion are much alike: of samples without noise, [`LagrangianOptions::support`] of them, evenly
    /// distributed, determine the energies as well as all do. With noise, these carry the posterior, and up to
    /// [`LagrangianOptions::samples`] determine it (projected process; Rasmussen and Williams 2006, section 8.3.4).
    ///
    /// Torques that are all zero need no energy: mean and variance are then 0 everywhere, and the likelihood is infinite.
    ///
    /// # Errors
    /// [`GpError::OutOfRange`] for options out of range; [`GpError::Likelihood`] if no likelihood is finite; [`GpError::Search`].
    pub fn fit(samples: &TorqueSamples, options: &LagrangianOptions) -> Result<Self, GpError> {
        for (name, value) in [
            ("starts", options.starts),
            ("search_samples", options.search_samples),
            ("support", options.support),
            ("samples", options.samples),
        ] {
            if value == 0 {
                return Err(GpError::OutOfRange { name, value: 0.0, requirement: "at least 1" });
            }
        }
        let scales = samples.scales();
        let Some(units) = samples.units() else {
            return Self::of_zero_torques(samples, &scales);
        };
        let (prior, rho) = search::search(samples, &scales, &units, options)?;
        Self::condition(samples, &scales, &units, prior, rho, options)
    }

    /// Conditions on `samples` at a prior that is known up to its amplitude, which maximises the likelihood of the support.
    fn condition(
        samples: &TorqueSamples,
        scales: &[f64],
        units: &[f64],
        prior: LagrangianPrior,
        mut rho: Vec<f64>,
        options: &LagrangianOptions,
    ) -> Result<Self, GpError> {
        let support = samples.thinned(options.support);
        let motions = support.motions(scales);
        let y = support.targets(&motions, units);
        let floor = search::FLOOR * floor(y.len());
        for rho in &mut rho {
            *rho = rho.max(floor);
        }
        let factored = |prior: &LagrangianPrior| {
            let factored = Factored::new(prior, &rho, units, &motions, &y);
            factored
                .ok_or_else(|| GpError::Likelihood(format!("at relative noises {rho:?} the covariance has no factor")))
        };
        let unscaled = factored(&prior)?;
        let amplitude_squared = unscaled.quadratic / y.len() as f64;
        let prior = prior.scaled(amplitude_squared / unscaled.mean_variance);
        prior.validate(units.len())?;
        let factored = factored(&prior)?;
        let log_units: f64 = units.iter().map(|unit| unit.ln()).sum();
        let log_marginal_likelihood = factored.profiled() - support.len() as f64 * log_units;
        let noise = rho.iter().zip(units);
        let noise = noise.map(|(rho, unit)| (rho * factored.mean_variance).sqrt() * unit);
        let noise = noise.collect();
        let (posterior, used) =
            Posterior::new(&prior, &rho, units, motions, factored, || samples.thinned(options.samples))?;
        Ok(Self {
            prior,
            noise,
            log_marginal_likelihood,
            conditioning: LagrangianConditioning {
                given: samples.len(),
                samples: used,
                support: support.len(),
                relative_noise: rho,
                floor,
            },
            posterior,
        })
    }

    fn of_zero_torques(samples: &TorqueSamples, scales: &[f64]) -> Result<Self, GpError> {
        let dof = samples.dof();
        let nothing = vec![0.0; dof];
        let prior = LagrangianPrior {
            kinetic: vec![0.0; dof * (dof + 1) / 2],
            potential: nothing.clone(),
            kinetic_share: nothing.clone(),
            potential_share: nothing.clone(),
            viscous: nothing.clone(),
            coulomb: nothing.clone(),
        };
        Ok(Self {
            posterior: Posterior::of_nothing(&prior, samples.thinned(1).motions(scales)),
            prior,
            log_marginal_likelihood: f64::INFINITY,
            conditioning: LagrangianConditioning {
                given: samples.len(),
                samples: 1,
                support: 1,
                relative_noise: nothing.clone(),
                floor: search::FLOOR * floor(dof),
            },
            noise: nothing,
        })
    }

    /// The number of joints.
    pub fn dof(&self) -> usize {
        self.noise.len()
    }

    /// The hyperparameters.
    pub fn prior(&self) -> &LagrangianPrior {
        &self.prior
    }

    /// The standard deviation of each joint's noise (N m or N), including the part that keeps the covariance matrix positive definite.
    pub fn noise(&self) -> &[f64] {
        &self.noise
    }

    /// Log marginal likelihood of the torques of the samples that carry the posterior, nats.
    pub fn log_marginal_likelihood(&self) -> f64 {
        self.log_marginal_likelihood
    }

    /// How the posterior was computed.
    pub fn conditioning(&self) -> &LagrangianConditioning {
        &self.conditioning
    }

    /// The range of the regression, for calls that cannot afford [`LagrangianGp::variance`].
    pub fn range(&self) -> LagrangianRange {
        LagrangianRange::of(self)
    }

    /// Writes the posterior mean of the torques (N m or N) at a motion to `torques`; allocates nothing with a workspace of this model.
    ///
    /// # Panics
    /// If a slice is of another number of joints.
    pub fn mean(&self, motion: [&[f64]; 3], workspace: &mut LagrangianWorkspace, torques: &mut [f64]) {
        workspace.set(&self.posterior.motions, motion);
        self.posterior.mean(&self.prior, workspace, torques);
    }

    /// Writes the posterior variance of the torques (noise not included) at a motion to `variances`; allocates nothing once the
    /// workspace has grown. It takes about a hundred times as long as the mean.
    ///
    /// # Panics
    /// If a slice is of another number of joints.
    pub fn variance(&self, motion: [&[f64]; 3], workspace: &mut LagrangianWorkspace, variances: &mut [f64]) {
        workspace.set(&self.posterior.motions, motion);
        self.posterior.variance(&self.prior, workspace, variances);
    }

    /// Scratch for this model.
    pub fn workspace(&self) -> LagrangianWorkspace {
        LagrangianWorkspace::new(&self.posterior.motions)
    }
}

#[cfg(test)]
mod tests;
