//! The marginal likelihood and its gradient where the kernel matrix has a rank well below its size.

use faer::linalg::matmul::triangular::BlockStructure;
use faer::{Accum, Mat};

use crate::algebra::{
    add_product, cholesky, dot, inverse_of_lower, log_determinant, matmul, qr_factor, solve_lower,
    solve_lower_transposed, sum_of_squares, triangular_matmul,
};
use crate::evaluation::Evaluation;
use crate::kernel::{Points, kernel_sum, weighted_squares};
use crate::pivoted::PivotedCholesky;

/// C = F Fᵀ + ρ I, solved for the targets y.
pub(crate) struct LowRank {
    pivoted: PivotedCholesky,
    pub(crate) rho: f64,
    /// G, lower triangular, with G Gᵀ = Fᵀ F + ρ I.
    pub(crate) outer: Mat<f64>,
    /// c = Fᵀ C⁻¹ y.
    pub(crate) coefficients: Vec<f64>,
    /// y - F c = ρ C⁻¹ y.
    misfit: Vec<f64>,
    /// yᵀ C⁻¹ y.
    quadratic: f64,
    log_determinant: f64,
    /// α with (K / amplitude² + ρ I) α = y for the kernel matrix itself, if it was asked for.
    pub(crate) refined: Option<Vec<f64>>,
}

/// Steps of refinement at most; one or two are usual.
const REFINEMENTS: usize = 6;

/// How G is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Method {
    /// Cholesky of Fᵀ F + ρ I, falling back on QR: half the time, for the search.
    Normal,
    /// QR of F above √ρ I: the accuracy of F, for the posterior.
    Orthogonal,
}

impl LowRank {
    pub(crate) fn new(pivoted: PivotedCholesky, targets: &[f64], rho: f64, method: Method) -> Self {
        let factor = pivoted.factor();
        let (n, r) = (factor.nrows(), factor.ncols());
        let mut outer = Mat::zeros(0, 0);
        let mut found = false;
        if method == Method::Normal {
            outer = Mat::zeros(r, r);
            triangular_matmul(
                (outer.as_mut(), BlockStructure::TriangularLower),
                Accum::Replace,
                (factor.transpose(), BlockStructure::Rectangular),
                (factor, BlockStructure::Rectangular),
                1.0,
            );
            for j in 0..r {
                outer[(j, j)] += rho;
            }
            found = cholesky(outer.as_mut());
        }
        if !found {
            outer = qr_factor(factor, rho);
        }
        // c solves (Fᵀ F + ρ I) c = Fᵀ y. The corrections (Björck's corrected seminormal equations) take the residual from F and y
        // themselves, so that c is as accurate as with the orthogonal factor of F, which is never formed.
        let mut coefficients = vec![0.0; r];
        let mut misfit = targets.to_vec();
        for _ in 0..3 {
            let mut step: Vec<f64> = coefficients.iter().map(|c| -rho * c).collect();
            add_product(&mut step, 1.0, factor.transpose(), &misfit);
            solve_lower(outer.as_ref(), &mut step);
            solve_lower_transposed(outer.as_ref(), &mut step);
            for (c, step) in coefficients.iter_mut().zip(&step) {
                *c += step;
            }
            misfit.copy_from_slice(targets);
            add_product(&mut misfit, -1.0, factor, &coefficients);
        }
        let quadratic = sum_of_squares(&misfit) / rho + sum_of_squares(&coefficients);
        let log_determinant = (n - r) as f64 * rho.ln() + log_determinant(outer.as_ref());
        Self { pivoted, rho, outer, coefficients, misfit, quadratic, log_determinant, refined: None }
    }

    /// Solves for α with the kernel matrix itself in place of F Fᵀ, by refinement: each step gains the factor (|K - F Fᵀ| + n ε) / ρ.
    ///
    /// The pivots' kernel values tell the mean where the data are. Away from them, a mean from all n samples is as exact as a dense
    /// factorisation's; one from the pivots is off by up to |α| √(residual), 5e-6 of the targets at ρ = 2e-9 in tests/sklearn.rs.
    pub(crate) fn refine(&mut self, points: &Points, targets: &[f64]) {
        let (n, rho) = (targets.len(), self.rho);
        let factor = self.pivoted.factor();
        let unit = vec![1.0; points.dim()];
        let mut point = vec![0.0; points.dim()];
        let mut alpha: Vec<f64> = self.misfit.iter().map(|misfit| misfit / rho).collect();
        alpha.resize(points.padded_len(), 0.0);
        let mut last_step = f64::INFINITY;
        for _ in 0..REFINEMENTS {
            let mut residual = vec![0.0; n];
            for (i, residual) in residual.iter_mut().enumerate() {
                points.copy_point(i, &mut point);
                let product = kernel_sum(points, &point, &unit, &alpha);
                *residual = targets[i] - product - rho * alpha[i];
            }
            let mut inner = vec![0.0; self.pivoted.rank()];
            add_product(&mut inner, 1.0, factor.transpose(), &residual);
            solve_lower(self.outer.as_ref(), &mut inner);
            solve_lower_transposed(self.outer.as_ref(), &mut inner);
            add_product(&mut residual, -1.0, factor, &inner);
            let step = sum_of_squares(&residual).sqrt() / rho;
            // Once steps no longer shrink they are rounding.
            if step.is_nan() || step >= 0.5 * last_step {
                break;
            }
            last_step = step;
            for (alpha, residual) in alpha.iter_mut().zip(&residual) {
                *alpha += residual / rho;
            }
        }
        alpha.truncate(n);
        self.quadratic = dot(targets, &alpha);
        self.refined = Some(alpha);
    }

    pub(crate) fn pivoted(&self) -> &PivotedCholesky {
        &self.pivoted
    }

    pub(crate) fn evaluation(&self) -> Evaluation {
        Evaluation {
            penalty: self.penalty(),
            ..Evaluation::new(self.misfit.len(), self.quadratic, self.log_determinant)
        }
    }

    /// G Gᵀ - `share` I = Fᵀ F + (ρ - `share`) I.
    fn square_less(&self, share: f64) -> Mat<f64> {
        let r = self.outer.nrows();
        let mut square = Mat::from_fn(r, r, |i, j| if i == j { -share } else { 0.0 });
        triangular_matmul(
            (square.as_mut(), BlockStructure::Rectangular),
            Accum::Add,
            (self.outer.as_ref(), BlockStructure::TriangularLower),
            (self.outer.transpose(), BlockStructure::TriangularUpper),
            1.0,
        );
        square
    }

    /// The penalty on the likelihood for a truncated factor, which makes it a lower bound for any pivots: tr(K - F Fᵀ) / 2 ρ, nats.
    ///
    /// Source: Titsias 2009, "Variational learning of inducing variables in sparse Gaussian processes", eq. 9.
    fn penalty(&self) -> f64 {
        if self.pivoted.truncated { self.pivoted.neglected / (2.0 * self.rho) } else { 0.0 }
    }

    /// The distance of the bounds of the exact likelihood, from below and from above: Titsias 2014, "Variational inference
    /// for Gaussian and determinantal point processes", eq. 8, the quadratic form with ρ + tr(K - F Fᵀ) in place of ρ.
    pub(crate) fn gap(&self, targets: &[f64], amplitude_squared: f64) -> Option<f64> {
        if !self.pivoted.truncated {
            return None;
        }
        let factor = self.pivoted.factor();
        let more = self.pivoted.neglected;
        let mut outer = self.square_less(-more);
        let r = outer.nrows();
        if !cholesky(outer.as_mut()) {
            return Some(f64::INFINITY);
        }
        let mut inner = vec![0.0; r];
        add_product(&mut inner, 1.0, factor.transpose(), targets);
        solve_lower(outer.as_ref(), &mut inner);
        let quadratic = (sum_of_squares(targets) - sum_of_squares(&inner)) / (self.rho + more);
        Some(self.penalty() + 0.5 * (self.quadratic - quadratic) / amplitude_squared)
    }

    /// Derivatives of the profiled log marginal likelihood by the logarithm of each length scale, then by log ρ, for fixed pivots.
    ///
    /// With S the pivots and B = K_nS K_SS⁻¹, F Fᵀ = K_nS K_SS⁻¹ K_Sn changes by dK_nS Bᵀ + B dK_Sn - B dK_SS Bᵀ;
    /// the likelihood by ½ tr((α αᵀ / amplitude² - C⁻¹) d(F Fᵀ)), α = C⁻¹ y. Source: Rasmussen and Williams 2006, eq. 5.9.
    pub(crate) fn gradient(&self, points: &Points) -> Vec<f64> {
        let factor = self.pivoted.factor();
        let (n, r) = (factor.nrows(), factor.ncols());
        let amplitude_squared = self.quadratic / n as f64;
        let triangle = self.pivoted.triangle();
        let outer_inverse = inverse_of_lower(self.outer.as_ref());
        let triangle_inverse = inverse_of_lower(triangle.as_ref());
        // Y = G⁻¹ L_S⁻¹; C⁻¹ B = F (Fᵀ F + ρ I)⁻¹ L_S⁻¹ = F G⁻ᵀ Y.
        let mut y = Mat::<f64>::zeros(r, r);
        triangular_matmul(
            (y.as_mut(), BlockStructure::TriangularLower),
            Accum::Replace,
            (outer_inverse.as_ref(), BlockStructure::TriangularLower),
            (triangle_inverse.as_ref(), BlockStructure::TriangularLower),
            1.0,
        );
        let mut inner = Mat::<f64>::zeros(r, r);
        triangular_matmul(
            (inner.as_mut(), BlockStructure::Rectangular),
            Accum::Replace,
            (outer_inverse.transpose(), BlockStructure::TriangularUpper),
            (y.as_ref(), BlockStructure::TriangularLower),
            1.0,
        );
        // The penalty changes by -½ tr(d(F Fᵀ)) / ρ: C⁻¹ is then C⁻¹ - I / ρ, and B = F L_S⁻¹.
        let truncated = self.pivoted.truncated;
        if truncated {
            for j in 0..r {
                for i in j..r {
                    inner[(i, j)] -= triangle_inverse[(i, j)] / self.rho;
                }
            }
        }
        let mut weights = Mat::<f64>::zeros(n, r);
        matmul(weights.as_mut(), Accum::Replace, factor, inner.as_ref(), -1.0);
        // Bᵀ C⁻¹ B = L_S⁻ᵀ (I - ρ (Fᵀ F + ρ I)⁻¹) L_S⁻¹ = L_S⁻ᵀ L_S⁻¹ - ρ Yᵀ Y.
        let mut pivot_weights = Mat::<f64>::zeros(r, r);
        for (matrix, sign) in [(&triangle_inverse, 0.5), (&y, -0.5 * self.rho)] {
            triangular_matmul(
                (pivot_weights.as_mut(), BlockStructure::Rectangular),
                Accum::Add,
                (matrix.transpose(), BlockStructure::TriangularUpper),
                (matrix.as_ref(), BlockStructure::TriangularLower),
                sign,
            );
        }
        if truncated {
            // Less Bᵀ B / ρ, half of it, with Fᵀ F = G Gᵀ - ρ I.
            let square = self.square_less(self.rho);
            let inverse = triangle_inverse.as_ref();
            let mut right = Mat::<f64>::zeros(r, r);
            triangular_matmul(
                (right.as_mut(), BlockStructure::Rectangular),
                Accum::Replace,
                (square.as_ref(), BlockStructure::Rectangular),
                (inverse, BlockStructure::TriangularLower),
                1.0,
            );
            triangular_matmul(
                (pivot_weights.as_mut(), BlockStructure::Rectangular),
                Accum::Add,
                (inverse.transpose(), BlockStructure::TriangularUpper),
                (right.as_ref(), BlockStructure::Rectangular),
                -0.5 / self.rho,
            );
        }
        let mut beta = self.coefficients.clone();
        solve_lower_transposed(triangle.as_ref(), &mut beta);

        let mut gradient = vec![0.0; points.dim() + 1];
        let lengths = &mut gradient[..points.dim()];
        let mut point = vec![0.0; points.dim()];
        for (j, &pivot) in self.pivoted.pivots.iter().enumerate() {
            let kernel = self.pivoted.kernel_column(j);
            let column = weights.col_as_slice_mut(j);
            let scale = beta[j] / (amplitude_squared * self.rho);
            for (weight, misfit) in column.iter_mut().zip(&self.misfit) {
                *weight += misfit * scale;
            }
            for (k, &other) in self.pivoted.pivots.iter().enumerate() {
                column[other] += pivot_weights[(k, j)] - 0.5 * beta[k] * beta[j] / amplitude_squared;
            }
            for (weight, kernel) in column.iter_mut().zip(kernel) {
                *weight *= kernel;
            }
            points.copy_point(pivot, &mut point);
            weighted_squares(points, &point, column, lengths);
        }
        gradient[points.dim()] = self.slope_with(&outer_inverse);
        gradient
    }

    /// Derivative of the profiled log marginal likelihood by log ρ.
    pub(crate) fn slope_by_noise(&self) -> f64 {
        self.slope_with(&inverse_of_lower(self.outer.as_ref()))
    }

    /// Derivative of the profiled log marginal likelihood by log ρ, with G⁻¹ known.
    fn slope_with(&self, outer_inverse: &Mat<f64>) -> f64 {
        let (n, r) = (self.misfit.len(), self.outer.nrows());
        let amplitude_squared = self.quadratic / n as f64;
        let alpha_squared = dot(&self.misfit, &self.misfit) / self.rho;
        let trace: f64 = outer_inverse.col_iter().map(|column| column.squared_norm_l2()).sum();
        0.5 * (alpha_squared / amplitude_squared - (n - r) as f64 - self.rho * trace) + self.penalty()
    }
}
