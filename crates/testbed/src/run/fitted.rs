//! The results of training, for the summary of a run and for the terminal.

use report::numbers::rounded;
use serde::Serialize;
use torque::{Gp, LagrangianConditioning, LagrangianGp, LagrangianPrior, Lengths};

/// The hyperparameters of one joint's regression, which are sufficient to repeat it.
#[derive(Serialize)]
pub struct Regression {
    /// Standard deviation of the learned torque (N m or N).
    amplitude: f64,
    /// The length scale of all inputs, or one per input.
    length_scales: Vec<f64>,
    /// Standard deviation of the noise (N m or N).
    noise: f64,
    log_marginal_likelihood: f64,
    /// The numerical rank of the kernel matrix.
    rank: usize,
    /// The numerical treatment of the kernel matrix: the addition to its diagonal and the reason.
    conditioning: String,
}

/// What training found of the energies.
#[derive(Serialize)]
pub struct Energies<'a> {
    prior: &'a LagrangianPrior,
    /// Standard deviation of the noise, one a joint (N m or N).
    noise: &'a [f64],
    log_marginal_likelihood: f64,
    conditioning: &'a LagrangianConditioning,
}

/// What training found for one joint.
pub fn regression(gp: &Gp) -> Regression {
    let hyperparameters = gp.hyperparameters();
    Regression {
        amplitude: hyperparameters.amplitude,
        length_scales: match &hyperparameters.lengths {
            Lengths::Isotropic(length) => vec![*length],
            Lengths::PerInput(lengths) => lengths.clone(),
        },
        noise: hyperparameters.noise,
        log_marginal_likelihood: gp.log_marginal_likelihood(),
        rank: gp.rank(),
        conditioning: gp.conditioning().to_string(),
    }
}

/// What training found of the energies.
pub fn energies(gp: &LagrangianGp) -> Energies<'_> {
    Energies {
        prior: gp.prior(),
        noise: gp.noise(),
        log_marginal_likelihood: gp.log_marginal_likelihood(),
        conditioning: gp.conditioning(),
    }
}

/// A sentence on approximated regressions: the number of inducing points, and the largest error.
pub fn approximated(regressions: &[Gp]) -> String {
    let conditionings = regressions.iter().map(Gp::conditioning);
    let gaps: Vec<(f64, &torque::Conditioning)> =
        conditionings.filter_map(|conditioning| Some((conditioning.likelihood_gap?, conditioning))).collect();
    let Some((gap, worst)) = gaps.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return String::new();
    };
    let samples = worst.samples as f64;
    format!(
        "{} of {} regressions are approximated by {} inducing points (variational free energy); the worst of them neglects {} of the \
         prior variance at the samples, and its exact log likelihood is at most {} nats per sample higher.\n",
        gaps.len(),
        regressions.len(),
        worst.rank,
        rounded(worst.neglected / samples, 2),
        rounded(gap / samples, 2)
    )
}
