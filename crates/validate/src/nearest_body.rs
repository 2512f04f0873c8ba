//! The physically possible body that is nearest to an estimate.

use arm::{Inertia, Matrix3};

/// The mass of links that the URDF leaves massless (kg); MuJoCo requires more than 1e-15.
pub const LEAST_MASS: f64 = 1e-12;
const LEAST_MOMENT: f64 = 1e-13;
/// The share of a body's largest second moment of mass by which its smallest may be negative, for rounding.
const ROUNDING: f64 = 1e-9;

/// The body with a mass and a tensor that simulators accept, and whether the tensor was physically impossible.
pub fn nearest_body(body: &Inertia) -> (Inertia, bool) {
    // The second moments of mass, ½ tr(I) 1 − I, of a body are not negative.
    let second = Matrix3::identity() * (0.5 * body.tensor.trace()) - body.tensor;
    let mut parts = second.symmetric_eigen();
    let largest = parts.eigenvalues.amax();
    let is_wrong = parts.eigenvalues.min() < -1e-6 * largest;
    let least = (ROUNDING * largest).max(LEAST_MOMENT);
    if parts.eigenvalues.min() >= least && body.mass >= LEAST_MASS {
        return (*body, false);
    }
    parts.eigenvalues.iter_mut().for_each(|value| *value = value.max(least));
    let second = parts.recompose();
    let possible = Inertia {
        mass: body.mass.max(LEAST_MASS),
        com: body.com,
        tensor: Matrix3::identity() * second.trace() - second,
    };
    (possible, is_wrong)
}
