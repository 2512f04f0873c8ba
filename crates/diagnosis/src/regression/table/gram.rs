//! Inner products of columns over stretches of rows.

use std::ops::Range;

use faer::{Accum, Mat, MatRef, Par, linalg::matmul::matmul};
use gp::release_vectors;

use crate::thresholds::STRETCHES;

/// The number of new columns whose inner products are formed together; only those with columns up to them are needed.
const TOGETHER: usize = 64;

/// A recording, or a stretch of it, in which one joint moves.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// The recording that it is of.
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
    /// The stretches of a joint that is `moving` on some rows: the recordings, whose rows are `recordings`. If only one
    /// training recording moves the joint, it is divided.
    pub fn of(recordings: &[Range<usize>], held_out: &[bool], moving: &[bool]) -> Vec<Self> {
        let rows_of = |range: &Range<usize>| -> Vec<usize> { range.clone().filter(|&row| moving[row]).collect() };
        let rows: Vec<Vec<usize>> = recordings.iter().map(rows_of).collect();
        let is_fitted = |r: &usize| !held_out[*r] && !rows[*r].is_empty();
        let fitted = (0..rows.len()).filter(is_fitted).count();
        let mut stretches = Vec::with_capacity(rows.len() + STRETCHES - 1);
        for (recording, rows) in rows.iter().enumerate() {
            let pieces = if fitted == 1 && is_fitted(&recording) { STRETCHES } else { 1 };
            let length = rows.len().div_ceil(pieces).max(1);
            stretches.extend(rows.chunks(length).map(|rows| Self {
                recording,
                gram: Gram::default(),
                runs: runs(rows),
            }));
        }
        stretches
    }

    /// Inner products of the new ones among the columns `x`, with all columns and with `y`.
    pub fn refresh(&mut self, x: &[Vec<f64>], y: &[f64]) {
        let known = self.gram.len();
        let total = x.len();
        let pick =
            |signal: &[f64]| -> Vec<f64> { self.runs.iter().flat_map(|run| &signal[run.clone()]).copied().collect() };
        let y = pick(y);
        self.gram.square = y.iter().map(|y| y * y).sum();
        if known == total {
            return;
        }
        for x in &x[known..] {
            let x = pick(x);
            self.gram.right.push(x.iter().zip(&y).map(|(x, y)| x * y).sum());
            self.gram.sums.push(x.iter().sum());
        }
        // The columns one after the other, for this call only, because they take as much memory as the table.
        let mut packed = Vec::with_capacity(total * y.len());
        for x in x {
            for run in &self.runs {
                packed.extend_from_slice(&x[run.clone()]);
            }
        }
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
                self.gram.rows.push(product.col_as_slice(k - from)[..=k].to_vec());
            }
        }
    }
}

/// Inner products of columns with each other and with y.
#[derive(Clone, Debug, Default)]
pub struct Gram {
    /// The lower triangle, row by row.
    rows: Vec<Vec<f64>>,
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

    /// The sum of several products of the same `columns` columns.
    pub fn sum<'a>(columns: usize, grams: impl Iterator<Item = &'a Gram>) -> Gram {
        let mut sum = Gram {
            rows: (0..columns).map(|k| vec![0.0; k + 1]).collect(),
            right: vec![0.0; columns],
            square: 0.0,
            sums: vec![0.0; columns],
        };
        for gram in grams {
            for (row, more) in sum.rows.iter_mut().zip(&gram.rows) {
                for (value, more) in row.iter_mut().zip(more) {
                    *value += more;
                }
            }
            for (values, more) in [(&mut sum.right, &gram.right), (&mut sum.sums, &gram.sums)] {
                for (value, more) in values.iter_mut().zip(more) {
                    *value += more;
                }
            }
            sum.square += gram.square;
        }
        sum
    }
}
