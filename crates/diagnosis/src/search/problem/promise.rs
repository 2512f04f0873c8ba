//! The gains that candidates promise before they are fitted.

use rayon::prelude::*;

use super::{Problem, Selection};
use crate::regression::fit::Reduced;

impl Problem<'_> {
    /// The first-order gain of each of the candidates `free` in addition to `selected` (nats, minus the costs), with its index.
    pub fn promises(&self, selected: &Selection, free: &[usize]) -> Vec<(f64, usize)> {
        let mut columns: Vec<usize> = free.iter().flat_map(|&c| self.new_columns(selected, c)).collect();
        columns.sort_unstable();
        columns.dedup();
        let reduced = self.products.reduced(self.table, &selected.fit, &columns);
        free.par_iter().map(|&candidate| (self.promise(selected, candidate, &reduced), candidate)).collect()
    }

    /// The columns of `candidate` that `selected` does not have.
    fn new_columns(&self, selected: &Selection, candidate: usize) -> Vec<usize> {
        let have = &selected.fit.columns;
        let columns = self.candidates[candidate].columns.iter().copied();
        columns.filter(|c| have.binary_search(c).is_err()).collect()
    }

    /// The first-order gain of `candidate` in addition to `selected` (nats, minus the costs). Its columns are among those that are
    /// `reduced`.
    fn promise(&self, selected: &Selection, candidate: usize, reduced: &Reduced) -> f64 {
        let new = self.new_columns(selected, candidate);
        if new.is_empty() {
            return f64::NEG_INFINITY;
        }
        let (drop, coefficient) = self.products.drop(self.table, &selected.fit, &new, reduced);
        let own = &self.candidates[candidate];
        let misfit = if new[0] == own.columns[0] { self.misfit_of(own, coefficient) } else { 0.0 };
        let cost = own.cost - self.thresholds.per_coefficient * (own.columns.len() - new.len()) as f64;
        let log = |drop: f64, joint: usize| {
            let count = self.products.count[joint].max(1.0);
            -0.5 * self.products.evidence[joint] * (1.0 - (drop / count).min(0.999_999)).ln()
        };
        let gain = match own.joint {
            Some(joint) => log(drop, joint),
            // The promise is at least the gain of a reduction that is distributed evenly over the joints.
            None => {
                let joints = self.products.count.len();
                (0..joints).map(|joint| log(drop / joints as f64, joint)).sum::<f64>()
            }
        };
        gain - cost - misfit
    }
}
