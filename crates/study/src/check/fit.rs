//! The fit of a recording's torques by the URDF's model with corrected columns.

use arm::Arm;
use recording::statistics::eliminate;

use super::correction::{Correction, JointReading};
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
        self.residual_share.iter().map(|residual_share| residual_share.max(LEAST_RESIDUAL).ln()).sum()
    }
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
    let count = smooth.len();
    let reading = correction.reading(arm);
    // The corrected motion and the model along it, joint after joint.
    let read = |signal: &[Vec<f64>], with_offset: bool| -> Vec<f64> {
        let of = |r: &JointReading| {
            let (scale, offset) = (r.scale, if with_offset { r.offset } else { 0.0 });
            signal[r.position].iter().map(move |value| scale * value + offset)
        };
        reading.iter().flat_map(of).collect()
    };
    let (q, qd, qdd) = (read(&smooth.q, true), read(&smooth.qd, false), read(&smooth.qdd, false));
    let mut model = vec![0.0; q.len()];
    arm.inverse_dynamics_batch(&q, &qd, &qdd, &mut model);
    let mut fit = Fit { residual_share: Vec::new(), factor: Vec::new(), without: Vec::new(), size: Vec::new() };
    for (joint, read) in reading.iter().enumerate() {
        let own = joint * count..(joint + 1) * count;
        let (model, speed) = (&model[own.clone()], &qd[own]);
        let direction = read.scale.signum();
        let dry: Vec<f64> = smooth.dry[read.position].iter().map(|dry| direction * dry).collect();
        let measured: Vec<f64> = smooth.tau[read.torque].iter().map(|tau| read.torque_sign * tau).collect();
        let products = Products::new([model, &dry, speed, &measured]);
        let (without, _) = products.fitted(&[]);
        let (residual_share, factor) = products.fitted(&[MODEL]);
        let explains = factor >= 0.0;
        fit.residual_share.push(if explains { residual_share } else { without });
        fit.factor.push(factor);
        fit.without.push(without);
        let [model, measured] =
            [MODEL, MEASURED].map(|signal| (products.centred[signal][signal] / count as f64).sqrt());
        fit.size.push(measured / model.max(f64::MIN_POSITIVE));
    }
    fit
}

/// The residual variance of a joint's torque over its variance if an inertia of its drive explains it, with friction and an offset, and
/// not the model's torque.
pub fn residual_share_of_drive(smooth: &Smooth, joint: usize) -> f64 {
    let products = Products::new([&smooth.qdd[joint], &smooth.dry[joint], &smooth.qd[joint], &smooth.tau[joint]]);
    let (without, _) = products.fitted(&[]);
    let (residual_share, inertia) = products.fitted(&[MODEL]);
    if inertia > 0.0 { residual_share } else { without }
}

/// The signals of a joint: the model's torque, dry and viscous friction of unit size, and the measured torque.
const SIGNALS: usize = 4;
const MODEL: usize = 0;
const DRY: usize = 1;
const VISCOUS: usize = 2;
const MEASURED: usize = 3;

/// Inner products of the signals of a joint.
struct Products {
    /// Of their deviations from their means.
    centred: [[f64; SIGNALS]; SIGNALS],
    /// Of the velocity with dry and with viscous friction, means included.
    with_speed: [f64; 2],
}

impl Products {
    fn new(signals: [&[f64]; SIGNALS]) -> Self {
        let count = signals[MEASURED].len();
        let means = signals.map(|signal| signal.iter().sum::<f64>() / count.max(1) as f64);
        let mut centred = [[0.0; SIGNALS]; SIGNALS];
        for k in 0..count {
            let values: [f64; SIGNALS] = std::array::from_fn(|signal| signals[signal][k] - means[signal]);
            for (row, a) in centred.iter_mut().zip(values) {
                row.iter_mut().zip(values).for_each(|(sum, b)| *sum += a * b);
            }
        }
        let with_speed = |a: usize| centred[a][VISCOUS] + count as f64 * means[a] * means[VISCOUS];
        Self { centred, with_speed: [DRY, VISCOUS].map(with_speed) }
    }

    /// The residual share of the measured torque after a fit of friction and of the signals in `model`, and the factor of the first of
    /// these. Friction that drives the joint is impossible, and is left out.
    fn fitted(&self, model: &[usize]) -> (f64, f64) {
        let factor_of_first = |friction: [usize; 2]| self.regress(&[&friction, model].concat()).1;
        let (dry, viscous) = (factor_of_first([DRY, VISCOUS]), factor_of_first([VISCOUS, DRY]));
        let power = dry * self.with_speed[0] + viscous * self.with_speed[1];
        let friction: &[usize] = if power >= 0.0 { &[DRY, VISCOUS] } else { &[] };
        self.regress(&[model, friction].concat())
    }

    /// The residual variance of the measured torque after a least-squares fit of `signals` and an offset, over its variance, and the
    /// factor of the first signal: they are eliminated from the inner products one by one, the first one last. A signal that hardly
    /// differs from those eliminated before is left out.
    fn regress(&self, signals: &[usize]) -> (f64, f64) {
        let total = self.centred[MEASURED][MEASURED];
        if total <= 0.0 {
            return (1.0, 0.0);
        }
        let mut left = self.centred;
        let mut factor = 0.0;
        for &signal in signals.iter().rev() {
            let row = eliminate(&mut left, &self.centred, signal);
            factor = row.map_or(0.0, |row| row[MEASURED] / row[signal]);
        }
        (left[MEASURED][MEASURED].max(0.0) / total, factor)
    }
}
