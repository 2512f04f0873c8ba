//! Least squares of a few columns, and of a force on the tool.

use nalgebra::{Cholesky, Const, Matrix3, SMatrix, SVector, Vector3};

/// The ridge of a force's normal equations, as a part of their trace.
pub const FORCE_RIDGE: f64 = 1e-6;

/// The part of a residual's weighted square that columns explain, from their inner products with each other and with the
/// residual; the ridge is a `part` of the trace.
pub fn explained<const N: usize>(matrix: SMatrix<f64, N, N>, right: &SVector<f64, N>, part: f64) -> f64 {
    ridged(matrix, part).map_or(0.0, |factor| right.dot(&factor.solve(right)))
}

/// The factor of `matrix` with a ridge, which is a `part` of the trace; `None` if it is not positive definite.
fn ridged<const N: usize>(mut matrix: SMatrix<f64, N, N>, part: f64) -> Option<Cholesky<f64, Const<N>>> {
    let ridge = (part * matrix.trace()).max(1e-300);
    for k in 0..N {
        matrix[(k, k)] += ridge;
    }
    matrix.cholesky()
}

/// A force on the tool that is fitted to some rows and tested on others.
#[derive(Default)]
pub struct ForceFit {
    matrix: Matrix3<f64>,
    right: Vector3<f64>,
    tried: Vec<(f64, f64, Vector3<f64>)>,
}

impl ForceFit {
    /// A row of a joint with its weight, its residual (N m or N) and the torques of unit forces (N m/N or 1). It is fitted,
    /// or the fit is tested on it.
    pub fn add(&mut self, is_fitted: bool, weight: f64, residual: f64, x: Vector3<f64>) {
        if is_fitted {
            self.matrix += weight * x * x.transpose();
            self.right += weight * residual * x;
        } else {
            self.tried.push((weight, residual, x));
        }
    }

    /// The force (N), and the weighted square of the residual on the rows where it is tested, without and with it; `None` if
    /// nothing determines the force.
    pub fn solved(self) -> Option<(Vector3<f64>, [f64; 2])> {
        let force = ridged(self.matrix, FORCE_RIDGE)?.solve(&self.right);
        let (mut before, mut after) = (0.0, 0.0);
        for (weight, residual, x) in self.tried {
            before += weight * residual * residual;
            after += weight * (residual - force.dot(&x)).powi(2);
        }
        Some((force, [before, after]))
    }
}
