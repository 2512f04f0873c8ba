//! The posterior: weights for the mean, triangular factors for the variance.

use serde::{Deserialize, Serialize};

use faer::MatRef;

use crate::algebra::solve_lower_transposed;
use crate::kernel::{Points, kernel_column, kernel_sum};
use crate::likelihood::Factored;

/// A lower triangular matrix, stored row after row without the zeros.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Triangle(pub(crate) Vec<f64>);

impl Triangle {
    fn new(matrix: MatRef<'_, f64>) -> Self {
        let rows = 0..matrix.nrows();
        Self(rows.flat_map(|i| (0..=i).map(move |j| matrix[(i, j)])).collect())
    }

    /// b ← L⁻¹ b.
    fn solve(&self, b: &mut [f64]) {
        let mut rest = self.0.as_slice();
        for i in 0..b.len() {
            let (row, below) = rest.split_at(i + 1);
            rest = below;
            // Four separate sums, so that no addition waits for the previous one.
            let mut sums = [0.0; 4];
            let (solved, current) = b.split_at_mut(i);
            let (quads, coefficients) = (solved.chunks_exact(4), row[..i].chunks_exact(4));
            let tail = quads.remainder().iter().zip(coefficients.remainder());
            let tail: f64 = tail.map(|(a, b)| a * b).sum();
            for (quad, coefficients) in quads.zip(coefficients) {
                for lane in 0..4 {
                    sums[lane] += quad[lane] * coefficients[lane];
                }
            }
            let sum = (sums[0] + sums[1]) + (sums[2] + sums[3]) + tail;
            current[0] = (current[0] - sum) / row[i];
        }
    }
}

/// Factors for the variance at unit amplitude.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum VarianceFactors {
    /// The indices of the pivots among the points; the Cholesky factor L_S of their kernel matrix; G with G Gᵀ = Fᵀ F
    /// + ρ I; ρ.
    LowRank { pivots: Vec<usize>, inner: Triangle, outer: Triangle, rho: f64 },
    /// G with G Gᵀ = C.
    Dense { outer: Triangle },
}

/// The posterior at unit amplitude over a set of points: all samples, or the pivots among them.
#[derive(Clone, Debug)]
pub(crate) struct Posterior {
    pub(crate) points: Points,
    pub(crate) lengths: Vec<f64>,
    /// In the target's unit; zero in the points' padding.
    pub(crate) weights: Vec<f64>,
    pub(crate) variance: VarianceFactors,
    /// The pivots, laid out, where they are not all points.
    pivots: Option<Points>,
}

impl Posterior {
    /// `weights` has `points.len()` values; the factors must fit the points.
    pub(crate) fn new(points: Points, lengths: Vec<f64>, mut weights: Vec<f64>, variance: VarianceFactors) -> Self {
        weights.resize(points.padded_len(), 0.0);
        let pivots = match &variance {
            VarianceFactors::LowRank { pivots, .. } if !pivots.iter().copied().eq(0..points.len()) => {
                Some(points.subset(pivots))
            }
            _ => None,
        };
        Self { points, lengths, weights, variance, pivots }
    }

    /// From C factored for `points`; weights are multiplied by `target_scale`.
    pub(crate) fn of(factored: &Factored, points: &Points, lengths: Vec<f64>, target_scale: f64) -> Self {
        let (points, mut weights, variance) = match factored {
            Factored::Dense(dense) => {
                let outer = Triangle::new(dense.outer.as_ref());
                let variance = VarianceFactors::Dense { outer };
                (points.clone(), dense.alpha.clone(), variance)
            }
            Factored::LowRank(low_rank) => {
                let pivots = &low_rank.pivoted().pivots;
                let inner = low_rank.pivoted().triangle();
                let factors = |pivots| VarianceFactors::LowRank {
                    pivots,
                    inner: Triangle::new(inner.as_ref()),
                    outer: Triangle::new(low_rank.outer.as_ref()),
                    rho: low_rank.rho,
                };
                if let Some(alpha) = &low_rank.refined {
                    (points.clone(), alpha.clone(), factors(pivots.clone()))
                } else {
                    // The mean is k_S(x)ᵀ L_S⁻ᵀ c.
                    let mut weights = low_rank.coefficients.clone();
                    solve_lower_transposed(inner.as_ref(), &mut weights);
                    let all = (0..pivots.len()).collect();
                    (points.subset(pivots), weights, factors(all))
                }
            }
        };
        for weight in &mut weights {
            *weight *= target_scale;
        }
        Self::new(points, lengths, weights, variance)
    }

    /// The posterior of a function that is known to be zero.
    pub(crate) fn empty(lengths: Vec<f64>) -> Self {
        let points = Points::new(0, lengths.len(), |_, _| 0.0);
        let outer = Triangle(Vec::new());
        Self::new(points, lengths, Vec::new(), VarianceFactors::Dense { outer })
    }

    pub(crate) fn mean(&self, x: &[f64]) -> f64 {
        kernel_sum(&self.points, x, &self.lengths, &self.weights)
    }

    /// Variance of the function at `x` at unit amplitude; `kernel` is scratch.
    ///
    /// Dense: 1 - |G⁻¹ k|², Rasmussen and Williams 2006, eq. 2.26. Low rank: with v = L_S⁻¹ k_S, 1 - |v|² + ρ |G⁻¹ v|², eq. 8.26 b.
    pub(crate) fn variance(&self, x: &[f64], kernel: &mut Vec<f64>) -> f64 {
        let points = self.pivots.as_ref().unwrap_or(&self.points);
        kernel.resize(points.len(), 0.0);
        kernel_column(points, x, &self.lengths, kernel);
        let squares = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
        let variance = match &self.variance {
            VarianceFactors::Dense { outer } => {
                outer.solve(kernel);
                1.0 - squares(kernel)
            }
            VarianceFactors::LowRank { inner, outer, rho, .. } => {
                inner.solve(kernel);
                let unexplained = 1.0 - squares(kernel);
                outer.solve(kernel);
                // `max` would replace NaN by 0.
                let unexplained = if unexplained < 0.0 { 0.0 } else { unexplained };
                unexplained + rho * squares(kernel)
            }
        };
        if variance < 0.0 { 0.0 } else { variance }
    }
}
