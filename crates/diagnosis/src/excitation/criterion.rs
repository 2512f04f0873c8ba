//! The cost function of the search: the parameters' standard deviations (D-optimality) and the condition number of the base
//! regressor, with penalties beyond the limits.

use arm::{Arm, PARAMETERS_PER_LINK};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::base::{Base, Scratch};
use super::bounds::Allowed;
use super::fourier::Series;

/// Samples per period of the highest harmonic.
const SAMPLES: usize = 14;
/// Step sizes for differences of the regressor: by positions, in which it is smooth; by velocities, in which it is quadratic;
/// by accelerations, in which it is linear.
const STEPS: [f64; 3] = [1e-5, 1.0, 1.0];
/// Added to the scaled information, so that it has an inverse.
const RIDGE: f64 = 1e-10;
/// The weight of the logarithm of the condition number relative to the mean logarithm of the parameters' standard
/// deviations. Without this term, a few combinations of parameters may be determined poorly.
const CONDITION: f64 = 0.5;
/// The exponent of the norm that approximates the largest eigenvalue.
const SMOOTH: i32 = 2;
/// The search stays within this part of the limits, because a motion may go further between the samples.
const INSIDE: f64 = 0.995;

/// The function that is minimised, with its gradient.
pub struct Criterion<'a> {
    arm: &'a Arm,
    base: &'a Base,
    allowed: &'a Allowed,
    /// The motions.
    pub series: &'a Series,
    factors: Vec<[Vec<f64>; 3]>,
    parameters: DVector<f64>,
    scales: DVector<f64>,
}

/// One sample of a motion.
struct Sample {
    state: [Vec<f64>; 3],
    /// The base regressor, dof × columns.
    rows: Vec<f64>,
    torque: Vec<f64>,
}

impl<'a> Criterion<'a> {
    /// The cost function for the motions of `series`.
    pub fn new(arm: &'a Arm, base: &'a Base, allowed: &'a Allowed, series: &'a Series) -> Self {
        let count = SAMPLES * series.harmonics;
        let factors = (0..count).map(|k| series.factors(series.period * k as f64 / count as f64));
        Self {
            arm,
            base,
            allowed,
            series,
            factors: factors.collect(),
            parameters: DVector::from_vec(arm.inertial_parameters()),
            scales: DVector::from_column_slice(&base.scales),
        }
    }

    /// Value and gradient at `coefficients`: the mean over the parameters of the logarithm of their standard deviation (up to a
    /// constant), plus [`CONDITION`] times the logarithm of the condition number, plus `hardness` times the mean square by which
    /// limits are exceeded, relative to them.
    pub fn evaluate(&self, coefficients: &[f64], hardness: f64) -> (f64, Vec<f64>) {
        let samples: Vec<Sample> = self
            .factors
            .par_iter()
            .map_init(|| Scratch::new(self.arm), |scratch, factors| self.sample(scratch, coefficients, factors))
            .collect();
        let (mut value, slopes) = self.information(&samples);
        if !value.is_finite() {
            return (f64::INFINITY, vec![0.0; coefficients.len()]);
        }
        let gradients: Vec<(f64, [Vec<f64>; 3])> = samples
            .par_iter()
            .map_init(|| Scratch::new(self.arm), |scratch, sample| self.gradient(scratch, sample, &slopes, hardness))
            .collect();
        let mut gradient = vec![0.0; coefficients.len()];
        for ((penalty, by), factors) in gradients.iter().zip(&self.factors) {
            value += penalty;
            self.series.add_gradient(&mut gradient, by, factors);
        }
        self.series.project(&mut gradient);
        (value, gradient)
    }

    /// The value without penalties; and for each joint, the matrix that maps a row of the regressor to the gradient with
    /// respect to that row.
    fn information(&self, samples: &[Sample]) -> (f64, Vec<DMatrix<f64>>) {
        let (dof, width) = (self.arm.dof(), self.base.columns.len());
        let count = samples.len() as f64;
        let all: Vec<f64> = samples.iter().flat_map(|sample| sample.rows.iter().copied()).collect();
        // Columns of these matrices are the rows of the regressor: as they are, and scaled.
        let plain = DMatrix::from_vec(width, all.len() / width, all);
        let mut scaled = plain.clone();
        for (k, mut row) in scaled.column_iter_mut().enumerate() {
            row.component_mul_assign(&self.scales);
            row *= self.base.weights[k % dof];
        }
        let mut information = &scaled * scaled.transpose() / count;
        for k in 0..width {
            information[(k, k)] += RIDGE;
        }
        let Some(factor) = information.cholesky() else {
            return (f64::INFINITY, Vec::new());
        };
        let determinant = -factor.l().diagonal().map(f64::ln).sum() / width as f64;
        let inverse = factor.inverse();
        let inverse = DMatrix::from_fn(width, width, |a, b| inverse[(a, b)] * self.scales[a] * self.scales[b]);
        let (spread, by_spread) = spread(&(&plain * plain.transpose() / count));
        let slopes = self.base.weights.iter().map(|weight| {
            let by_determinant = -weight * weight / (width as f64 * count);
            &inverse * by_determinant + &by_spread * (2.0 * CONDITION / count)
        });
        (determinant + CONDITION * spread, slopes.collect())
    }

    fn sample(&self, scratch: &mut Scratch, coefficients: &[f64], factors: &[Vec<f64>; 3]) -> Sample {
        let state = self.series.at(coefficients, factors);
        let width = self.base.columns.len();
        let mut rows = vec![0.0; self.arm.dof() * width];
        self.base.rows(self.arm, scratch, state.each_ref().map(Vec::as_slice), &mut rows);
        let rigid = &scratch.regressor * &self.parameters;
        let joints = self.arm.joints().iter();
        let torque = joints.zip(&state[2]).zip(rigid.iter());
        let torque = torque.map(|((joint, qdd), rigid)| rigid + joint.rotor_inertia * qdd).collect();
        Sample { state, rows, torque }
    }

    /// The penalty of a sample, and the gradient of the cost with respect to its position, velocity and acceleration.
    fn gradient(
        &self,
        scratch: &mut Scratch,
        sample: &Sample,
        slopes: &[DMatrix<f64>],
        hardness: f64,
    ) -> (f64, [Vec<f64>; 3]) {
        let (dof, width) = (self.arm.dof(), self.base.columns.len());
        let inertial = PARAMETERS_PER_LINK * dof;
        let count = self.factors.len() as f64;
        let Sample { state, rows, torque } = sample;
        let [q, qd, qdd] = state;
        let mut by = [vec![0.0; dof], vec![0.0; dof], vec![0.0; dof]];
        let mut penalty = 0.0;
        // The squared excess, and its derivative by the value.
        let mut beyond = |value: f64, most: f64| -> f64 {
            let most = INSIDE * most;
            let excess = value.abs() / most - 1.0;
            if excess > 0.0 {
                penalty += hardness * excess * excess / count;
                2.0 * hardness * excess / most * value.signum() / count
            } else {
                0.0
            }
        };
        // The factors of the regressor's change: from the information, and from the penalties of the torques.
        let mut with = DMatrix::zeros(dof, inertial);
        for j in 0..dof {
            by[0][j] = beyond(q[j] - self.allowed.middle[j], self.allowed.room[j]);
            by[1][j] = beyond(qd[j], self.allowed.velocity[j]);
            by[2][j] = beyond(qdd[j], self.allowed.acceleration[j]);
            let by_torque = beyond(torque[j], self.allowed.torque[j]);
            by[2][j] += by_torque * self.arm.joints()[j].rotor_inertia;
            let row = DVector::from_column_slice(&rows[j * width..(j + 1) * width]);
            let slope = &slopes[j] * row;
            for (&slope, &column) in slope.iter().zip(&self.base.columns) {
                if column < inertial {
                    with[(j, column)] += slope;
                } else if (column - inertial) % dof == j {
                    match (column - inertial) / dof {
                        0 => by[1][j] += slope,
                        1 => {
                            let rest = self.base.rest[j];
                            by[1][j] += slope / rest / (qd[j] / rest).cosh().powi(2);
                        }
                        _ => by[2][j] += slope,
                    }
                }
            }
            if by_torque != 0.0 {
                for (column, parameter) in self.parameters.iter().enumerate() {
                    with[(j, column)] += by_torque * parameter;
                }
            }
        }
        let mut state = state.clone();
        for order in 0..3 {
            for j in 0..dof {
                let here = state[order][j];
                let mut product = |value: f64| {
                    state[order][j] = value;
                    scratch.regress(self.arm, state.each_ref().map(Vec::as_slice));
                    scratch.regressor.dot(&with)
                };
                let step = STEPS[order];
                by[order][j] += (product(here + step) - product(here - step)) / (2.0 * step);
                state[order][j] = here;
            }
        }
        (penalty, by)
    }
}

/// The logarithm of the condition number of rows, made smooth: ln √(‖λ‖ ‖1/λ‖) over the eigenvalues λ of their products
/// with themselves, `matrix`, with the norm of the exponent [`SMOOTH`]. The second value is its derivative with respect to
/// `matrix`.
fn spread(matrix: &DMatrix<f64>) -> (f64, DMatrix<f64>) {
    let eigen = matrix.clone().symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let values = eigen.eigenvalues.map(|value| value.max(RIDGE * RIDGE * largest) / largest);
    let [above, below] = [SMOOTH, -SMOOTH].map(|exponent| values.map(|value| value.powi(exponent)).sum());
    let exponent = f64::from(SMOOTH);
    let slopes = values.map(|value| 0.5 / largest * (value.powi(SMOOTH - 1) / above - value.powi(-SMOOTH - 1) / below));
    let by = &eigen.eigenvectors * DMatrix::from_diagonal(&slopes) * eigen.eigenvectors.transpose();
    (0.5 * (above.ln() + below.ln()) / exponent, by)
}

#[cfg(test)]
mod tests {
    use super::super::bounds::MotionLimits;
    use super::*;

    /// The gradient is that of the value, also where limits are exceeded.
    #[test]
    fn the_gradient_agrees_with_differences() {
        let text = include_str!("../../../../assets/puma560.urdf");
        let arm = Arm::from_urdf_text(text, "puma560.urdf").expect("an arm");
        let arm = arm.with_rotor_inertias(&[0.5, 0.4, 0.3, 0.1, 0.1, 0.1]);
        let mut limits = MotionLimits::of(&arm);
        for limits in &mut limits {
            limits.acceleration = 4.0;
        }
        let allowed = Allowed::new(&arm, &limits).expect("limits");
        let series = Series::new(&allowed, 5, 10.0);
        let base = Base::new(&arm, &allowed);
        // 36 of 60 inertial parameters (Khalil and Dombre 2002), 12 of friction, and the drives of joints 3 to 6.
        let determined = base.determined(&arm);
        assert_eq!((determined.inertial, determined.friction, determined.drive), (36, 12, 4));
        assert_eq!(determined.drive_with_link, ["joint1", "joint2"]);
        let criterion = Criterion::new(&arm, &base, &allowed, &series);
        let waves = |scale: f64, turn: f64| -> Vec<f64> {
            let mut list: Vec<f64> = (0..series.len()).map(|k| scale * (turn * k as f64 + 0.3).sin()).collect();
            series.project(&mut list);
            list
        };
        for (scale, is_beyond) in [(0.05, false), (0.8, true)] {
            let at = waves(scale, 1.7);
            let along = waves(1.0, 0.9);
            let (value, gradient) = criterion.evaluate(&at, 10.0);
            let slope: f64 = gradient.iter().zip(&along).map(|(g, d)| g * d).sum();
            let moved = |step: f64| -> Vec<f64> { at.iter().zip(&along).map(|(a, d)| a + step * d).collect() };
            let difference =
                (criterion.evaluate(&moved(1e-7), 10.0).0 - criterion.evaluate(&moved(-1e-7), 10.0).0) / 2e-7;
            assert!((slope - difference).abs() < 1e-3 * difference.abs().max(1.0), "{slope} instead of {difference}");
            assert_eq!(criterion.evaluate(&at, 20.0).0 > value, is_beyond);
        }
    }

    /// The smooth condition number is at least the condition number, and larger by no more than the number of eigenvalues
    /// allows.
    #[test]
    fn the_spread_is_the_condition_number() {
        let matrix = DMatrix::from_diagonal(&DVector::from_vec(vec![400.0, 9.0, 1.0, 0.04]));
        let (spread, by) = spread(&matrix);
        let condition = (400.0_f64 / 0.04).sqrt();
        assert!((spread.exp() / condition - 1.0).abs() < 0.01, "{}", spread.exp());
        assert!(by[(0, 0)] > 0.0 && by[(3, 3)] < 0.0 && by[(0, 1)].abs() < 1e-12);
    }
}
