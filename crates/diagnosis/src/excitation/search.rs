//! The search for the best motion: L-BFGS from a few starts, with penalties that are increased.

use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};

use argmin::core::{CostFunction, Error, Executor, Gradient};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;

use super::criterion::Criterion;

/// The weight of the penalties, and the number of iterations with it: for every start, then for the best.
const EACH: [(f64, u64); 2] = [(30.0, 40), (300.0, 40)];
const BEST: [(f64, u64); 2] = [(1000.0, 60), (10_000.0, 60)];
/// The number of steps that L-BFGS stores.
const MEMORY: usize = 12;
/// The number of evaluations without a gain after which a search ends, and the largest reduction that counts as no gain.
const PATIENCE: usize = 25;
const NO_GAIN: f64 = 1e-5;
/// The approximate number of evaluations per iteration.
const EVALUATIONS: f64 = 1.15;

/// The best motion that the search finds from `starts`.
///
/// # Errors
/// If the search cannot be set up.
pub fn best(
    criterion: &Criterion<'_>,
    starts: Vec<Vec<f64>>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Vec<f64>, Error> {
    let iterations = |list: &[(f64, u64)]| list.iter().map(|(_, count)| *count).sum::<u64>() as f64;
    let total = EVALUATIONS * (starts.len() as f64 * iterations(&EACH) + iterations(&BEST));
    let done = AtomicU64::new(0);
    let look = |at: &[f64], hardness: f64| {
        let found = criterion.look(at, hardness);
        progress((done.fetch_add(1, Ordering::Relaxed) as f64 / total).min(1.0));
        found
    };
    let mut found: Option<(f64, Vec<f64>)> = None;
    let count = starts.len();
    for (number, mut at) in starts.into_iter().enumerate() {
        let mut value = f64::INFINITY;
        for (hardness, most) in EACH {
            (value, at) = descend(&look, at, hardness, most)?;
        }
        if found.as_ref().is_none_or(|(least, _)| value < *least) {
            found = Some((value, at));
        }
        done.store((EVALUATIONS * (number + 1) as f64 * iterations(&EACH)) as u64, Ordering::Relaxed);
    }
    let (_, mut at) = found.ok_or_else(|| Error::msg(format!("none of {count} starts led to a motion")))?;
    for (hardness, most) in BEST {
        (_, at) = descend(&look, at, hardness, most)?;
    }
    progress(1.0);
    Ok(at)
}

type Look<'a> = dyn Fn(&[f64], f64) -> (f64, Vec<f64>) + 'a;

/// The lowest value on the descent from `start`, and its coefficients.
fn descend(look: &Look<'_>, start: Vec<f64>, hardness: f64, most: u64) -> Result<(f64, Vec<f64>), Error> {
    let problem = Problem { look, hardness, seen: RefCell::default() };
    problem.look(&start)?;
    let line_search = MoreThuenteLineSearch::new().with_width_tolerance(0.02)?;
    let solver = LBFGS::new(line_search, MEMORY).with_tolerance_grad(1e-6)?.with_tolerance_cost(1e-9)?;
    let seen = &problem.seen;
    let run = Executor::new(Borrowed(&problem), solver)
        .configure(|state| state.param(start.clone()).max_iters(most))
        .ctrlc(false)
        .timer(false)
        .run();
    // An error is the end of the line search; the best point so far is the result.
    drop(run);
    let seen = seen.borrow();
    Ok((seen.best, seen.best_at.clone()))
}

struct Problem<'a> {
    look: &'a Look<'a>,
    hardness: f64,
    seen: RefCell<Seen>,
}

/// The last evaluated point (argmin asks for value and gradient separately), and the best one.
struct Seen {
    last: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
    best: f64,
    best_at: Vec<f64>,
    stalled: usize,
}

impl Default for Seen {
    fn default() -> Self {
        Self {
            last: Vec::new(),
            value: f64::NAN,
            gradient: Vec::new(),
            best: f64::INFINITY,
            best_at: Vec::new(),
            stalled: 0,
        }
    }
}

impl Problem<'_> {
    /// Evaluates value and gradient at `at` and stores them in `seen`.
    fn look(&self, at: &[f64]) -> Result<(), Error> {
        let mut seen = self.seen.borrow_mut();
        if seen.last == at {
            return Ok(());
        }
        if seen.stalled >= PATIENCE {
            return Err(Error::msg("no more to gain"));
        }
        let (value, gradient) = (self.look)(at, self.hardness);
        if !value.is_finite() || gradient.iter().any(|slope| !slope.is_finite()) {
            return Err(Error::msg("the criterion is not finite"));
        }
        seen.stalled = if value < seen.best - NO_GAIN { 0 } else { seen.stalled + 1 };
        if value < seen.best {
            seen.best = value;
            seen.best_at = at.to_vec();
        }
        seen.last = at.to_vec();
        seen.value = value;
        seen.gradient = gradient;
        Ok(())
    }
}

/// The problem in the form that argmin's executor owns.
struct Borrowed<'a, 'b>(&'a Problem<'b>);

impl CostFunction for Borrowed<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, at: &Vec<f64>) -> Result<f64, Error> {
        self.0.look(at)?;
        Ok(self.0.seen.borrow().value)
    }
}

impl Gradient for Borrowed<'_, '_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, at: &Vec<f64>) -> Result<Vec<f64>, Error> {
        self.0.look(at)?;
        Ok(self.0.seen.borrow().gradient.clone())
    }
}
