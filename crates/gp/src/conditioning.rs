//! What stands on the kernel matrix's diagonal, and why.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The default floor of the relative noise, in units of n ε.
///
/// The kernel values carry rounding of about ε each; as a matrix that is an error of up to n ε in the eigenvalues. A diagonal of ρ ≥ n ε
/// keeps C positive definite whatever the rounding and the likelihood known to about a nat; below it, the likelihood keeps rising as ρ
/// falls but measures rounding, not the data.
const FLOOR_PER_SAMPLE: f64 = f64::EPSILON;

/// The least relative noise for `samples` samples.
pub(crate) fn floor(samples: usize) -> f64 {
    FLOOR_PER_SAMPLE * samples as f64
}

/// How the kernel matrix was conditioned: what was added to its diagonal, and why.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conditioning {
    /// Number of samples n, the size of the kernel matrix.
    pub samples: usize,
    /// Numerical rank found: pivots of the factorisation, or n if it was factored in full.
    pub rank: usize,
    /// What stands on the diagonal in all, as a share of amplitude²: the noise and what was added.
    pub relative_noise: f64,
    /// The least share allowed: n ε, or more if the options ask for more.
    pub floor: f64,
    /// The part of `relative_noise` that neither the caller nor the data asked for; 0 if the noise is above the floor.
    pub added: f64,
    /// Trace of what the factor of rank `rank` leaves of the kernel matrix, as a share of amplitude²: bounds its largest eigenvalue.
    pub neglected: f64,
    /// Of an approximation by inducing points (then `rank` of them): how far the bound that was maximised can be below the
    /// exact log marginal likelihood at these hyperparameters, nats. Absent if nothing was approximated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub likelihood_gap: Option<f64>,
}

impl fmt::Display for Conditioning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            samples,
            rank,
            relative_noise,
            floor,
            added,
            neglected,
            likelihood_gap,
        } = self;
        if let Some(gap) = likelihood_gap {
            let share = neglected / *samples as f64;
            write!(
                f,
                "{rank} inducing points (variational free energy) leave {share:.1e} of the prior variance at the {samples} samples, and \
                 the exact log marginal likelihood is at most {gap:.3} nats higher; "
            )?;
        }
        write!(
            f,
            "kernel matrix of {samples} samples, numerical rank {rank} (neglected trace {neglected:.1e}): "
        )?;
        if *added > 0.0 {
            write!(
                f,
                "{added:.1e} of amplitude² added to the diagonal, the floor of {floor:.1e} below which rounding would decide the likelihood: \
                 less noise than that was asked for, or fits the data"
            )
        } else {
            write!(
                f,
                "noise is {relative_noise:.1e} of amplitude², above the floor of {floor:.1e}: nothing added"
            )
        }
    }
}
