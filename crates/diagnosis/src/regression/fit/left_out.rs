//! The gain of columns on recordings that they were not fitted to.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::{Products, RIDGE, cholesky, solved};
use crate::regression::table::{Stretch, Table};
use crate::thresholds::{RECORDING_GROUPS, STRETCHES};

mod arm;

pub use arm::ArmLeftOut;

/// A fit on one joint, and the fits without each group of recordings in turn (cross-validation), to which columns are
/// added.
pub struct LeftOut<'a> {
    joint: usize,
    /// The fitted columns of the table, and their places on the joint.
    columns: &'a [usize],
    places: Vec<usize>,
    /// The groups, and inner products over each of them.
    groups: Vec<Vec<&'a Stretch>>,
    folds: Vec<DMatrix<f64>>,
    /// The prior of the background's columns.
    prior: ColumnPrior,
    /// The fit of all groups, then of all but one.
    fits: Vec<Normal>,
    /// The residual sums of squares where it was fitted, and on the groups left out.
    rss: [f64; 2],
}

/// The prior of the background's columns, which are the first ones: their precision K and K m, with m its centre.
struct ColumnPrior {
    precision: DMatrix<f64>,
    pull: DVector<f64>,
}

impl Products {
    /// The fit of `columns` on `joint` for [`Self::gains`]. `weights` are those of the joints; if there is a background, it comes
    /// first in `columns` and keeps its prior.
    pub fn left_out<'a>(&self, table: &'a Table, joint: usize, columns: &'a [usize], weights: &[f64]) -> LeftOut<'a> {
        let places: Vec<usize> = columns.iter().filter_map(|&column| table.place[joint][column]).collect();
        let scale = weights[joint] * self.evidence_per_row(joint);
        let mut base = LeftOut {
            joint,
            columns,
            groups: self.groups(table, joint, false),
            folds: Vec::new(),
            prior: self.prior(|column| table.place[joint][column].is_some(), scale),
            fits: Vec::new(),
            rss: [0.0; 2],
            places,
        };
        if base.groups.len() > 1 {
            base.folds = base.groups.iter().map(|group| gram(group, &base.places)).collect();
            let fit = |gram: &DMatrix<f64>| Normal::new(gram, base.places.len(), &base.prior);
            (base.fits, base.rss) = fitted(&base.folds, &base.prior, |gram, _| fit(gram));
        }
        base
    }

    /// The gain of `added` columns in addition to those of `base` (nats): where they were fitted, and on groups of recordings
    /// left out in turn, or on stretches of a recording that is alone.
    pub fn gains(&self, table: &Table, base: &LeftOut<'_>, added: &[usize]) -> (f64, f64) {
        if base.groups.len() < 2 {
            return (0.0, 0.0);
        }
        let new = added.iter().filter(|column| !base.columns.contains(column));
        let new: Vec<usize> = new.filter_map(|&column| table.place[base.joint][column]).collect();
        let with = [&base.places[..], &new].concat();
        let folds = base.groups.iter().zip(&base.folds);
        let folds: Vec<DMatrix<f64>> = folds.map(|(group, known)| extended(group, known, &with)).collect();
        let (_, rss) = fitted(&folds, &base.prior, |gram, k| base.fits[k].with(gram, with.len(), &base.prior));
        let gain = |k: usize| self.joint_loss(base.joint, base.rss[k]) - self.joint_loss(base.joint, rss[k]);
        (gain(0), gain(1))
    }

    /// The prior of the background's columns that `acts` selects, where sums of squares are weighted by `scale`.
    fn prior(&self, acts: impl Fn(usize) -> bool, scale: f64) -> ColumnPrior {
        let Some(background) = &self.background else {
            return ColumnPrior { precision: DMatrix::zeros(0, 0), pull: DVector::zeros(0) };
        };
        let mine: Vec<usize> = (0..background.columns.len()).filter(|&k| acts(background.columns[k])).collect();
        let entry = |i: usize, k: usize| background.precision[(mine[i], mine[k])] / scale;
        let precision = DMatrix::from_fn(mine.len(), mine.len(), entry);
        let centre = DVector::from_fn(mine.len(), |i, _| background.centre[mine[i]]);
        ColumnPrior { pull: &precision * centre, precision }
    }

    /// Groups of the recordings of a joint, or its stretches if there is only one. With `common`, the groups are the same on all
    /// joints. A recording that is alone on its side of a change is divided: without it, nothing would show what changed.
    fn groups<'a>(&self, table: &'a Table, joint: usize, common: bool) -> Vec<Vec<&'a Stretch>> {
        let this = &table.joints[joint];
        let of = |recording: usize| this.stretches.iter().filter(move |stretch| stretch.recording == recording);
        let is_first = |recording: usize| table.groups.get(recording).is_none_or(|&first| first == recording);
        let moves = |&r: &usize| is_first(r) && (common || of(r).next().is_some());
        let excited: Vec<usize> = self.recordings.iter().copied().filter(moves).collect();
        if let [only] = excited[..] {
            return of(only).map(|stretch| vec![stretch]).collect();
        }
        let is_before = |recording: usize| table.before.get(recording).is_some_and(|&before| before);
        let is_alone = |r: usize| excited.iter().filter(|&&other| is_before(other) == is_before(r)).count() == 1;
        let pieces = |&r: &usize| -> Vec<Vec<&'a Stretch>> {
            if is_alone(r) {
                (0..STRETCHES).map(|piece| of(r).skip(piece).step_by(STRETCHES).collect()).collect()
            } else {
                vec![of(r).collect()]
            }
        };
        let mut pieces: Vec<Vec<&Stretch>> = excited.iter().flat_map(pieces).collect();
        // If the groups are common, their numbers are those of the other joints.
        pieces.retain(|piece| common || !piece.is_empty());
        let count = pieces.len().min(RECORDING_GROUPS);
        let fold = |k: usize| pieces.iter().skip(k).step_by(count).flatten().copied().collect();
        (0..count).map(fold).collect()
    }
}

/// Inner products of a joint's columns at `places` and, last, of y, over a group.
fn gram(group: &[&Stretch], places: &[usize]) -> DMatrix<f64> {
    extended(group, &DMatrix::zeros(1, 1), places)
}

/// Inner products as of [`gram`], of which those of the first places are `known`.
fn extended(group: &[&Stretch], known: &DMatrix<f64>, places: &[usize]) -> DMatrix<f64> {
    let (p, before) = (places.len(), known.nrows() - 1);
    let mut gram = DMatrix::zeros(p + 1, p + 1);
    for k in 0..=p {
        let from = if k < before { before } else { 0 };
        if k < before {
            gram.view_mut((0, k), (before, 1)).copy_from(&known.view((0, k), (before, 1)));
        }
        for i in from..=p {
            if i < k {
                gram[(i, k)] = gram[(k, i)];
                continue;
            }
            gram[(i, k)] = group
                .iter()
                .map(|stretch| match (i < p, k < p) {
                    (true, true) => stretch.gram.of(places[i], places[k]),
                    (true, false) => stretch.gram.with_y(places[i]),
                    (false, true) => stretch.gram.with_y(places[k]),
                    (false, false) => stretch.gram.y_square(),
                })
                .sum();
        }
    }
    gram
}

/// The fits of all groups and of all but one in turn, by `fit` of their inner products, and the residual sums of squares
/// where they were fitted and on the groups left out.
fn fitted(
    folds: &[DMatrix<f64>],
    prior: &ColumnPrior,
    fit: impl Fn(&DMatrix<f64>, usize) -> Normal,
) -> (Vec<Normal>, [f64; 2]) {
    let all = folds.iter().skip(1).fold(folds[0].clone(), |sum, fold| sum + fold);
    let mut fits = vec![fit(&all, 0)];
    let inside = residual_square(&all, &fits[0].solution(&all, prior));
    let mut outside = Vec::with_capacity(folds.len());
    for (k, fold) in folds.iter().enumerate() {
        let rest = &all - fold;
        let fit = fit(&rest, k + 1);
        outside.push(residual_square(fold, &fit.solution(&rest, prior)));
        fits.push(fit);
    }
    (fits, [inside, outside.into_iter().sum()])
}

/// The normal equations of a fit: scaled and factorised.
struct Normal {
    scale: Vec<f64>,
    /// The lower Cholesky factor.
    factor: DMatrix<f64>,
}

/// An inner product, with the precision of `prior`.
fn entry(gram: &DMatrix<f64>, prior: &ColumnPrior, i: usize, k: usize) -> f64 {
    let known = prior.precision.nrows();
    let own = if i < known && k < known { prior.precision[(i, k)] } else { 0.0 };
    gram[(i, k)] + own
}

fn scale(entry: f64) -> f64 {
    entry.max(0.0).sqrt().max(1e-150)
}

impl Normal {
    /// The fit of the first `p` columns.
    fn new(gram: &DMatrix<f64>, p: usize, prior: &ColumnPrior) -> Self {
        let scale: Vec<f64> = (0..p).map(|i| scale(entry(gram, prior, i, i))).collect();
        let matrix = DMatrix::from_fn(p, p, |i, k| entry(gram, prior, i, k) / (scale[i] * scale[k]));
        Self { scale, factor: cholesky(&matrix) }
    }

    /// The fit of the first `p` columns, of which this fit has the first ones: its factor is extended by rows. The result
    /// has the bits of [`Self::new`].
    fn with(&self, gram: &DMatrix<f64>, p: usize, prior: &ColumnPrior) -> Self {
        let known = self.scale.len();
        let new = p - known;
        let mut scale = self.scale.clone();
        scale.extend((known..p).map(|i| self::scale(entry(gram, prior, i, i))));
        let of = |i: usize, k: usize| entry(gram, prior, i, k) / (scale[i] * scale[k]);
        let mut cross = DMatrix::from_fn(known, new, |k, i| of(known + i, k));
        self.factor.solve_lower_triangular_mut(&mut cross);
        let rows = cross.transpose();
        let mut own = DMatrix::from_fn(new, new, |i, k| of(known + i, known + k));
        for i in 0..new {
            own[(i, i)] += RIDGE;
        }
        // Column by column, in the order of the factorisation of the whole matrix.
        for row in rows.column_iter() {
            for k in 0..new {
                let mut column = own.column_mut(k);
                column.rows_range_mut(k..).axpy(-row[k], &row.rows_range(k..), 1.0);
            }
        }
        let own =
            Cholesky::new_with_substitute(own, RIDGE).map_or_else(|| DMatrix::identity(new, new), Cholesky::unpack);
        let mut factor = DMatrix::zeros(p, p);
        factor.view_mut((0, 0), (known, known)).copy_from(&self.factor);
        factor.view_mut((known, 0), (new, known)).copy_from(&rows);
        factor.view_mut((known, known), (new, new)).copy_from(&own);
        Self { scale, factor }
    }

    /// The coefficients, for the right side in the last column of `gram`.
    fn solution(&self, gram: &DMatrix<f64>, prior: &ColumnPrior) -> DVector<f64> {
        let (p, last) = (self.scale.len(), gram.nrows() - 1);
        let pull = |i: usize| prior.pull.get(i).copied().unwrap_or(0.0);
        let right = DVector::from_fn(p, |i, _| (gram[(i, last)] + pull(i)) / self.scale[i]);
        let [_, scaled] = solved(&self.factor, &right);
        DVector::from_fn(p, |i, _| scaled[i] / self.scale[i])
    }
}

/// The residual sum of squares with coefficients of the first columns.
fn residual_square(gram: &DMatrix<f64>, coefficients: &DVector<f64>) -> f64 {
    let (p, last) = (coefficients.len(), gram.nrows() - 1);
    let mut rss = gram[(last, last)];
    for i in 0..p {
        let inner: f64 = (0..p).map(|k| gram[(i, k)] * coefficients[k]).sum();
        rss += coefficients[i] * (inner - 2.0 * gram[(i, last)]);
    }
    rss.max(0.0)
}
