//! The climb to a maximum of a likelihood, which is rough with rounding where there is little noise.

use std::cell::Cell;

use crate::algebra::sum_of_squares;
use crate::descent::Descent;
use crate::error::GpError;

/// Points looked at in vain, beyond the number of parameters, before a search ends. Near the floor of ρ the likelihood is rough with
/// rounding, where a line search, which takes it to be smooth, would never end.
const PATIENCE: usize = 5;

/// Steps L-BFGS remembers.
const MEMORY: usize = 10;

/// A log likelihood of free parameters.
pub(crate) trait Likelihood {
    /// Value and gradient; `None` where they are not finite.
    fn value_and_gradient(&self, free: &[f64]) -> Option<(f64, Vec<f64>)>;

    /// The number of observations, by which the likelihood is divided to be of order one.
    fn observations(&self) -> f64;

    /// The gain below which two likelihoods near `free` count as equal, nats: the tolerance plus the rounding error of one likelihood
    /// near the floor of ρ.
    fn negligible(&self, free: &[f64]) -> f64;
}

/// Climbs from `start` to a maximum: its value and place.
///
/// The search is taken up again from the best point met, with its memory cleared, for as long as that gains anything.
pub(crate) fn climb(
    likelihood: &impl Likelihood,
    start: &[f64],
    max_iterations: u64,
) -> Result<(f64, Vec<f64>), GpError> {
    let negligible = Cell::new(0.0);
    let of = |free: &[f64]| {
        negligible.set(likelihood.negligible(free));
        negligible.get()
    };
    let descent = Descent::new(PATIENCE + start.len(), of, |free: &[f64]| {
        let (value, gradient) = likelihood.value_and_gradient(free).ok_or("the likelihood is not finite")?;
        Ok((-value, gradient.iter().map(|slope| -slope).collect()))
    });
    let mut best = (f64::NEG_INFINITY, start.to_vec());
    let mut left = max_iterations;
    while left > 0 {
        // A search cannot begin where the likelihood is not finite.
        let Ok(gradient) = descent.look(&best.1) else { break };
        // Of order one; and the first step, which is the gradient itself, no longer than one in the logarithms.
        let divisor = sum_of_squares(&gradient).sqrt().max(likelihood.observations());
        let used = descent.run(&best.1, MEMORY, divisor, left).map_err(GpError::Search)?;
        left = left.saturating_sub(used);
        let Some((least, at)) = descent.best() else { break };
        let gained = -least - best.0;
        best = (-least, at);
        if gained <= negligible.get() || descent.is_stalled() {
            break;
        }
    }
    Ok(best)
}
