//! The search for the best motion: L-BFGS from a few starts, with penalties that are increased.

use std::sync::atomic::{AtomicU64, Ordering};

use gp::Descent;

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
) -> Result<Vec<f64>, String> {
    let iterations = |list: &[(f64, u64)]| list.iter().map(|(_, count)| *count).sum::<u64>() as f64;
    let total = EVALUATIONS * (starts.len() as f64 * iterations(&EACH) + iterations(&BEST));
    let done = AtomicU64::new(0);
    let objective = |at: &[f64], hardness: f64| {
        let found = criterion.evaluate(at, hardness);
        progress((done.fetch_add(1, Ordering::Relaxed) as f64 / total).min(1.0));
        found
    };
    let mut found: Option<(f64, Vec<f64>)> = None;
    let count = starts.len();
    for (number, mut at) in starts.into_iter().enumerate() {
        let mut value = f64::INFINITY;
        for (hardness, most) in EACH {
            (value, at) = descend(&objective, at, hardness, most)?;
        }
        if found.as_ref().is_none_or(|(least, _)| value < *least) {
            found = Some((value, at));
        }
        done.store((EVALUATIONS * (number + 1) as f64 * iterations(&EACH)) as u64, Ordering::Relaxed);
    }
    let (_, mut at) = found.ok_or_else(|| format!("none of {count} starts led to a motion"))?;
    for (hardness, most) in BEST {
        (_, at) = descend(&objective, at, hardness, most)?;
    }
    progress(1.0);
    Ok(at)
}

type Objective<'a> = dyn Fn(&[f64], f64) -> (f64, Vec<f64>) + 'a;

/// The lowest value on the descent from `start`, and its coefficients.
fn descend(objective: &Objective<'_>, start: Vec<f64>, hardness: f64, most: u64) -> Result<(f64, Vec<f64>), String> {
    let descent = Descent::new(
        PATIENCE,
        |_| NO_GAIN,
        |at| {
            let (value, gradient) = objective(at, hardness);
            let is_finite = value.is_finite() && gradient.iter().all(|slope| slope.is_finite());
            is_finite.then_some((value, gradient)).ok_or("the criterion is not finite")
        },
    );
    descent.look(&start)?;
    // The end of the line search is an error; the best point so far is the result.
    descent.run(&start, MEMORY, 1.0, most)?;
    Ok(descent.best().unwrap_or((f64::INFINITY, start)))
}
