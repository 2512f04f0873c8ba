//! The base parameters: the combinations of inertial parameters, friction and drive inertias that motions determine, and how
//! well one motion does.

use arm::{Arm, PARAMETERS_PER_LINK, Workspace};
use nalgebra::{DMatrix, DVector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use torque::{Motion, Reference};

use super::Quality;
use super::bounds::Allowed;

/// The states in which columns are compared.
const STATES: usize = 120;
/// The number of columns of friction and drive inertia per joint.
const OWN: usize = 3;
/// A column whose distance from the span of others is below this part of its norm depends on them.
const DEPENDENT: f64 = 1e-7;
/// The part of the allowed speed within which dry friction changes its sign, by a smooth step.
const REST: f64 = 0.01;
/// The rate of the samples on which a motion is evaluated (Hz).
const SAMPLED: f64 = 50.0;
/// The frequency from which the typical accelerations follow (Hz).
const TYPICAL: f64 = 0.4;
/// The ratio to the largest eigenvalue below which one counts as zero.
const SINGULAR: f64 = 1e-15;

/// The number of parameters that can be determined. Only sums of the others enter the torque, in every motion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Determined {
    /// Combinations of the links' inertial parameters.
    pub inertial: usize,
    /// All inertial parameters: ten per link.
    pub of_inertial: usize,
    /// Coefficients of viscous friction and levels of Coulomb friction.
    pub friction: usize,
    /// Drive inertias that can be distinguished from the links' inertial parameters.
    pub drive: usize,
    /// The joints whose drive inertia cannot be distinguished from the links' inertia in any motion.
    pub drive_with_link: Vec<String>,
}

impl Determined {
    /// The number of all determined parameters.
    pub fn total(&self) -> usize {
        self.inertial + self.friction + self.drive
    }
}

/// The independent columns, and their scales.
#[derive(Clone, Debug)]
pub struct Base {
    dof: usize,
    /// The indices of the columns: 10 per link, then viscous friction, Coulomb friction and drive inertia, one per joint each.
    pub columns: Vec<usize>,
    /// The reciprocal of each column's root mean square over typical states.
    pub scales: Vec<f64>,
    /// The reciprocal of each joint's torque scale: the allowed torque, or the one that it typically needs.
    pub weights: Vec<f64>,
    /// The speed within which dry friction changes sign (rad/s or m/s).
    pub rest: Vec<f64>,
}

/// Workspace for one evaluation of the columns.
pub struct Scratch {
    workspace: Workspace,
    /// dof × 10 dof.
    pub regressor: DMatrix<f64>,
}

impl Scratch {
    /// A workspace for `arm`.
    pub fn new(arm: &Arm) -> Self {
        let dof = arm.dof();
        Self { workspace: Workspace::new(arm), regressor: DMatrix::zeros(dof, PARAMETERS_PER_LINK * dof) }
    }

    /// Computes the torque regressor at a state into `regressor`.
    pub fn regress(&mut self, arm: &Arm, [q, qd, qdd]: [&[f64]; 3]) {
        arm.torque_regressor(&mut self.workspace, q, qd, qdd, &mut self.regressor);
    }
}

impl Base {
    /// The base parameters of `arm` within what is `allowed`.
    pub fn new(arm: &Arm, allowed: &Allowed) -> Self {
        let dof = arm.dof();
        let rest: Vec<f64> = allowed.velocity.iter().map(|speed| REST * speed).collect();
        let all = dof * (PARAMETERS_PER_LINK + OWN);
        let mut base = Self { dof, columns: (0..all).collect(), scales: vec![1.0; all], weights: vec![1.0; dof], rest };
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut scratch = Scratch::new(arm);
        let mut rows = DMatrix::zeros(STATES * dof, all);
        let mut torque = vec![0.0_f64; dof];
        let mut one = vec![0.0; dof * all];
        for state in 0..STATES {
            let mut draw = |size: &dyn Fn(usize) -> f64| -> Vec<f64> {
                (0..dof).map(|j| size(j) * random.random_range(-1.0..1.0)).collect()
            };
            let mut q = draw(&|j| allowed.room[j]);
            q.iter_mut().zip(&allowed.middle).for_each(|(q, middle)| *q += middle);
            let qd = draw(&|j| allowed.velocity[j]);
            let quick = |j: usize| {
                let typical = std::f64::consts::TAU * TYPICAL * allowed.velocity[j];
                typical.min(allowed.acceleration[j])
            };
            let qdd = draw(&quick);
            base.rows(arm, &mut scratch, [&q, &qd, &qdd], &mut one);
            for j in 0..dof {
                for (column, value) in one[j * all..(j + 1) * all].iter().enumerate() {
                    rows[(state * dof + j, column)] = *value;
                }
            }
            let parameters = DVector::from_vec(arm.inertial_parameters());
            let tau = &scratch.regressor * parameters;
            torque.iter_mut().zip(tau.iter()).for_each(|(sum, tau)| *sum += tau * tau / STATES as f64);
        }
        base.weights = (0..dof)
            .map(|j| {
                let scale = if allowed.torque[j].is_finite() { allowed.torque[j] } else { torque[j].sqrt() };
                if scale > 0.0 { 1.0 / scale } else { 1.0 }
            })
            .collect();
        let (columns, scales) = independent(&rows);
        base.columns = columns;
        base.scales = scales;
        base
    }

    /// The independent columns in one state, joint by joint: dof × the number of columns.
    pub fn rows(&self, arm: &Arm, scratch: &mut Scratch, state: [&[f64]; 3], rows: &mut [f64]) {
        scratch.regress(arm, state);
        let [_, qd, qdd] = state;
        let inertial = PARAMETERS_PER_LINK * self.dof;
        let width = self.columns.len();
        for (j, row) in rows.chunks_exact_mut(width).enumerate() {
            for (value, &column) in row.iter_mut().zip(&self.columns) {
                *value = if column < inertial {
                    scratch.regressor[(j, column)]
                } else if (column - inertial) % self.dof == j {
                    match (column - inertial) / self.dof {
                        0 => qd[j],
                        1 => (qd[j] / self.rest[j]).tanh(),
                        _ => qdd[j],
                    }
                } else {
                    0.0
                };
            }
        }
    }

    /// The numbers of the base parameters by kind.
    pub fn determined(&self, arm: &Arm) -> Determined {
        let inertial = PARAMETERS_PER_LINK * self.dof;
        let kind = |column: &usize| column.checked_sub(inertial).map(|own| own / self.dof);
        let count = |wanted: &dyn Fn(Option<usize>) -> bool| self.columns.iter().filter(|c| wanted(kind(c))).count();
        let is_determined = |j: &usize| self.columns.contains(&(inertial + 2 * self.dof + j));
        let names = arm.joints().iter().map(|joint| joint.name.clone());
        Determined {
            inertial: count(&|kind| kind.is_none()),
            of_inertial: inertial,
            friction: count(&|kind| matches!(kind, Some(0 | 1))),
            drive: count(&|kind| kind == Some(2)),
            drive_with_link: names.enumerate().filter(|(j, _)| !is_determined(j)).map(|(_, name)| name).collect(),
        }
    }

    /// The information of `reference` over `duration` (s).
    pub fn measure(&self, arm: &Arm, reference: &Reference, duration: f64) -> Measured {
        let mut motion = Motion::new(self.dof);
        let samples = (0..(duration * SAMPLED) as usize).map(|k| {
            reference.at(k as f64 / SAMPLED, &mut motion);
            [motion.q.clone(), motion.qd.clone(), motion.qdd.clone()]
        });
        self.sum(arm, samples)
    }

    /// The information of samples of position, velocity and acceleration.
    pub fn sum(&self, arm: &Arm, samples: impl Iterator<Item = [Vec<f64>; 3]>) -> Measured {
        let width = self.columns.len();
        let mut scratch = Scratch::new(arm);
        let mut rows = vec![0.0; self.dof * width];
        let mut measured = Measured { plain: DMatrix::zeros(width, width), weighted: DMatrix::zeros(width, width) };
        let mut count = 0_u32;
        for [q, qd, qdd] in samples {
            self.rows(arm, &mut scratch, [&q, &qd, &qdd], &mut rows);
            for (row, weight) in rows.chunks_exact(width).zip(&self.weights) {
                let row = DVector::from_column_slice(row);
                measured.plain.syger(1.0, &row, &row, 1.0);
                measured.weighted.syger(weight * weight, &row, &row, 1.0);
            }
            count += 1;
        }
        for matrix in [&mut measured.plain, &mut measured.weighted] {
            *matrix /= f64::from(count.max(1));
            matrix.fill_upper_triangle_with_lower_triangle();
        }
        measured
    }
}

/// The columns of `rows` that are independent of earlier ones, and the reciprocal of each one's root mean square.
fn independent(rows: &DMatrix<f64>) -> (Vec<usize>, Vec<f64>) {
    let size: Vec<f64> = rows.column_iter().map(|column| column.norm() / (rows.nrows() as f64).sqrt()).collect();
    let largest = size.iter().copied().fold(0.0, f64::max);
    let (mut columns, mut scales, mut basis) = (Vec::new(), Vec::new(), Vec::<DVector<f64>>::new());
    for (column, &size) in size.iter().enumerate() {
        if size <= 1e-12 * largest {
            continue;
        }
        let whole: DVector<f64> = rows.column(column).into_owned();
        let mut residual = whole.clone();
        // Two passes of orthogonalisation are sufficient (Kahan).
        for _ in 0..2 {
            for unit in &basis {
                let part = unit.dot(&residual);
                residual.axpy(-part, unit, 1.0);
            }
        }
        if residual.norm() > DEPENDENT * whole.norm() {
            columns.push(column);
            scales.push(1.0 / size);
            basis.push(residual.normalize());
        }
    }
    (columns, scales)
}

/// The information matrices of a motion, per sample.
pub struct Measured {
    /// From unscaled rows.
    plain: DMatrix<f64>,
    /// From rows divided by the joints' torque scales.
    weighted: DMatrix<f64>,
}

impl Measured {
    /// The quality of the motion for the parameters, compared with the `proposed` motion.
    pub fn quality(&self, proposed: &Self) -> Quality {
        let norms = self.plain.diagonal().map(f64::sqrt);
        let scaled = DMatrix::from_fn(norms.len(), norms.len(), |a, b| self.plain[(a, b)] / (norms[a] * norms[b]));
        let information = |measured: &Self| {
            let scale = proposed.weighted.diagonal().map(|value| 1.0 / value.sqrt());
            let matrix =
                DMatrix::from_fn(scale.len(), scale.len(), |a, b| measured.weighted[(a, b)] * scale[a] * scale[b]);
            let values = matrix.symmetric_eigenvalues();
            let largest = values.max();
            let logarithms =
                values.map(|value| if value > SINGULAR * largest { value.ln() } else { f64::NEG_INFINITY });
            logarithms.sum() / (2.0 * scale.len() as f64)
        };
        Quality {
            condition: condition(&self.plain),
            scaled_condition: if norms.min() > 0.0 { condition(&scaled) } else { f64::INFINITY },
            deviation: (information(proposed) - information(self)).exp(),
        }
    }
}

/// The condition number of rows with the Gram matrix `matrix`.
fn condition(matrix: &DMatrix<f64>) -> f64 {
    let values = matrix.clone().symmetric_eigenvalues();
    let (least, most) = (values.min(), values.max());
    if least > SINGULAR * most { (most / least).sqrt() } else { f64::INFINITY }
}
