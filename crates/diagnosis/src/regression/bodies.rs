//! Bodies by their ten inertial parameters: pseudo-inertias, the metric between them, and physical consistency.

mod nearest;

pub use nearest::nearest_tensor;

use nalgebra::{Cholesky, DMatrix, DVector, Matrix3, Matrix4, SymmetricEigen};

use crate::thresholds::{LEAST_BODY_LEFT, LEAST_BODY_MASS, LEAST_BODY_RADIUS, LEAST_OF_STEP};

/// Parameters of a link: m, m c (3), Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the link frame's origin.
pub const PER_LINK: usize = 10;
/// The number of them that are not moments of inertia; they come first.
pub const WITHOUT_MOMENTS: usize = 4;

/// The least body of a link, in the place of what the URDF gives of it.
#[derive(Clone, Copy, Debug)]
pub struct LeastBody {
    /// Its mass (kg).
    pub mass: f64,
    /// Its radius of gyration (m).
    pub radius: f64,
}

impl Default for LeastBody {
    fn default() -> Self {
        Self { mass: LEAST_BODY_MASS, radius: LEAST_BODY_RADIUS }
    }
}

/// The pseudo-inertia \[Σ, m c; (m c)ᵀ, m\] of ten inertial parameters, Σ = ½ tr(I) 1 − I.
pub fn pseudo_inertia(parameters: &[f64]) -> Matrix4<f64> {
    let [m, hx, hy, hz, xx, xy, yy, xz, yz, zz] = *parameters else {
        return Matrix4::zeros();
    };
    let half = 0.5 * (xx + yy + zz);
    Matrix4::new(
        half - xx,
        -xy,
        -xz,
        hx, //
        -xy,
        half - yy,
        -yz,
        hy, //
        -xz,
        -yz,
        half - zz,
        hz, //
        hx,
        hy,
        hz,
        m,
    )
}

/// The ten inertial parameters of a pseudo-inertia.
fn parameters_of(pseudo: &Matrix4<f64>) -> [f64; PER_LINK] {
    let second = pseudo.fixed_view::<3, 3>(0, 0);
    let tensor = Matrix3::identity() * second.trace() - second;
    let (x, y, z) = (pseudo[(0, 3)], pseudo[(1, 3)], pseudo[(2, 3)]);
    let i = |a: usize, b: usize| tensor[(a, b)];
    [pseudo[(3, 3)], x, y, z, i(0, 0), i(0, 1), i(1, 1), i(0, 2), i(1, 2), i(2, 2)]
}

/// The physically consistent body nearest to `nominal` + `change` (ten inertial parameters each): relative to the nominal one,
/// its pseudo-inertia has no eigenvalue below [`LEAST_BODY_LEFT`].
pub fn physical(nominal: &[f64], least: LeastBody, change: &[f64]) -> [f64; PER_LINK] {
    let Some(factor) = Cholesky::new(floored(nominal, least)) else {
        return std::array::from_fn(|k| nominal[k] + change[k]);
    };
    let sum: Vec<f64> = nominal.iter().zip(change).map(|(a, b)| a + b).collect();
    let lower = factor.l();
    let Some(inverse) = lower.try_inverse() else {
        return std::array::from_fn(|k| sum[k]);
    };
    let mut eigen = SymmetricEigen::new(inverse * pseudo_inertia(&sum) * inverse.transpose());
    if eigen.eigenvalues.min() >= LEAST_BODY_LEFT {
        return std::array::from_fn(|k| sum[k]);
    }
    eigen.eigenvalues.apply(|value| *value = value.max(LEAST_BODY_LEFT));
    parameters_of(&(lower * eigen.recompose() * lower.transpose()))
}

/// The prior of a link's inertial parameters about a body near which it is quadratic: ½ (δ − m)ᵀ H (δ − m) / ρ².
///
/// The prior is ½ tr(S²) / ρ² with P = L exp(S) Lᵀ, where P₀ = L Lᵀ is the URDF's pseudo-inertia: the square of the distance
/// between the two bodies in the affine-invariant metric of pseudo-inertias (Lee, Wensing and Park, IEEE T-RO 36(2), 2020). No body
/// without mass or without size is within reach, and twice the mass is as far as half of it.
#[derive(Clone, Debug)]
pub struct Quadratic {
    /// H (10 × 10).
    pub precision: DMatrix<f64>,
    /// m, the change of the ten inertial parameters about which the prior is centred.
    pub centre: DVector<f64>,
}

/// The prior of a link that the URDF gives as `nominal`, about the body `nominal` + `change` (ten inertial parameters each).
pub fn prior_about(nominal: &[f64], least: LeastBody, change: &[f64]) -> Quadratic {
    let floor = floored(nominal, least);
    let lower = Cholesky::new(floor).map_or_else(Matrix4::identity, |factor| factor.l());
    let inverse = lower.try_inverse().unwrap_or_else(Matrix4::identity);
    let mut eigen = SymmetricEigen::new(inverse * (floor + pseudo_inertia(change)) * inverse.transpose());
    eigen.eigenvalues.apply(|value| *value = value.max(LEAST_BODY_LEFT));
    let (values, logs) = (eigen.eigenvalues, eigen.eigenvalues.map(f64::ln));
    // The derivative of the logarithm along a change of P (Daleckii and Krein), in the basis of the eigenvectors.
    let slope = |i: usize, k: usize| {
        let (step, mean) = (values[i] - values[k], 0.5 * (values[i] + values[k]));
        if step.abs() < 1e-6 * mean { 1.0 / mean } else { (logs[i] - logs[k]) / step }
    };
    let basis = eigen.eigenvectors.transpose() * inverse;
    let directions: Vec<Matrix4<f64>> = (0..PER_LINK)
        .map(|parameter| {
            let mut unit = [0.0; PER_LINK];
            unit[parameter] = 1.0;
            let along = basis * pseudo_inertia(&unit) * basis.transpose();
            Matrix4::from_fn(|i, k| along[(i, k)] * slope(i, k))
        })
        .collect();
    let precision = DMatrix::from_fn(PER_LINK, PER_LINK, |a, b| (directions[a] * directions[b]).trace());
    let gradient = DVector::from_fn(PER_LINK, |a, _| (0..4).map(|i| logs[i] * directions[a][(i, i)]).sum());
    let body = lower * eigen.recompose() * lower.transpose();
    let about = DVector::from_column_slice(&parameters_of(&(body - floor)));
    let step =
        Cholesky::new(precision.clone()).map_or_else(|| DVector::zeros(PER_LINK), |factor| factor.solve(&gradient));
    Quadratic { precision, centre: about - step }
}

/// The part of `step` that may be taken from the body `nominal` + `change` (ten inertial parameters each) so that in no direction less
/// than [`LEAST_OF_STEP`] of it is left; one if all of it may.
pub fn possible_part(nominal: &[f64], least: LeastBody, change: &[f64], step: &[f64]) -> f64 {
    let body = floored(nominal, least) + pseudo_inertia(change);
    let Some(inverse) = Cholesky::new(body).and_then(|factor| factor.l().try_inverse()) else {
        return 1.0;
    };
    let relative = inverse * pseudo_inertia(step) * inverse.transpose();
    let least = SymmetricEigen::new(relative).eigenvalues.min();
    if least < LEAST_OF_STEP - 1.0 { (LEAST_OF_STEP - 1.0) / least } else { 1.0 }
}

/// The pseudo-inertia of a body, enlarged where its radius of gyration or its mass is less than the `least` one.
fn floored(parameters: &[f64], least: LeastBody) -> Matrix4<f64> {
    let pseudo = pseudo_inertia(parameters);
    let mass = pseudo[(3, 3)].max(least.mass);
    let com = pseudo.fixed_view::<3, 1>(0, 3) / mass;
    let about_com: Matrix3<f64> = pseudo.fixed_view::<3, 3>(0, 0) - mass * com * com.transpose();
    let mut eigen = SymmetricEigen::new(about_com);
    eigen.eigenvalues.apply(|value| *value = value.max(mass * least.radius.powi(2)));
    let second = eigen.recompose() + mass * com * com.transpose();
    let mut floored = Matrix4::zeros();
    floored.fixed_view_mut::<3, 3>(0, 0).copy_from(&second);
    floored.fixed_view_mut::<3, 1>(0, 3).copy_from(&(mass * com));
    floored.fixed_view_mut::<1, 3>(3, 0).copy_from(&(mass * com.transpose()));
    floored[(3, 3)] = mass;
    floored
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The length of δπ = 0.1 π (ten per cent of a body) in the metric is 0.1 √4 in every frame, because tr(1) = 4.
    #[test]
    fn the_metric_does_not_depend_on_units() {
        for (mass, com, size) in [(2.0, [0.1, 0.0, 0.3], 0.2), (40.0, [1.0, -0.5, 0.0], 0.4)] {
            let c: nalgebra::Vector3<f64> = com.into();
            let second = Matrix3::identity() * (mass * size * size) + mass * c * c.transpose();
            let tensor = Matrix3::identity() * second.trace() - second;
            let parameters = [
                mass,
                mass * c.x,
                mass * c.y,
                mass * c.z,
                tensor[(0, 0)],
                tensor[(0, 1)],
                tensor[(1, 1)],
                tensor[(0, 2)],
                tensor[(1, 2)],
                tensor[(2, 2)],
            ];
            let metric = prior_about(&parameters, LeastBody::default(), &[0.0; PER_LINK]).precision;
            let step = DVector::from_iterator(PER_LINK, parameters.iter().map(|p| 0.1 * p));
            let length = (step.transpose() * &metric * &step)[(0, 0)].sqrt();
            assert!((length - 0.2).abs() < 1e-9, "{length}");
            assert!(Cholesky::new(metric).is_some());
        }
    }

    /// Of a body that loses all its mass, the step leaves the stated part; a step that adds to a body is taken whole.
    #[test]
    fn a_step_leaves_a_part_of_the_body() {
        let nominal = [2.0, 0.2, 0.0, 0.4, 0.3, 0.01, 0.4, 0.02, 0.0, 0.2];
        let times = |factor: f64| nominal.map(|value| factor * value);
        let none = [0.0; PER_LINK];
        assert!(
            (possible_part(&nominal, LeastBody::default(), &none, &times(-1.0)) - (1.0 - LEAST_OF_STEP)).abs() < 1e-9
        );
        assert!(
            (possible_part(&nominal, LeastBody::default(), &none, &times(-4.0)) - (1.0 - LEAST_OF_STEP) / 4.0).abs()
                < 1e-9
        );
        // About a body of half its size.
        assert!(
            (possible_part(&nominal, LeastBody::default(), &times(-0.5), &times(-0.5)) - (1.0 - LEAST_OF_STEP)).abs()
                < 1e-9
        );
        for factor in [-0.5, 0.0, 3.0] {
            assert_eq!(possible_part(&nominal, LeastBody::default(), &none, &times(factor)), 1.0, "{factor}");
        }
    }

    /// ½ tr(S²) of a body, by another formula: the eigenvalues of P₀⁻¹ P are those of exp(S).
    fn half_square(nominal: &[f64], change: &[f64]) -> f64 {
        let product = floored(nominal, LeastBody::default()).try_inverse().expect("it is positive")
            * (floored(nominal, LeastBody::default()) + pseudo_inertia(change));
        let logs = product.complex_eigenvalues().map(|value| value.re.ln());
        0.5 * logs.norm_squared()
    }

    /// The quadratic has the slope of the prior at the body about which it is expanded, which may be far from the URDF's.
    #[test]
    fn the_quadratic_has_the_slope_of_the_prior() {
        let nominal = [2.0, 0.2, 0.0, 0.4, 0.3, 0.01, 0.4, 0.02, 0.0, 0.2];
        for change in [[0.0; PER_LINK], [1.5, -0.1, 0.1, 0.3, 0.2, 0.05, 0.3, -0.04, 0.02, 0.1]] {
            let Quadratic { precision, centre } = prior_about(&nominal, LeastBody::default(), &change);
            let slope = precision * (DVector::from_column_slice(&change) - centre);
            for k in 0..PER_LINK {
                let at = |step: f64| {
                    let mut moved = change;
                    moved[k] += step;
                    half_square(&nominal, &moved)
                };
                let expected = (at(1e-6) - at(-1e-6)) / 2e-6;
                assert!((slope[k] - expected).abs() < 1e-5 * expected.abs().max(1.0), "{k}: {} {expected}", slope[k]);
            }
        }
    }
}
