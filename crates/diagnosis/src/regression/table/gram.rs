//! Inner products of columns over stretches of rows.

use std::ops::Range;
use std::sync::Arc;

use faer::{Accum, Mat, MatRef, Par, linalg::matmul::matmul};
use gp::release_vectors;

use crate::thresholds::STRETCHES;

/// The number of new columns whose inner products are formed together; only those with columns up to them are needed.
const TOGETHER: usize = 64;

/// A recording, a group of several, or a stretch of one, in which one joint moves.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// The recording that it is of, or the first one of the group.
    pub recording: usize,
    /// Inner products over its moving rows.
    pub gram: Gram,
    /// The moving rows, as runs of consecutive ones.
    runs: Vec<Range<usize>>,
}

/// Consecutive runs of `rows`, which ascend.
fn runs(rows: &[usize]) -> Vec<Range<usize>> {
    let follows = |a: &usize, b: &usize| a + 1 == *b;
    rows.chunk_by(follows).map(|run| run[0]..run[run.len() - 1] + 1).collect()
}

impl Stretch {
    /// The stretches of a joint that is `moving` on some rows: the `groups` of the recordings, whose rows are `recordings`. If only one
    /// training recording moves the joint, or only one of those on its side of a change (`before`: those from before it), it is divided.
    pub fn of(
        recordings: &[Range<usize>],
        groups: &[usize],
        held_out: &[bool],
        before: &[bool],
        moving: &[bool],
    ) -> Vec<Self> {
        let mut rows: Vec<Vec<usize>> = vec![Vec::new(); recordings.len()];
        for (range, &group) in recordings.iter().zip(groups) {
            rows[group].extend(range.clone().filter(|&row| moving[row]));
        }
        let is_fitted = |r: &usize| !held_out[*r] && !rows[*r].is_empty();
        let is_alone =
            |r: usize| (0..rows.len()).filter(is_fitted).filter(|&other| before[other] == before[r]).count() == 1;
        let mut stretches = Vec::with_capacity(rows.len() + STRETCHES - 1);
        for (recording, rows) in rows.iter().enumerate() {
            let pieces = if is_fitted(&recording) && is_alone(recording) { STRETCHES } else { 1 };
            let length = rows.len().div_ceil(pieces).max(1);
            stretches.extend(rows.chunks(length).map(|rows| Self {
                recording,
                gram: Gram::default(),
                runs: runs(rows),
            }));
        }
        stretches
    }

    /// Takes the inner products of the columns at `places` of a stretch of another table with each other, if it has the same rows.
    pub fn take(&mut self, known: &Self, places: &[usize]) {
        if self.recording == known.recording && self.runs == known.runs {
            let row = |k: usize| places[..=k].iter().map(|&place| known.gram.of(places[k], place)).collect();
            self.gram.rows = (0..places.len()).map(row).collect();
            self.gram.sums = places.iter().map(|&place| known.gram.sums[place]).collect();
        }
    }

    /// Inner products of the new ones among the columns `x`, with all columns and with `y`.
    pub fn refresh(&mut self, x: &[Vec<f64>], y: &[f64]) {
        let known = self.gram.len();
        let total = x.len();
        if self.gram.right.len() == total && total > 0 {
            return;
        }
        let pick =
            |signal: &[f64]| -> Vec<f64> { self.runs.iter().flat_map(|run| &signal[run.clone()]).copied().collect() };
        let y = pick(y);
        self.gram.square = y.iter().map(|y| y * y).sum();
        // Columns of another table had another y there.
        for x in &x[self.gram.right.len()..known] {
            self.gram.right.push(pick(x).iter().zip(&y).map(|(x, y)| x * y).sum());
        }
        let new: Vec<Vec<f64>> = x[known..].iter().map(|x| pick(x)).collect();
        for x in &new {
            let sums = |(right, sum): (f64, f64), (x, y): (&f64, &f64)| (right + x * y, sum + x);
            let (right, sum) = x.iter().zip(&y).fold((0.0, 0.0), sums);
            self.gram.right.push(right);
            self.gram.sums.push(sum);
        }
        // The columns one after the other, for this call only, because they take as much memory as the table.
        let mut packed = Vec::with_capacity(total * y.len());
        for x in &x[..known] {
            for run in &self.runs {
                packed.extend_from_slice(&x[run.clone()]);
            }
        }
        new.iter().for_each(|x| packed.extend_from_slice(x));
        let all = MatRef::from_column_major_slice(&packed, y.len(), total);
        for from in (known..total).step_by(TOGETHER) {
            let to = total.min(from + TOGETHER);
            let mut product = Mat::zeros(to, to - from);
            matmul(
                product.as_mut(),
                Accum::Replace,
                all.subcols(0, to).transpose(),
                all.subcols(from, to - from),
                1.0,
                Par::Seq,
            );
            release_vectors();
            for k in from..to {
                self.gram.rows.push(product.col_as_slice(k - from)[..=k].into());
            }
        }
    }
}

/// Inner products of columns with each other and with y.
#[derive(Clone, Debug, Default)]
pub struct Gram {
    /// The lower triangle, row by row. Rows never change, so that copies share them.
    rows: Vec<Arc<[f64]>>,
    /// Inner products with y.
    right: Vec<f64>,
    /// The inner product of y with itself.
    square: f64,
    /// The sums of the columns.
    sums: Vec<f64>,
}

impl Gram {
    /// The number of columns.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// The product of two columns.
    pub fn of(&self, i: usize, k: usize) -> f64 {
        self.rows[i.max(k)][i.min(k)]
    }

    /// The product of a column and y.
    pub fn with_y(&self, i: usize) -> f64 {
        self.right[i]
    }

    /// The product of y with itself.
    pub fn y_square(&self) -> f64 {
        self.square
    }

    /// The sum of a column.
    pub fn sum_of(&self, i: usize) -> f64 {
        self.sums[i]
    }

    /// The products of the columns at these indices, in this order; zero for a missing one.
    pub fn picked(&self, places: &[Option<usize>]) -> Gram {
        let of = |i: Option<usize>, k: Option<usize>| match (i, k) {
            (Some(i), Some(k)) => self.of(i, k),
            _ => 0.0,
        };
        Gram {
            rows: (0..places.len()).map(|k| (0..=k).map(|i| of(places[i], places[k])).collect()).collect(),
            right: places.iter().map(|place| place.map_or(0.0, |i| self.right[i])).collect(),
            square: self.square,
            sums: places.iter().map(|place| place.map_or(0.0, |i| self.sums[i])).collect(),
        }
    }

    /// These products with an additional part of y that no column has.
    pub fn with_noise(mut self, square: f64) -> Gram {
        self.square += square;
        self
    }

    /// The sum of several products of the same `columns` columns, the first ones of which may be in `known`: the sum of the same
    /// products when they had fewer columns.
    pub fn sum<'a>(known: Gram, columns: usize, grams: impl Iterator<Item = &'a Gram> + Clone) -> Gram {
        let mut sum = known;
        for k in sum.len()..columns {
            let mut row = vec![0.0; k + 1];
            for gram in grams.clone() {
                row.iter_mut().zip(gram.rows[k].iter()).for_each(|(value, more)| *value += more);
            }
            sum.rows.push(row.into());
            sum.right.push(grams.clone().fold(0.0, |value, gram| value + gram.right[k]));
            sum.sums.push(grams.clone().fold(0.0, |value, gram| value + gram.sums[k]));
        }
        sum.square = grams.fold(0.0, |square, gram| square + gram.square);
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A recording is divided if it is the only one that moves the joint on its side of a change: what changed then predicts parts to which it
    /// was not fitted.
    #[test]
    fn a_recording_alone_on_its_side_is_divided() {
        let recordings = [0..100, 100..200, 200..300];
        let pieces = |before: [bool; 3], held_out: [bool; 3]| -> [usize; 3] {
            let stretches = Stretch::of(&recordings, &[0, 1, 2], &held_out, &before, &[true; 300]);
            [0, 1, 2].map(|recording| stretches.iter().filter(|stretch| stretch.recording == recording).count())
        };
        let fitted = [false; 3];
        let grouped = Stretch::of(&recordings, &[0, 0, 2], &fitted, &fitted, &[true; 300]);
        let of: Vec<(usize, Range<usize>)> =
            grouped.iter().map(|stretch| (stretch.recording, stretch.runs[0].clone())).collect();
        assert_eq!(of, [(0, 0..200), (2, 200..300)]);
        assert_eq!(pieces([false; 3], fitted), [1, 1, 1]);
        assert_eq!(pieces([true, true, false], fitted), [1, 1, STRETCHES]);
        assert_eq!(pieces([true, false, false], fitted), [STRETCHES, 1, 1]);
        assert_eq!(pieces([true, false, false], [false, false, true]), [STRETCHES, STRETCHES, 1]);
    }
}
