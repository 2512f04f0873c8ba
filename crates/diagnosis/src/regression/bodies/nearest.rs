//! The physically possible rotational inertia that is nearest to an estimate.

use argmin::core::{CostFunction, Error, Executor, Gradient, State};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use effects::arm::{entries, second_moments, tensor};
use nalgebra::{Matrix3, Matrix6, SymmetricEigen, Vector6};

/// The largest number of steps.
const STEPS: u64 = 300;
/// The number of earlier steps that the optimiser remembers.
const MEMORY: usize = 6;
/// The part of the mean precision with which directions that nothing determines are held near the estimate.
const RIDGE: f64 = 1e-6;
/// The smallest second moment at the start, relative to the largest moment of inertia. At zero, the gradient would be zero as well.
const FIRST: f64 = 1e-3;

/// The tensor of a body (kg m², about its centre of mass) that exists and is nearest to `wanted` in the metric `precision` of Ixx, Ixy,
/// Iyy, Ixz, Iyz, Izz: the one with second moments Σ = L Lᵀ, I = tr(Σ) 1 − Σ, that has the smallest
/// (I − wanted)ᵀ precision (I − wanted). `None` if `wanted` or `precision` is zero or not finite.
pub fn nearest_tensor(wanted: &Matrix3<f64>, precision: &Matrix6<f64>) -> Option<Matrix3<f64>> {
    let (size, mean) = (wanted.amax(), precision.trace() / 6.0);
    if !(size > 0.0 && size.is_finite() && mean > 0.0 && mean.is_finite()) {
        return None;
    }
    // Of order one.
    let problem = Problem { wanted: six(&(wanted / size)), precision: precision / mean + Matrix6::identity() * RIDGE };
    let wanted = wanted / size;
    let mut eigen = SymmetricEigen::new(second_moments(&wanted));
    eigen.eigenvalues.apply(|value| *value = value.max(FIRST));
    let first = eigen.recompose().cholesky()?.l();
    let line_search = MoreThuenteLineSearch::new();
    let solver = LBFGS::new(line_search, MEMORY)
        .with_tolerance_grad(1e-10)
        .and_then(|solver| solver.with_tolerance_cost(1e-14))
        .ok()?;
    let start = Problem::ENTRIES.map(|at| first[at]).to_vec();
    let executor = Executor::new(problem, solver).configure(|state| state.param(start).max_iters(STEPS));
    let found = executor.run().ok()?;
    let best = found.state().get_best_param()?;
    Some(of_moments(&Problem::moments(best)) * size)
}

/// The six different entries of a tensor.
fn six(tensor: &Matrix3<f64>) -> Vector6<f64> {
    Vector6::from(entries(tensor))
}

/// The tensor of a body with these second moments.
fn of_moments(second: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * second.trace() - second
}

struct Problem {
    wanted: Vector6<f64>,
    precision: Matrix6<f64>,
}

impl Problem {
    /// The entries of L, in the order of the optimiser.
    const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

    fn lower(entries: &[f64]) -> Matrix3<f64> {
        let mut lower = Matrix3::zeros();
        for (&at, &value) in Self::ENTRIES.iter().zip(entries) {
            lower[at] = value;
        }
        lower
    }

    fn moments(entries: &[f64]) -> Matrix3<f64> {
        let lower = Self::lower(entries);
        lower * lower.transpose()
    }

    fn off(&self, entries: &[f64]) -> Vector6<f64> {
        six(&of_moments(&Self::moments(entries))) - self.wanted
    }
}

impl CostFunction for Problem {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, entries: &Vec<f64>) -> Result<f64, Error> {
        let off = self.off(entries);
        Ok(0.5 * off.dot(&(self.precision * off)))
    }
}

impl Gradient for Problem {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, entries: &Vec<f64>) -> Result<Vec<f64>, Error> {
        // The derivative by the six entries of I, and from it that by Σ and by L.
        let by_tensor = tensor((self.precision * self.off(entries)).into());
        let halved = Matrix3::from_fn(|i, k| if i == k { by_tensor[(i, k)] } else { 0.5 * by_tensor[(i, k)] });
        let by_second = Matrix3::identity() * by_tensor.trace() - halved;
        let by_lower = by_second * Self::lower(entries) * 2.0;
        Ok(Self::ENTRIES.map(|at| by_lower[at]).to_vec())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn smallest_second_moment(tensor: &Matrix3<f64>) -> f64 {
        second_moments(tensor).symmetric_eigenvalues().min()
    }

    #[test]
    fn a_body_that_exists_is_nearest_to_itself() {
        let wanted = tensor([2e-3, 1e-4, 3e-3, -2e-4, 1e-4, 2.5e-3]);
        let nearest = nearest_tensor(&wanted, &(Matrix6::identity() * 4.0)).expect("it is found");
        assert!((nearest - wanted).amax() < 1e-8, "{nearest}");
    }

    /// On a SCARA arm, recordings determine Izz alone. The other moments are estimated as zero about the tool's origin, so that they are
    /// negative about the centre of mass.
    #[test]
    fn a_determined_moment_is_kept_and_the_others_become_possible() {
        let wanted = tensor([-4e-3, 1e-3, -3e-3, 0.0, 0.0, 5e-3]);
        let mut precision = Matrix6::zeros();
        precision[(5, 5)] = 1e6;
        let nearest = nearest_tensor(&wanted, &precision).expect("it is found");
        assert!((nearest[(2, 2)] / 5e-3 - 1.0).abs() < 1e-4, "{nearest}");
        assert!(smallest_second_moment(&nearest) > -1e-12, "{nearest}");
    }

    /// Against the projection in the Frobenius norm of Σ for a metric in which both agree: all entries of a diagonal Σ.
    #[test]
    fn a_negative_second_moment_becomes_zero() {
        // Σ = diag(3, 2, −1), so that I = diag(1, 2, 5). In the metric of I, the nearest Σ with a third moment of zero has
        // I = (b, a, a + b) with the smallest (b − 1)² + (a − 2)² + (a + b − 5)²: a = 8/3, b = 5/3.
        let wanted = Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 5.0));
        let nearest = nearest_tensor(&wanted, &Matrix6::identity()).expect("it is found");
        let expected = Matrix3::from_diagonal(&Vector3::new(5.0 / 3.0, 8.0 / 3.0, 13.0 / 3.0));
        assert!((nearest - expected).amax() < 1e-4, "{nearest}");
    }

    #[test]
    fn nothing_is_nearest_to_nothing() {
        assert_eq!(nearest_tensor(&Matrix3::zeros(), &Matrix6::identity()), None);
        assert_eq!(nearest_tensor(&Matrix3::identity(), &Matrix6::zeros()), None);
    }
}
