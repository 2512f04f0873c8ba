//! A body as a 4 × 4 matrix that remains physical under every linear map of space.

use arm::{Inertia, Matrix3, Vector3};
use nalgebra::{Matrix4, SymmetricEigen};

/// Second moments below this do not occur (kg m²).
const LEAST_MOMENT: f64 = 1e-9;
/// Radii of gyration below this do not occur in links (m).
const LEAST_RADIUS: f64 = 0.02;

/// The pseudo-inertia [Σ, m c; m cᵀ, m] of a body, with Σ the second moments of mass about the frame's origin (kg m²),
/// m the mass (kg) and c the centre of mass (m) (Wensing, Kim and Slotine, RA-L 3(1), 2018). It is positive definite
/// exactly for physical bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PseudoInertia(pub(crate) Matrix4<f64>);

impl PseudoInertia {
    /// The pseudo-inertia of a body with mass. Second moments that are not physical are raised to the smallest that
    /// are.
    pub(crate) fn of(body: &Inertia) -> Self {
        let central = SymmetricEigen::new(Matrix3::identity() * (0.5 * body.tensor.trace()) - body.tensor);
        let moments = Matrix3::from_diagonal(&central.eigenvalues.map(|moment| moment.max(LEAST_MOMENT)));
        let central = central.eigenvectors * moments * central.eigenvectors.transpose();
        let first = body.mass * body.com;
        let mut matrix = Matrix4::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&(central + first * body.com.transpose()));
        matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&first);
        matrix.fixed_view_mut::<1, 3>(3, 0).copy_from(&first.transpose());
        matrix[(3, 3)] = body.mass;
        Self(matrix)
    }

    /// A P Aᵀ: the body after space was mapped by `map` (in homogeneous coordinates; the scale of the last one scales
    /// the mass). An invertible map gives a physical body.
    pub(crate) fn mapped(&self, map: &Matrix4<f64>) -> Self {
        Self(map * self.0 * map.transpose())
    }

    /// The body.
    pub(crate) fn body(&self) -> Inertia {
        let mass = self.0[(3, 3)];
        let com: Vector3<f64> = self.0.fixed_view::<3, 1>(0, 3) / mass;
        let central = self.0.fixed_view::<3, 3>(0, 0) - mass * com * com.transpose();
        let central = 0.5 * (central + central.transpose());
        Inertia { mass, com, tensor: Matrix3::identity() * central.trace() - central }
    }

    /// Its radius of gyration about the frame's origin (m).
    pub(crate) fn radius(&self) -> f64 {
        let moments = self.0[(0, 0)] + self.0[(1, 1)] + self.0[(2, 2)];
        (moments / self.0[(3, 3)]).sqrt().max(LEAST_RADIUS)
    }
}

/// `body` with its mass multiplied by `factor`, its centre of mass moved by `shift` (m) and its extent along the
/// frame's axes multiplied by `stretch`. The result is physical if `body` is.
pub(crate) fn moved(body: &Inertia, factor: f64, shift: [f64; 3], stretch: [f64; 3]) -> Inertia {
    if body.mass <= 0.0 {
        return *body;
    }
    let mut map = Matrix4::identity();
    for axis in 0..3 {
        map[(axis, axis)] = stretch[axis];
        map[(axis, 3)] = shift[axis] + (1.0 - stretch[axis]) * body.com[axis];
    }
    PseudoInertia::of(body).mapped(&(map * factor.sqrt())).body()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body() -> Inertia {
        Inertia {
            mass: 2.0,
            com: Vector3::new(0.1, -0.05, 0.2),
            tensor: Matrix3::new(0.03, 0.002, 0.0, 0.002, 0.04, -0.001, 0.0, -0.001, 0.02),
        }
    }

    #[test]
    fn a_body_is_its_pseudo_inertia() {
        let again = PseudoInertia::of(&body()).body();
        assert!((again.mass - 2.0).abs() < 1e-14 && (again.com - body().com).norm() < 1e-14);
        assert!((again.tensor - body().tensor).norm() < 1e-14);
    }

    /// Mass, centre of mass and moments change independently of each other.
    #[test]
    fn a_body_is_moved_as_requested() {
        let moved = moved(&body(), 1.2, [0.01, 0.0, -0.02], [1.0, 1.0, 1.3]);
        assert!((moved.mass - 2.4).abs() < 1e-12);
        assert!((moved.com - body().com - Vector3::new(0.01, 0.0, -0.02)).norm() < 1e-12);
        let along = |body: &Inertia, axis: usize| 0.5 * body.tensor.trace() - body.tensor[(axis, axis)];
        assert!((along(&moved, 2) - 1.2 * 1.69 * along(&body(), 2)).abs() < 1e-12);
        assert!((along(&moved, 0) - 1.2 * along(&body(), 0)).abs() < 1e-12);
    }
}
