//! Findings from two sensors of one joint: encoders on either side of a spring, torques on either side of a gearbox.

use std::collections::BTreeMap;

use effects::drive::JOINT_ELASTICITY;
use effects::friction::{COULOMB_FRICTION, VISCOUS_FRICTION};
use effects::{Effect, Quantity};
use nalgebra::{DMatrix, DVector};

use crate::data::Data;
use crate::data::input::Input;
use crate::data::signal::Kernel;
use crate::data::statistics::{NORMAL_95, deviation};
use crate::report::{Finding, MOTOR_CURRENT, Parameter, Place, SECOND_ENCODER};
use crate::thresholds::{
    CLEAR_COMPLIANCE, CLEAR_FRICTION, FOLLOWS, FRICTION_EXPLAINS, LARGEST_CUTOFF, LARGEST_DEFLECTION, LEAST_BEND,
    SENSOR_ERRORS, SENSOR_ROWS, SENSOR_SPACING, SENSORS_MOVE,
};

/// A regression on one joint over the recordings.
#[derive(Clone, Debug, Default)]
struct Rows {
    x: Vec<Vec<f64>>,
    y: Vec<f64>,
    held_out: Vec<bool>,
}

/// Coefficients, their standard errors, and the part of the power explained in training and held-out rows.
struct Regression {
    coefficients: Vec<f64>,
    errors: Vec<f64>,
    train: f64,
    held_out: Option<f64>,
}

/// Findings from second encoders, and from motor currents beside torque sensors. No spring is looked for on joints `with_spring`.
pub fn findings(data: &Data, inputs: &[Input<'_>], with_spring: impl Fn(usize) -> bool) -> Vec<Finding> {
    let mut list = Vec::new();
    for joint in 0..data.motions.dof {
        if !with_spring(joint) {
            list.extend(deflection(data, joint, inputs));
        }
        list.extend(between_current_and_sensor(data, joint, inputs));
    }
    list
}

/// The signals of one joint after the filter of the diagnosis, about every tenth of a second, while the joint moves.
fn gather(
    data: &Data,
    joint: usize,
    inputs: &[Input<'_>],
    mut row: impl FnMut(&Input<'_>, &mut dyn FnMut(&[f64], Order) -> Vec<f64>) -> Option<(Vec<Vec<f64>>, Vec<f64>)>,
) -> Rows {
    let mut rows = Rows::default();
    for input in inputs {
        let recording = input.recording;
        for segment in &recording.segments {
            let cutoff = data.motions.cutoff.min(LARGEST_CUTOFF / recording.period);
            let kernel = Kernel::new(cutoff, recording.period);
            let stride = ((SENSOR_SPACING / cutoff / recording.period) as usize).max(1);
            if segment.ticks.len() < 2 * kernel.reach() + SENSOR_ROWS * stride {
                continue;
            }
            let mut filter = |signal: &[f64], order: Order| -> Vec<f64> {
                let signal = &signal[segment.ticks.clone()];
                match order {
                    Order::Value => kernel.smooth(signal, stride),
                    Order::First => kernel.first(signal, stride),
                }
            };
            let speed = filter(&recording.q[joint], Order::First);
            let Some((x, y)) = row(input, &mut filter) else {
                continue;
            };
            for (k, y) in y.into_iter().enumerate() {
                if speed[k].abs() > SENSORS_MOVE * data.scales.rest[joint] {
                    rows.x.push(x.iter().map(|column| column[k]).collect());
                    rows.y.push(y);
                    rows.held_out.push(input.held_out);
                }
            }
        }
    }
    rows
}

/// The order of the derivative of a signal.
#[derive(Clone, Copy)]
enum Order {
    Value,
    First,
}

fn regress(rows: &Rows) -> Option<Regression> {
    let p = rows.x.first()?.len();
    let (mut a, mut b) = (DMatrix::zeros(p, p), DVector::zeros(p));
    let mut count = 0.0;
    for ((x, y), held_out) in rows.x.iter().zip(&rows.y).zip(&rows.held_out) {
        if *held_out {
            continue;
        }
        let x = DVector::from_column_slice(x);
        a += &x * x.transpose();
        b += *y * x;
        count += 1.0;
    }
    if count < (SENSOR_ROWS * p) as f64 {
        return None;
    }
    let inverse = a.try_inverse()?;
    let solution = &inverse * b;
    // The part of the power about the mean that the regression explains.
    let explained = |held_out: bool| -> Option<(f64, f64)> {
        let mut values = Vec::new();
        let mut residual = 0.0;
        for ((x, y), held) in rows.x.iter().zip(&rows.y).zip(&rows.held_out) {
            if *held == held_out {
                values.push(*y);
                residual += (y - solution.dot(&DVector::from_column_slice(x))).powi(2);
            }
        }
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let power: f64 = values.iter().map(|y| (y - mean).powi(2)).sum();
        (values.len() >= SENSOR_ROWS && power > 0.0).then(|| (1.0 - residual / power, residual))
    };
    let (train, residual) = explained(false)?;
    let variance = residual / (count - p as f64);
    Some(Regression {
        errors: (0..p).map(|k| SENSOR_ERRORS * (variance * inverse[(k, k)]).sqrt()).collect(),
        coefficients: solution.as_slice().to_vec(),
        train,
        held_out: explained(true).map(|held| held.0),
    })
}

impl Regression {
    fn follows(&self, least: f64) -> bool {
        self.train > least && self.held_out.is_none_or(|held| held > least)
    }

    fn parameter(&self, k: usize, unit: &'static str) -> Parameter {
        let (value, half) = (self.coefficients[k], NORMAL_95 * self.errors[k]);
        Parameter { value, ci95: [value - half, value + half], unit }
    }

    fn is_clear(&self, k: usize) -> bool {
        self.coefficients[k].abs() > CLEAR_FRICTION * self.errors[k]
    }
}

/// The spring between a joint's two encoders: their difference is proportional to the torque.
fn deflection(data: &Data, joint: usize, inputs: &[Input<'_>]) -> Option<Finding> {
    let rows = gather(data, joint, inputs, |input, filter| {
        let secondary = input.recording.q_secondary.get(joint)?.as_ref()?;
        let q = &input.recording.q[joint];
        let difference: Vec<f64> = secondary.iter().zip(q).map(|(link, motor)| link - motor).collect();
        let y = filter(&difference, Order::Value);
        let ones = vec![1.0; y.len()];
        // An error of the gear ratio appears as a part of the position.
        let place = filter(q, Order::Value);
        let tau: Vec<f64> = filter(&input.recording.tau[joint], Order::Value);
        let friction: Vec<f64> = filter(q, Order::First).iter().map(|v| v.signum()).collect();
        Some((vec![ones, place, tau, friction], y))
    });
    let range = data.scales.range[joint];
    let result = regress(&rows)?;
    let (compliance, error) = (-result.coefficients[2], result.errors[2]);
    let bends = compliance * deviation(rows.x.iter().map(|x| x[2]));
    let total = deviation(rows.y.iter());
    let credible = result.follows(FOLLOWS)
        && compliance > CLEAR_COMPLIANCE * error
        && total < LARGEST_DEFLECTION * range
        && bends > LEAST_BEND * total;
    if !credible {
        return None;
    }
    let kind = data.arm.joints()[joint].kind;
    let unit = Quantity::Stiffness.unit(kind);
    let stiffness = Parameter {
        value: 1.0 / compliance,
        ci95: [1.0 / (compliance + NORMAL_95 * error), 1.0 / (compliance - NORMAL_95 * error)],
        unit,
    };
    let name = data.arm.joints()[joint].name.clone();
    let effect = Effect::of(&JOINT_ELASTICITY).on(name.clone());
    let effect = effect.with("stiffness", stiffness.value).with("damping", 0.0);
    let gain = result.held_out.map(|explained| 1.0 - (1.0 - explained).max(0.0).sqrt());
    Some(finding(effect, &name, BTreeMap::from([("stiffness", stiffness)]), total / range, gain, BY_SECOND_ENCODER))
}

/// The sensors that show what the torque does not, in the JSON and in words.
const BY_SECOND_ENCODER: (&str, &str) = (SECOND_ENCODER, "between the two encoders");
const BY_MOTOR_CURRENT: (&str, &str) = (MOTOR_CURRENT, "between the motor's current and the torque sensor");

/// Two columns are one signal if they differ by no more than this part of its largest value, for rounding.
const SAME_SIGNAL: f64 = 1e-9;

/// Friction between the motor's current and the torque sensor.
fn between_current_and_sensor(data: &Data, joint: usize, inputs: &[Input<'_>]) -> Vec<Finding> {
    let rows = gather(data, joint, inputs, |input, filter| {
        let current = input.recording.tau_current.get(joint)?.as_ref()?;
        let sensor = &input.recording.tau[joint];
        let difference: Vec<f64> = current.iter().zip(sensor).map(|(a, b)| a - b).collect();
        // If both columns are the same signal, no friction is between them.
        let largest = sensor.iter().fold(0.0, |most: f64, tau| most.max(tau.abs()));
        if difference.iter().all(|d| d.abs() <= SAME_SIGNAL * largest) {
            return None;
        }
        let y = filter(&difference, Order::Value);
        let speed = filter(&input.recording.q[joint], Order::First);
        let sign = speed.iter().map(|v| v.signum()).collect();
        let sensed = filter(sensor, Order::Value);
        let ones = vec![1.0; y.len()];
        Some((vec![sign, speed, ones, sensed], y))
    });
    let Some(result) = regress(&rows) else {
        return Vec::new();
    };
    if !result.follows(FRICTION_EXPLAINS) {
        return Vec::new();
    }
    let kind = data.arm.joints()[joint].kind;
    let name = data.arm.joints()[joint].name.clone();
    let torque = data.scales.torque[joint].max(1e-300);
    let gain = result.held_out.map(|explained| 1.0 - (1.0 - explained).max(0.0).sqrt());
    let place = BY_MOTOR_CURRENT;
    let mut list = Vec::new();
    if result.coefficients[0] > 0.0 && result.is_clear(0) {
        let level = result.parameter(0, Quantity::Torque.unit(kind));
        let effect = Effect::of(&COULOMB_FRICTION).on(name.clone());
        let effect = effect.with("level", level.value);
        let share = level.value / torque;
        list.push(finding(effect, &name, BTreeMap::from([("level", level)]), share, gain, place));
    }
    if result.coefficients[1] > 0.0 && result.is_clear(1) {
        let coefficient = result.parameter(1, Quantity::Damping.unit(kind));
        let effect = Effect::of(&VISCOUS_FRICTION).on(name.clone());
        let effect = effect.with("coefficient", coefficient.value);
        let share = coefficient.value * data.scales.speed[joint] / torque;
        list.push(finding(effect, &name, BTreeMap::from([("coefficient", coefficient)]), share, gain, place));
    }
    list
}

fn finding(
    effect: Effect,
    joint: &str,
    parameters: BTreeMap<&'static str, Parameter>,
    share: f64,
    gain: Option<f64>,
    (sensor, between): (&'static str, &str),
) -> Finding {
    let state = Some(between.to_owned());
    Finding {
        parameters,
        share,
        share_by_joint: BTreeMap::from([(joint.to_owned(), share)]),
        held_out_gain: gain,
        sensor: Some(sensor),
        place: Place { state, ..Place::default() },
        ..Finding::of(effect)
    }
}
