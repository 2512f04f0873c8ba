//! The gain of columns on several joints, on recordings that they were not fitted to.

use nalgebra::{DMatrix, DVector};

use super::{ColumnPrior, Normal, Stretch, extended, gram, residual_square};
use crate::regression::fit::Products;
use crate::regression::table::Table;

/// A fit on all joints without each group of recordings in turn, to which columns are added.
pub struct ArmLeftOut<'a> {
    /// The fitted columns of the table.
    columns: &'a [usize],
    joints: Vec<OfJoint<'a>>,
    /// The weights of the joints where rows count as evidence.
    weights: Vec<f64>,
    prior: ColumnPrior,
    /// For each group, the inner products over the others, y last, and the fit to them.
    folds: Vec<(DMatrix<f64>, Normal)>,
    /// Minus the logarithm of the likelihood where it was not fitted (nats).
    outside: f64,
}

/// The columns of a joint.
struct OfJoint<'a> {
    groups: Vec<Vec<&'a Stretch>>,
    /// Which columns act on it, and their places.
    mine: Vec<usize>,
    places: Vec<usize>,
    /// Inner products over each group, y last.
    folds: Vec<DMatrix<f64>>,
}

impl OfJoint<'_> {
    /// These and the columns `added`, the first of which has the number `first`; those that act on `joint`.
    fn with(&self, table: &Table, joint: usize, first: usize, added: &[usize]) -> Self {
        let place = |(k, &column): (usize, &usize)| Some((first + k, table.place[joint][column]?));
        let (new, new_places): (Vec<usize>, Vec<usize>) = added.iter().enumerate().filter_map(place).unzip();
        let places = [&self.places[..], &new_places].concat();
        let folds = self.groups.iter().zip(&self.folds).map(|(group, known)| extended(group, known, &places)).collect();
        Self { groups: Vec::new(), mine: [&self.mine[..], &new].concat(), places, folds }
    }

    /// Adds the weighted products over all groups but `fold` to those of all joints, of the columns from `first` on with all others and
    /// with y, which comes last.
    fn add_without(&self, fold: usize, weight: f64, first: usize, gram: &mut DMatrix<f64>) {
        let last = gram.nrows() - 1;
        let count = self.mine.len();
        let at = |k: usize| self.mine.get(k).copied().unwrap_or(last);
        let is_new = |k: usize| k < count && self.mine[k] >= first;
        for other in (0..self.folds.len()).filter(|&other| other != fold) {
            for i in 0..=count {
                for k in (0..=count).filter(|&k| first == 0 || is_new(i) || is_new(k)) {
                    gram[(at(i), at(k))] += weight * self.folds[other][(i, k)];
                }
            }
        }
    }
}

impl Products {
    /// The fit of `columns` on all joints for [`Self::arm_gain`]; `weights` are those of the joints. The background comes first.
    pub fn arm_left_out<'a>(&self, table: &'a Table, columns: &'a [usize], weights: &[f64]) -> ArmLeftOut<'a> {
        let of = |joint: usize| {
            let mine: Vec<usize> = (0..columns.len()).filter(|&i| table.place[joint][columns[i]].is_some()).collect();
            let places: Vec<usize> = mine.iter().filter_map(|&i| table.place[joint][columns[i]]).collect();
            let groups = self.groups(table, joint, true);
            let folds = groups.iter().map(|group| gram(group, &places)).collect();
            OfJoint { groups, mine, places, folds }
        };
        let joints: Vec<OfJoint<'_>> = (0..table.dof()).map(of).collect();
        let (p, prior) = (columns.len(), self.prior(|_| true, 1.0));
        let weights = self.evidence_weights(weights);
        let count = joints.iter().map(|joint| joint.folds.len()).max().unwrap_or(0);
        let without = |fold: usize| {
            let mut gram = DMatrix::zeros(p + 1, p + 1);
            for (joint, &weight) in joints.iter().zip(&weights) {
                joint.add_without(fold, weight, 0, &mut gram);
            }
            let fit = Normal::new(&gram, p, &prior);
            (gram, fit)
        };
        // With one group, nothing is left out.
        let folds: Vec<(DMatrix<f64>, Normal)> = if count < 2 { Vec::new() } else { (0..count).map(without).collect() };
        let solutions = folds.iter().map(|(gram, fit)| fit.solution(gram, &prior));
        let outside = self.loss(&rss_outside(&joints, solutions));
        ArmLeftOut { columns, joints, weights, prior, folds, outside }
    }

    /// The gain of `added` columns that act on several joints, in addition to those of `base`, where they were not fitted (nats).
    pub fn arm_gain(&self, table: &Table, base: &ArmLeftOut<'_>, added: &[usize]) -> f64 {
        if base.folds.is_empty() {
            return 0.0;
        }
        let known = base.columns.len();
        let new: Vec<usize> = added.iter().copied().filter(|column| !base.columns.contains(column)).collect();
        let p = known + new.len();
        let joints = base.joints.iter().enumerate();
        let joints: Vec<OfJoint<'_>> =
            joints.map(|(joint, of_joint)| of_joint.with(table, joint, known, &new)).collect();
        let solutions = base.folds.iter().enumerate().map(|(fold, (before, fit))| {
            let mut gram = DMatrix::zeros(p + 1, p + 1);
            let place = |i: usize| if i < known { i } else { p };
            for i in 0..=known {
                for k in 0..=known {
                    gram[(place(i), place(k))] = before[(i, k)];
                }
            }
            for (joint, &weight) in joints.iter().zip(&base.weights) {
                joint.add_without(fold, weight, known, &mut gram);
            }
            fit.with(&gram, p, &base.prior).solution(&gram, &base.prior)
        });
        base.outside - self.loss(&rss_outside(&joints, solutions))
    }
}

/// The residual sum of squares of each joint, over each group with the solution without it.
fn rss_outside(joints: &[OfJoint<'_>], solutions: impl Iterator<Item = DVector<f64>>) -> Vec<f64> {
    let mut rss = vec![0.0; joints.len()];
    for (fold, solution) in solutions.enumerate() {
        for (joint, rss) in joints.iter().zip(&mut rss) {
            if let Some(gram) = joint.folds.get(fold) {
                let own = joint.mine.iter().map(|&i| solution[i]);
                *rss += residual_square(gram, &DVector::from_iterator(joint.mine.len(), own));
            }
        }
    }
    rss
}
