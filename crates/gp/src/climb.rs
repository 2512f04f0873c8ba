//! L-BFGS with exact gradients, on likelihoods that are rough with rounding where there is little noise.

use std::cell::RefCell;

use argmin::core::{CostFunction, Error, Executor, Gradient, State};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;

use crate::algebra::sum_of_squares;
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

    /// The gain below which two likelihoods near `free` count as equal, nats.
    fn negligible(&self, free: &[f64]) -> f64;
}

/// A likelihood with the points at which it was evaluated.
struct Climb<'a, L> {
    likelihood: &'a L,
    /// The last point asked for (the search asks for value and gradient separately), and the best one.
    seen: RefCell<Seen>,
}

struct Seen {
    last: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
    best: f64,
    best_at: Vec<f64>,
    /// The tolerance plus the rounding error of one likelihood near the floor of ρ, nats.
    negligible: f64,
    /// Points looked at since the last gain that was not negligible.
    stalled: usize,
}

impl Default for Seen {
    fn default() -> Self {
        Self {
            last: Vec::new(),
            value: f64::NAN,
            gradient: Vec::new(),
            best: f64::NEG_INFINITY,
            best_at: Vec::new(),
            negligible: 0.0,
            stalled: 0,
        }
    }
}

/// Climbs from `start` to a maximum: its value and place.
///
/// The value kept is the best one met, so that a line search that ends in rounding loses nothing. The search is taken up again from
/// there, with its memory cleared, for as long as that gains anything.
pub(crate) fn climb(
    likelihood: &impl Likelihood,
    start: &[f64],
    max_iterations: u64,
) -> Result<(f64, Vec<f64>), GpError> {
    let climb = Climb { likelihood, seen: RefCell::default() };
    let mut best = (f64::NEG_INFINITY, start.to_vec());
    let mut left = max_iterations;
    while left > 0 {
        // A search cannot begin where the likelihood is not finite.
        if climb.look(&best.1).is_err() {
            break;
        }
        let steepness = sum_of_squares(&climb.seen.borrow().gradient).sqrt();
        // Of order one; and the first step, which is the gradient itself, no longer than one in the logarithms.
        let divisor = steepness.max(likelihood.observations());
        climb.seen.borrow_mut().stalled = 0;
        let solver = solver().map_err(|error| GpError::Search(error.to_string()))?;
        let problem = Scaled { climb: &climb, divisor };
        let run = Executor::new(problem, solver)
            .configure(|state| state.param(best.1.clone()).max_iters(left))
            .ctrlc(false)
            .timer(false)
            .run();
        // An error is the search's own end, with the best point seen.
        let used = run.map_or(left, |run| run.state.get_iter() + 1);
        left = left.saturating_sub(used);
        let seen = climb.seen.borrow();
        let gained = seen.best - best.0;
        best = (seen.best, seen.best_at.clone());
        if gained <= seen.negligible || climb.stalled() {
            break;
        }
    }
    Ok(best)
}

impl<L: Likelihood> Climb<'_, L> {
    /// Makes `seen` hold value and gradient at `free`.
    fn look(&self, free: &[f64]) -> Result<(), Error> {
        if self.seen.borrow().last == free {
            return Ok(());
        }
        if self.stalled() {
            return Err(Error::msg("no more to gain"));
        }
        let Some((value, gradient)) = self.likelihood.value_and_gradient(free) else {
            return Err(Error::msg("the likelihood is not finite"));
        };
        let mut seen = self.seen.borrow_mut();
        seen.negligible = self.likelihood.negligible(free);
        if value > seen.best + seen.negligible {
            seen.stalled = 0;
        } else {
            seen.stalled += 1;
        }
        if value > seen.best {
            seen.best = value;
            seen.best_at = free.to_vec();
        }
        seen.last = free.to_vec();
        seen.value = value;
        seen.gradient = gradient;
        Ok(())
    }

    fn stalled(&self) -> bool {
        let seen = self.seen.borrow();
        seen.stalled >= PATIENCE + seen.last.len()
    }
}

type Solver = LBFGS<MoreThuenteLineSearch<Vec<f64>, Vec<f64>, f64>, Vec<f64>, Vec<f64>, f64>;

/// L-BFGS, for a function whose gradient is of order one.
fn solver() -> Result<Solver, Error> {
    let line_search = MoreThuenteLineSearch::new().with_width_tolerance(0.02)?;
    LBFGS::new(line_search, MEMORY).with_tolerance_grad(1e-6)?.with_tolerance_cost(1e-9)
}

/// The problem as argmin wants it: owned by the executor, minimised, of order one.
struct Scaled<'a, 'b, L> {
    climb: &'a Climb<'b, L>,
    divisor: f64,
}

impl<L: Likelihood> CostFunction for Scaled<'_, '_, L> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, free: &Vec<f64>) -> Result<f64, Error> {
        self.climb.look(free)?;
        Ok(-self.climb.seen.borrow().value / self.divisor)
    }
}

impl<L: Likelihood> Gradient for Scaled<'_, '_, L> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, free: &Vec<f64>) -> Result<Vec<f64>, Error> {
        self.climb.look(free)?;
        let seen = self.climb.seen.borrow();
        Ok(seen.gradient.iter().map(|g| -g / self.divisor).collect())
    }
}
