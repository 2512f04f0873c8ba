//! The fit of a recording's torques by the URDF's model with corrected columns.

use arm::{Arm, Workspace};

use super::correction::Correction;
use super::smooth::Smooth;
use super::thresholds::{EXPLAINED_BY_MODEL, LEAST_RESIDUAL, NEEDS_MODEL};

/// The fit of measured torques by the model's, with dry and viscous friction and an offset.
pub struct Fit {
    /// The residual variance over the variance of the torque, by joint.
    pub residual_share: Vec<f64>,
    /// The factor of the model's torque, by joint.
    pub factor: Vec<f64>,
    /// The residual variance over the variance of the torque in a fit without the model's torque, by joint.
    pub without: Vec<f64>,
    /// The standard deviation of the measured torque over that of the model's, by joint.
    pub size: Vec<f64>,
}

impl Fit {
    /// Whether the model's torque is needed to explain the joint's.
    pub fn needs_model(&self, joint: usize) -> bool {
        self.residual_share[joint] < EXPLAINED_BY_MODEL
            && self.without[joint] > NEEDS_MODEL * self.residual_share[joint]
    }

    /// The sum of the logarithms of the joints' residuals.
    pub fn score(&self) -> f64 {
        self.residual_share
            .iter()
            .map(|residual_share| residual_share.max(LEAST_RESIDUAL).ln())
            .sum()
    }
}

/// The standard deviation of `values`, with their number as the divisor.
fn deviation(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// The fit of the torques by the model of `arm` with a `correction` of the columns.
pub fn fit(arm: &Arm, smooth: &Smooth, correction: Correction) -> Fit {
    let turned;
    let arm = if let Correction::Gravity(gravity) = correction {
        turned = arm.clone().with_gravity(gravity);
        &turned
    } else {
        arm
    };
    let dof = arm.dof();
    let count = smooth.len();
    let reading = correction.reading(arm);
    // The model along the corrected motion.
    let mut workspace = Workspace::new(arm);
    let mut model = vec![vec![0.0; count]; dof];
    let mut tau = vec![0.0; dof];
    for k in 0..count {
        let pick =
            |signal: &[Vec<f64>]| -> Vec<f64> { reading.iter().map(|r| r.scale * signal[r.position][k]).collect() };
        let (mut q, qd, qdd) = (pick(&smooth.q), pick(&smooth.qd), pick(&smooth.qdd));
        q.iter_mut().zip(&reading).for_each(|(q, r)| *q += r.offset);
        arm.inverse_dynamics(&mut workspace, &q, &qd, &qdd, &mut tau);
        for (joint, tau) in tau.iter().enumerate() {
            model[joint][k] = *tau;
        }
    }
    let mut fit = Fit {
        residual_share: Vec::new(),
        factor: Vec::new(),
        without: Vec::new(),
        size: Vec::new(),
    };
    for (joint, read) in reading.iter().enumerate() {
        let speed: Vec<f64> = smooth.qd[read.position].iter().map(|qd| read.scale * qd).collect();
        let measured: Vec<f64> = smooth.tau[read.torque]
            .iter()
            .map(|tau| read.torque_sign * tau)
            .collect();
        let friction = Friction::new(&speed);
        let (without, _) = friction.fitted(None, &measured);
        let (residual_share, factor) = friction.fitted(Some(&model[joint]), &measured);
        let explains = factor >= 0.0;
        fit.residual_share.push(if explains { residual_share } else { without });
        fit.factor.push(factor);
        fit.without.push(without);
        fit.size
            .push(deviation(&measured) / deviation(&model[joint]).max(f64::MIN_POSITIVE));
    }
    fit
}

/// Dry and viscous friction of a joint, of unit size.
struct Friction<'a> {
    dry: Vec<f64>,
    speed: &'a Vec<f64>,
}

impl<'a> Friction<'a> {
    fn new(speed: &'a Vec<f64>) -> Self {
        let top = speed.iter().fold(1e-9_f64, |top, speed| top.max(speed.abs()));
        let dry = speed.iter().map(|speed| (speed / (0.02 * top)).tanh()).collect();
        Self { dry, speed }
    }

    /// The residual share of `measured` after a fit of friction and of the model's torque, if one is given, and the factor of the model.
    /// Friction that drives the joint is impossible, and is left out.
    fn fitted(&self, model: Option<&Vec<f64>>, measured: &[f64]) -> (f64, f64) {
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let factor_first = |columns: &[&Vec<f64>]| {
            let all: Vec<&Vec<f64>> = columns.iter().copied().chain(model).collect();
            regress(&all, measured).1
        };
        let dry = factor_first(&[&self.dry, self.speed]);
        let viscous = factor_first(&[self.speed, &self.dry]);
        let power = dry * dot(&self.dry, self.speed) + viscous * dot(self.speed, self.speed);
        let friction: &[&Vec<f64>] = if power >= 0.0 { &[&self.dry, self.speed] } else { &[] };
        let all: Vec<&Vec<f64>> = model.into_iter().chain(friction.iter().copied()).collect();
        let (residual_share, factor) = regress(&all, measured);
        (residual_share, if model.is_some() { factor } else { 0.0 })
    }
}

/// The residual variance of `measured` after a least-squares fit of `columns` and an offset, over its variance, and the
/// factor of the first column (Gram-Schmidt orthogonalisation with the first column last).
fn regress(columns: &[&Vec<f64>], measured: &[f64]) -> (f64, f64) {
    let centred = |values: &[f64]| -> Vec<f64> {
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        values.iter().map(|value| value - mean).collect()
    };
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut rest = centred(measured);
    let total = dot(&rest, &rest);
    if total <= 0.0 {
        return (1.0, 0.0);
    }
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut factor = 0.0;
    for column in columns.iter().rev() {
        let mut column = centred(column);
        let before = dot(&column, &column);
        for other in &basis {
            let share = dot(&column, other) / dot(other, other);
            column
                .iter_mut()
                .zip(other)
                .for_each(|(value, other)| *value -= share * other);
        }
        let after = dot(&column, &column);
        factor = 0.0;
        if after > 1e-9 * before && after > 0.0 {
            factor = dot(&rest, &column) / after;
            rest.iter_mut()
                .zip(&column)
                .for_each(|(value, column)| *value -= factor * column);
            basis.push(column);
        }
    }
    (dot(&rest, &rest) / total, factor)
}
