//! L-BFGS with exact gradients, on functions that are rough with rounding.

use std::cell::RefCell;

use argmin::core::{CostFunction, Error, Executor, Gradient, State};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;

/// A function that is to be minimised, with the points at which it was evaluated.
///
/// The best point met is kept, so that a line search that ends in rounding loses nothing.
pub struct Descent<F, N> {
    function: F,
    negligible: N,
    patience: usize,
    seen: RefCell<Seen>,
}

/// The last point asked for (the search asks for value and gradient separately), and the best one.
#[derive(Default)]
struct Seen {
    last: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
    best: Option<(f64, Vec<f64>)>,
    /// Points looked at since the last gain that was not negligible.
    stalled: usize,
}

impl<F, N> Descent<F, N>
where
    F: Fn(&[f64]) -> Result<(f64, Vec<f64>), &'static str>,
    N: Fn(&[f64]) -> f64,
{
    /// A search for the minimum of `function`, which gives value and gradient, or says why it has none. It ends after `patience`
    /// points without a gain that is larger than `negligible` near them.
    pub fn new(patience: usize, negligible: N, function: F) -> Self {
        Self { function, negligible, patience, seen: RefCell::default() }
    }

    /// Evaluates the function at a point, if it was not the last one; returns the gradient.
    ///
    /// # Errors
    /// If the function has no value there, or if there is no more to gain.
    pub fn look(&self, at: &[f64]) -> Result<Vec<f64>, String> {
        let mut seen = self.seen.borrow_mut();
        if seen.last != at {
            if seen.stalled >= self.patience {
                return Err("no more to gain".to_owned());
            }
            let (value, gradient) = (self.function)(at)?;
            let best = seen.best.as_ref().map_or(f64::INFINITY, |(best, _)| *best);
            seen.stalled = if value < best - (self.negligible)(at) { 0 } else { seen.stalled + 1 };
            if value < best {
                seen.best = Some((value, at.to_vec()));
            }
            (seen.last, seen.value, seen.gradient) = (at.to_vec(), value, gradient);
        }
        Ok(seen.gradient.clone())
    }

    /// The least value met, and its place.
    pub fn best(&self) -> Option<(f64, Vec<f64>)> {
        self.seen.borrow().best.clone()
    }

    /// Whether the search has ended, because there was no more to gain.
    pub fn is_stalled(&self) -> bool {
        self.seen.borrow().stalled >= self.patience
    }

    /// Searches from `start`, remembering `memory` steps, for at most `most` iterations; returns how many it took, or `most` where its
    /// line search failed. The function over `divisor` is of order one.
    ///
    /// # Errors
    /// If the search cannot be set up.
    pub fn run(&self, start: &[f64], memory: usize, divisor: f64, most: u64) -> Result<u64, String> {
        self.seen.borrow_mut().stalled = 0;
        let run = MoreThuenteLineSearch::new().with_width_tolerance(0.02).and_then(|line_search| {
            let solver = LBFGS::new(line_search, memory).with_tolerance_grad(1e-6)?.with_tolerance_cost(1e-9)?;
            let executor = Executor::new(Scaled { descent: self, divisor }, solver);
            Ok(executor.configure(|state| state.param(start.to_vec()).max_iters(most)).ctrlc(false).timer(false))
        });
        let run = run.map_err(|error| error.to_string())?.run();
        Ok(run.map_or(most, |run| run.state.get_iter() + 1))
    }
}

/// The problem as argmin wants it: owned by the executor, of order one.
struct Scaled<'a, F, N> {
    descent: &'a Descent<F, N>,
    divisor: f64,
}

impl<F, N> CostFunction for Scaled<'_, F, N>
where
    F: Fn(&[f64]) -> Result<(f64, Vec<f64>), &'static str>,
    N: Fn(&[f64]) -> f64,
{
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, at: &Vec<f64>) -> Result<f64, Error> {
        self.descent.look(at).map_err(Error::msg)?;
        Ok(self.descent.seen.borrow().value / self.divisor)
    }
}

impl<F, N> Gradient for Scaled<'_, F, N>
where
    F: Fn(&[f64]) -> Result<(f64, Vec<f64>), &'static str>,
    N: Fn(&[f64]) -> f64,
{
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, at: &Vec<f64>) -> Result<Vec<f64>, Error> {
        let gradient = self.descent.look(at).map_err(Error::msg)?;
        Ok(gradient.iter().map(|slope| slope / self.divisor).collect())
    }
}
