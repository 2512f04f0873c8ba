//! Pivoted Cholesky factorisation of a kernel matrix: its numerical rank, and a factor of that rank.

use faer::{Accum, Mat, MatMut, MatRef};

use crate::algebra::{matmul, solve_lower_all};
use crate::kernel::{Points, kernel_column};

/// The number of pivots that are processed together, so that the work is in matrix products and not in passes over
/// memory.
const BLOCK: usize = 24;

/// The number of candidates for one block.
const CANDIDATES: usize = 64;

/// Columns for which there is room from the beginning.
const COLUMNS: usize = 600;

/// A block takes pivots whose residual is at least this share of the largest one: close to the greedy choice, which always takes the largest.
const ACCEPTED_SHARE: f64 = 0.2;

/// K ≈ F Fᵀ with F of `rank` columns, for the kernel matrix K (n × n, unit diagonal) of a set of points.
pub(crate) struct PivotedCholesky {
    /// Indices of the chosen points, in order.
    pub(crate) pivots: Vec<usize>,
    /// F, n × rank, column-major; lower triangular in the rows `pivots`.
    factor: Vec<f64>,
    /// Columns `pivots` of K, n × rank, column-major; empty unless asked for.
    kernel: Vec<f64>,
    rows: usize,
    /// Trace of K - F Fᵀ, which bounds its largest eigenvalue.
    pub(crate) neglected: f64,
    /// Whether the factorisation ended at the largest rank, not at the end of the matrix.
    pub(crate) truncated: bool,
}

/// When to stop, and when to give up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stopping {
    /// Stop when the trace of the residual is no larger.
    pub(crate) trace: f64,
    /// Stop when no residual is larger: below the rounding of the kernel values there is nothing to find.
    pub(crate) pivot: f64,
    /// Stop without a result beyond this rank.
    pub(crate) max_rank: usize,
    /// Instead of stopping without a result, keep the pivots found so far.
    pub(crate) truncates: bool,
    /// Whether to keep the pivots' kernel values, for the gradient.
    pub(crate) keeps_kernel: bool,
}

impl PivotedCholesky {
    /// Factorises; `None` if the rank exceeds `stopping.max_rank` and the factor is not to be truncated there.
    ///
    /// Source: Harbrecht, Peters, Schneider 2012, "On the low-rank approximation by the pivoted Cholesky decomposition", algorithm 1, in blocks.
    pub(crate) fn new(points: &Points, stopping: Stopping) -> Option<Self> {
        let n = points.len();
        let unit = vec![1.0; points.dim()];
        let mut point = vec![0.0; points.dim()];
        let mut this = Self {
            pivots: Vec::new(),
            // Of most ranks; memory that is not written costs nothing.
            factor: Vec::with_capacity(n * stopping.max_rank.min(COLUMNS)),
            kernel: Vec::new(),
            rows: n,
            neglected: n as f64,
            truncated: false,
        };
        let mut residual = vec![1.0; n];
        loop {
            this.neglected = residual.iter().sum();
            let largest = residual.iter().copied().fold(0.0, f64::max);
            if this.neglected <= stopping.trace || largest <= stopping.pivot {
                return Some(this);
            }
            let accept = (largest * ACCEPTED_SHARE).max(stopping.pivot);
            let (mut block, triangle) = this.choose_block(points, &residual, accept);
            let rank = this.pivots.len();
            // Empty only if all residuals are rounding errors.
            if block.is_empty() {
                return Some(this);
            }
            if rank + block.len() > stopping.max_rank {
                if !stopping.truncates {
                    return None;
                }
                block.truncate(stopping.max_rank - rank);
                if block.is_empty() {
                    this.truncated = true;
                    return Some(this);
                }
            }
            let taken = block.len();
            let triangle = triangle.submatrix(0, 0, taken, taken);
            let earlier = Mat::from_fn(taken, rank, |t, j| this.factor[j * n + block[t]]);
            this.factor.resize((rank + taken) * n, 0.0);
            for (&i, column) in block.iter().zip(this.factor[rank * n..].chunks_exact_mut(n)) {
                points.copy_point(i, &mut point);
                kernel_column(points, &point, &unit, column);
            }
            if stopping.keeps_kernel {
                this.kernel.extend_from_slice(&this.factor[rank * n..]);
            }
            let (old, new) = this.factor.split_at_mut(rank * n);
            let old = MatRef::from_column_major_slice(old, n, rank);
            let mut new = MatMut::from_column_major_slice_mut(new, n, taken);
            matmul(new.as_mut(), Accum::Add, old, earlier.transpose(), -1.0);
            solve_lower_all(triangle, new.as_mut().transpose_mut());
            for (t, &i) in block.iter().enumerate() {
                // Zero except for rounding; exact zeros make the rows of the pivots triangular.
                for later in t + 1..taken {
                    new[(i, later)] = 0.0;
                }
            }
            for column in this.factor[rank * n..].chunks_exact(n) {
                for (value, entry) in residual.iter_mut().zip(column) {
                    *value -= entry * entry;
                }
            }
            for value in &mut residual {
                *value = value.max(0.0);
            }
            for &i in &block {
                residual[i] = 0.0;
            }
            this.pivots.extend(block);
        }
    }

    /// The next pivots, and the Cholesky factor of the residual matrix in their rows and columns.
    fn choose_block(&self, points: &Points, residual: &[f64], accept: f64) -> (Vec<usize>, Mat<f64>) {
        let n = self.rows;
        let mut worthy: Vec<usize> = (0..n).filter(|&i| residual[i] >= accept).collect();
        if worthy.len() > CANDIDATES {
            // Candidates are evenly distributed over the samples, because neighbours are similar; the largest residual
            // is always among them.
            let largest = (0..n).fold(0, |a, i| if residual[i] > residual[a] { i } else { a });
            let count = worthy.len();
            let mut spread: Vec<usize> = (0..CANDIDATES).map(|t| worthy[t * count / CANDIDATES]).collect();
            if !spread.contains(&largest) {
                spread.push(largest);
            }
            worthy = spread;
        }
        let m = worthy.len();
        let rank = self.pivots.len();
        let candidates = points.subset(&worthy);
        let earlier = Mat::from_fn(m, rank, |t, j| self.factor[j * n + worthy[t]]);
        let mut covariance = Mat::zeros(m, m);
        let unit = vec![1.0; points.dim()];
        let mut point = vec![0.0; points.dim()];
        for t in 0..m {
            candidates.copy_point(t, &mut point);
            kernel_column(&candidates, &point, &unit, covariance.col_as_slice_mut(t));
        }
        matmul(covariance.as_mut(), Accum::Add, earlier.as_ref(), earlier.transpose(), -1.0);
        let mut left: Vec<f64> = worthy.iter().map(|&i| residual[i]).collect();
        let mut taken: Vec<usize> = Vec::with_capacity(BLOCK);
        let mut columns: Vec<Vec<f64>> = Vec::with_capacity(BLOCK);
        while taken.len() < BLOCK {
            let t = (0..m).fold(0, |a, t| if left[t] > left[a] { t } else { a });
            if left[t] < accept {
                break;
            }
            let root = left[t].sqrt();
            let mut column: Vec<f64> = (0..m).map(|s| covariance[(s, t)]).collect();
            for done in &columns {
                for s in 0..m {
                    column[s] -= done[s] * done[t];
                }
            }
            for (s, value) in column.iter_mut().enumerate() {
                *value /= root;
                left[s] -= *value * *value;
            }
            column[t] = root;
            left[t] = f64::NEG_INFINITY;
            taken.push(t);
            columns.push(column);
        }
        let triangle = Mat::from_fn(taken.len(), taken.len(), |s, t| if s >= t { columns[t][taken[s]] } else { 0.0 });
        (taken.iter().map(|&t| worthy[t]).collect(), triangle)
    }

    pub(crate) fn rank(&self) -> usize {
        self.pivots.len()
    }

    /// F, n × rank.
    pub(crate) fn factor(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.factor, self.rows, self.rank())
    }

    /// Column `j` of K at the pivots, n values; they were asked for.
    pub(crate) fn kernel_column(&self, j: usize) -> &[f64] {
        &self.kernel[j * self.rows..(j + 1) * self.rows]
    }

    /// The rows of F at the pivots, rank × rank, lower triangular: the Cholesky factor of K there.
    pub(crate) fn triangle(&self) -> Mat<f64> {
        let factor = self.factor();
        Mat::from_fn(self.rank(), self.rank(), |i, j| if i >= j { factor[(self.pivots[i], j)] } else { 0.0 })
    }
}
