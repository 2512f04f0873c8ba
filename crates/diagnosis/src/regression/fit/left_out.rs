//! The gain of columns on recordings that they were not fitted to.

use nalgebra::{DMatrix, DVector};

use super::{Products, cholesky, solved};
use crate::regression::table::{Stretch, Table};
use crate::thresholds::RECORDING_GROUPS;

impl Products {
    /// The gain of `added` columns in addition to `columns` on `joint` (nats): where they were fitted, and on groups of
    /// recordings left out in turn, or on stretches of the only recording. `weights` are those of the joints; if there is a
    /// background, it comes first in `columns` and keeps its prior.
    pub fn gains(
        &self,
        table: &Table,
        joint: usize,
        columns: &[usize],
        added: &[usize],
        weights: &[f64],
    ) -> (f64, f64) {
        let place = |&column: &usize| table.place[joint][column];
        let mut with: Vec<usize> = columns.iter().filter_map(place).collect();
        let without = with.len();
        with.extend(
            added
                .iter()
                .filter(|column| !columns.contains(column))
                .filter_map(place),
        );
        let folds = self.folds(table, joint, &with, false);
        if folds.len() < 2 {
            return (0.0, 0.0);
        }
        let scale = weights[joint] * self.evidence_per_row(joint);
        let prior = self.prior(|column| table.place[joint][column].is_some(), scale);
        let all = folds.iter().skip(1).fold(folds[0].clone(), |sum, fold| sum + fold);
        let inside = |p: usize| left(&all, &solution(&all, p, &prior));
        let rest = |fold: &DMatrix<f64>, p: usize| solution(&(&all - fold), p, &prior);
        let outside = |p: usize| -> f64 { folds.iter().map(|fold| left(fold, &rest(fold, p))).sum() };
        let gain = |left: &dyn Fn(usize) -> f64| {
            self.joint_loss(joint, left(without)) - self.joint_loss(joint, left(with.len()))
        };
        (gain(&inside), gain(&outside))
    }

    /// The gain of `added` columns that act on several joints where they were not fitted (nats); `weights` are those of the
    /// joints.
    pub fn arm_gain(&self, table: &Table, columns: &[usize], added: &[usize], weights: &[f64]) -> f64 {
        let mut all: Vec<usize> = columns.to_vec();
        all.extend(added.iter().filter(|column| !columns.contains(column)));
        // Each joint's columns, and their inner products over each group.
        let joints: Vec<(Vec<usize>, Vec<DMatrix<f64>>)> = (0..table.dof())
            .map(|joint| {
                let mine: Vec<usize> = (0..all.len())
                    .filter(|&i| table.place[joint][all[i]].is_some())
                    .collect();
                let places: Vec<usize> = mine.iter().filter_map(|&i| table.place[joint][all[i]]).collect();
                let folds = self.folds(table, joint, &places, true);
                (mine, folds)
            })
            .collect();
        let count = joints.iter().map(|(_, folds)| folds.len()).max().unwrap_or(0);
        if count < 2 {
            return 0.0;
        }
        let prior = self.prior(|_| true, 1.0);
        let weights = self.evidence_weights(weights);
        let outside = |p: usize| -> f64 {
            let mut rss = vec![0.0; joints.len()];
            for fold in 0..count {
                let mut gram = DMatrix::<f64>::zeros(p + 1, p + 1);
                for ((mine, folds), weight) in joints.iter().zip(&weights) {
                    let at = |k: usize| mine.get(k).copied().unwrap_or(p);
                    for other in (0..folds.len()).filter(|&other| other != fold) {
                        for i in (0..=mine.len()).filter(|&i| i == mine.len() || mine[i] < p) {
                            for k in (0..=mine.len()).filter(|&k| k == mine.len() || mine[k] < p) {
                                gram[(at(i), at(k))] += weight * folds[other][(i, k)];
                            }
                        }
                    }
                }
                let solved = solution(&gram, p, &prior);
                for ((mine, folds), rss) in joints.iter().zip(&mut rss) {
                    if let Some(gram) = folds.get(fold) {
                        let own = DVector::from_iterator(
                            mine.len(),
                            mine.iter().map(|&i| if i < p { solved[i] } else { 0.0 }),
                        );
                        *rss += left(gram, &own);
                    }
                }
            }
            self.loss(&rss)
        };
        outside(columns.len()) - outside(all.len())
    }

    /// The precision of the background's columns that `acts` selects, where sums of squares are weighted by `scale`.
    fn prior(&self, acts: impl Fn(usize) -> bool, scale: f64) -> DMatrix<f64> {
        let Some(background) = &self.background else {
            return DMatrix::zeros(0, 0);
        };
        let mine: Vec<usize> = (0..background.columns.len())
            .filter(|&k| acts(background.columns[k]))
            .collect();
        let entry = |i: usize, k: usize| background.precision[(mine[i], mine[k])] / scale;
        DMatrix::from_fn(mine.len(), mine.len(), entry)
    }

    /// Inner products of a joint's columns at `places` and, last, of y, over each of several groups of recordings, or over
    /// stretches if there is only one. With `common`, the groups are the same on all joints.
    fn folds(&self, table: &Table, joint: usize, places: &[usize], common: bool) -> Vec<DMatrix<f64>> {
        let this = &table.joints[joint];
        let p = places.len();
        let excited: Vec<usize> = self
            .recordings
            .iter()
            .copied()
            .filter(|&r| common || this.count[r] > 0)
            .collect();
        let of = |recording: usize| {
            this.stretches
                .iter()
                .filter(move |stretch| stretch.recording == recording)
        };
        let folds: Vec<Vec<&Stretch>> = if let [only] = excited[..] {
            of(only).map(|stretch| vec![stretch]).collect()
        } else {
            let count = excited.len().min(RECORDING_GROUPS);
            let fold = |k: usize| excited.iter().skip(k).step_by(count).flat_map(|&r| of(r)).collect();
            (0..count).map(fold).collect()
        };
        folds
            .iter()
            .map(|stretches| {
                DMatrix::from_fn(p + 1, p + 1, |i, k| {
                    stretches
                        .iter()
                        .map(|stretch| match (i < p, k < p) {
                            (true, true) => stretch.gram.of(places[i], places[k]),
                            (true, false) => stretch.gram.with_y(places[i]),
                            (false, true) => stretch.gram.with_y(places[k]),
                            (false, false) => stretch.gram.y_square(),
                        })
                        .sum()
                })
            })
            .collect()
    }
}

/// The coefficients of the first `p` columns, from inner products of columns and, last, of y; `prior` is the precision of the
/// first of them.
fn solution(gram: &DMatrix<f64>, p: usize, prior: &DMatrix<f64>) -> DVector<f64> {
    let last = gram.nrows() - 1;
    let known = prior.nrows();
    let entry = |i: usize, k: usize| {
        let own = if i < known && k < known { prior[(i, k)] } else { 0.0 };
        gram[(i, k)] + own
    };
    let scale: Vec<f64> = (0..p).map(|i| entry(i, i).max(0.0).sqrt().max(1e-150)).collect();
    let matrix = DMatrix::from_fn(p, p, |i, k| entry(i, k) / (scale[i] * scale[k]));
    let right = DVector::from_fn(p, |i, _| gram[(i, last)] / scale[i]);
    let [_, scaled] = solved(&cholesky(&matrix), &right);
    DVector::from_fn(p, |i, _| scaled[i] / scale[i])
}

/// The residual sum of squares with coefficients of the first columns.
fn left(gram: &DMatrix<f64>, coefficients: &DVector<f64>) -> f64 {
    let (p, last) = (coefficients.len(), gram.nrows() - 1);
    let mut rss = gram[(last, last)];
    for i in 0..p {
        let inner: f64 = (0..p).map(|k| gram[(i, k)] * coefficients[k]).sum();
        rss += coefficients[i] * (inner - 2.0 * gram[(i, last)]);
    }
    rss.max(0.0)
}
