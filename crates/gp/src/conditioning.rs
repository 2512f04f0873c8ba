//! The diagonal of the kernel matrix, and the reasons for its value.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The default floor of the relative noise, in units of n ε.
///
/// The kernel values have rounding errors of about ε, which as a matrix change the eigenvalues by up to n ε. A
/// diagonal of ρ ≥ n ε keeps C positive definite despite rounding, and the likelihood is then accurate to about a nat.
/// Below it, the likelihood still increases as ρ decreases, but it measures rounding and not the data.
const FLOOR_PER_SAMPLE: f64 = f64::EPSILON;

/// The smallest relative noise for `samples` samples.
pub(crate) fn floor(samples: usize) -> f64 {
    FLOOR_PER_SAMPLE * samples as f64
}

/// How the kernel matrix was conditioned: the addition to its diagonal, and the reason.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conditioning {
    /// Number of samples n, the size of the kernel matrix.
    pub samples: usize,
    /// The numerical rank: the number of pivots of the factorisation, or n if the matrix was factored in full.
    pub rank: usize,
    /// The diagonal in total, as a share of amplitude²: the noise and the addition.
    pub relative_noise: f64,
    /// The smallest allowed share: n ε, or more if the options ask for it.
    pub floor: f64,
    /// The part of `relative_noise` that neither the options nor the data require; 0 if the noise is above the floor.
    pub added: f64,
    /// The trace of the kernel matrix without its factor of rank `rank`, as a share of amplitude²; it bounds the
    /// largest eigenvalue of the difference.
    pub neglected: f64,
    /// For an approximation by inducing points (`rank` is then their number): the largest possible distance of the
    /// maximised bound below the exact log marginal likelihood at these hyperparameters, nats. `None` if nothing was
    /// approximated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub likelihood_gap: Option<f64>,
}

impl fmt::Display for Conditioning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { samples, rank, relative_noise, floor, added, neglected, likelihood_gap } = self;
        if let Some(gap) = likelihood_gap {
            let share = neglected / *samples as f64;
            write!(
                f,
                "{rank} inducing points (variational free energy) leave {share:.1e} of the prior variance at the {samples} samples, and \
                 the exact log marginal likelihood is at most {gap:.3} nats higher; "
            )?;
        }
        write!(f, "kernel matrix of {samples} samples, numerical rank {rank} (neglected trace {neglected:.1e}): ")?;
        if *added > 0.0 {
            write!(
                f,
                "{added:.1e} of amplitude² added to the diagonal, the floor of {floor:.1e} below which rounding would decide the likelihood: \
                 less noise than that was asked for, or fits the data"
            )
        } else {
            write!(f, "noise is {relative_noise:.1e} of amplitude², above the floor of {floor:.1e}: nothing added")
        }
    }
}
