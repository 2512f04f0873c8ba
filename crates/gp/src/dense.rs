//! The marginal likelihood and its gradient where the kernel matrix has full rank, or nearly.

use faer::linalg::matmul::triangular::BlockStructure;
use faer::{Accum, Mat};

use crate::algebra::{
    cholesky, dot, inverse_of_lower, log_determinant, solve_lower, solve_lower_transposed, sum_of_squares,
    triangular_matmul,
};
use crate::evaluation::Evaluation;
use crate::kernel::{Points, kernel_column, weighted_squares};

/// C = K / amplitude² + ρ I, by its Cholesky factor, solved for the targets y.
pub(crate) struct Dense {
    rho: f64,
    /// G, lower triangular, with G Gᵀ = C.
    pub(crate) outer: Mat<f64>,
    /// α = C⁻¹ y.
    pub(crate) alpha: Vec<f64>,
    quadratic: f64,
}

impl Dense {
    /// Factors C; `None` if rounding makes it indefinite.
    pub(crate) fn new(points: &Points, targets: &[f64], rho: f64) -> Option<Self> {
        let mut outer = kernel_matrix(points);
        for j in 0..points.len() {
            outer[(j, j)] += rho;
        }
        if !cholesky(outer.as_mut()) {
            return None;
        }
        for j in 1..points.len() {
            outer.col_as_slice_mut(j)[..j].fill(0.0);
        }
        let mut alpha = targets.to_vec();
        solve_lower(outer.as_ref(), &mut alpha);
        let quadratic = sum_of_squares(&alpha);
        solve_lower_transposed(outer.as_ref(), &mut alpha);
        Some(Self { rho, outer, alpha, quadratic })
    }

    pub(crate) fn evaluation(&self) -> Evaluation {
        let log_determinant = log_determinant(self.outer.as_ref());
        Evaluation::new(self.alpha.len(), self.quadratic, log_determinant)
    }

    /// Derivatives of the profiled log marginal likelihood by the logarithm of each length scale, then by log ρ.
    ///
    /// Source: Rasmussen and Williams 2006, eq. 5.9.
    pub(crate) fn gradient(&self, points: &Points) -> Vec<f64> {
        let n = self.alpha.len();
        let amplitude_squared = self.quadratic / n as f64;
        let outer_inverse = inverse_of_lower(self.outer.as_ref());
        let mut inverse = Mat::<f64>::zeros(n, n);
        triangular_matmul(
            (inverse.as_mut(), BlockStructure::TriangularLower),
            Accum::Replace,
            (outer_inverse.transpose(), BlockStructure::TriangularUpper),
            (outer_inverse.as_ref(), BlockStructure::TriangularLower),
            1.0,
        );
        let trace: f64 = (0..n).map(|j| inverse[(j, j)]).sum();
        let mut gradient = vec![0.0; points.dim() + 1];
        let unit = vec![1.0; points.dim()];
        let mut point = vec![0.0; points.dim()];
        let mut kernel = vec![0.0; n];
        for j in 0..n {
            points.copy_point(j, &mut point);
            kernel_column(points, &point, &unit, &mut kernel);
            let scale = self.alpha[j] / amplitude_squared;
            let column = inverse.col_as_slice_mut(j);
            // The lower triangle, counted twice; on the diagonal the distance is zero.
            column[..=j].fill(0.0);
            for i in j + 1..n {
                column[i] = (self.alpha[i] * scale - column[i]) * kernel[i];
            }
            weighted_squares(points, &point, column, &mut gradient[..points.dim()]);
        }
        let alpha_squared = dot(&self.alpha, &self.alpha);
        gradient[points.dim()] = 0.5 * self.rho * (alpha_squared / amplitude_squared - trace);
        gradient
    }
}

/// The kernel matrix at unit amplitude.
fn kernel_matrix(points: &Points) -> Mat<f64> {
    let mut matrix = Mat::zeros(points.len(), points.len());
    let unit = vec![1.0; points.dim()];
    let mut point = vec![0.0; points.dim()];
    for j in 0..points.len() {
        points.copy_point(j, &mut point);
        kernel_column(points, &point, &unit, matrix.col_as_slice_mut(j));
    }
    matrix
}
