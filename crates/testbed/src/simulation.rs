//! The closed loop: a controller drives the plant along the reference.

use std::time::{Duration, Instant};

use anyhow::{Context, ensure};
use arm::{Arm, DMatrix};
use effects::Quantity;
use plant::{Plant, PlantOptions};
use recording::Recording;
use torque::{Command, Controller, Motion, TorqueModel};

use crate::interrupt;
use crate::models::ModelKind;
use crate::scenario::Scenario;
use crate::sensors::Sensors;
use crate::telemetry::Sample;

/// The rate at which the variance of the learned torque is evaluated (Hz). It is expensive, and outside the control step.
const VARIANCE_RATE: f64 = 50.0;

/// The stream of the sensors' noise in the loop, which is independent of that in the training samples.
const LOOP_STREAM: u64 = 1;

/// An observer of a run.
pub trait Observer {
    /// Whether it needs the variance of the learned torque.
    fn wants_variance(&self) -> bool {
        false
    }

    /// Receives a control step that has been computed.
    fn sample(&mut self, sample: &Sample<'_>);
}

/// The outcome of a run.
pub struct Outcome {
    /// Everything measured and commanded, at the control rate.
    pub recording: Recording,
    /// Root mean square of the tracking error, one per joint (rad or m).
    pub rms_error: Vec<f64>,
    /// Largest tracking error, one per joint (rad or m).
    pub max_error: Vec<f64>,
    /// Root mean square of the reference's deviation from its own mean, one per joint (rad or m).
    pub reference_rms: Vec<f64>,
    /// Share of the steps in which the effort limit cut the torque, one per joint.
    pub saturated: Vec<f64>,
    /// The weights of the learned torque, one per joint; empty if it does not fade.
    pub weights: Vec<Weight>,
    /// Simulated time over computing time.
    pub real_time_factor: f64,
    /// Median time of a control step (µs).
    pub control_step_median: f64,
    /// 99th percentile of the time of a control step (µs).
    pub control_step_p99: f64,
}

/// The tracking error of one model, as it is written to JSON.
#[derive(serde::Serialize)]
pub struct Tracking {
    /// The model.
    pub model: ModelKind,
    /// Root mean square, one per joint (rad, or m).
    pub rms_error_rad: Vec<f64>,
    /// Largest, one per joint (rad, or m).
    pub max_error_rad: Vec<f64>,
}

impl Tracking {
    /// The tracking error of a run under `model`.
    pub fn new(model: ModelKind, outcome: &Outcome) -> Self {
        Self { model, rms_error_rad: outcome.rms_error.clone(), max_error_rad: outcome.max_error.clone() }
    }
}

/// The weight of the learned torque of a joint over a run: 1 for all of it, 0 for the rigid body alone.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Weight {
    /// The mean over the steps.
    pub mean: f64,
    /// The least weight.
    pub least: f64,
}

/// Runs `scenario` under `model` from its start on the reference to its end.
///
/// Feedback acts on the state at the start of each control interval. The torque is held over the interval, so that the
/// feed-forward is evaluated at its middle: the error of a held torque is then of second order in the interval.
///
/// # Errors
/// If the controller does not fit the arm, or the motion diverges.
pub fn run(
    scenario: &Scenario,
    kind: ModelKind,
    model: &dyn TorqueModel,
    seed: u64,
    observers: &mut [&mut dyn Observer],
) -> anyhow::Result<Outcome> {
    let arm = &scenario.arm;
    let dof = arm.dof();
    let step = 1.0 / scenario.control_rate;
    let steps = (scenario.duration * scenario.control_rate).round() as usize;
    let options = PlantOptions {
        step,
        viscous: scenario.viscous_friction.clone(),
        coulomb: scenario.coulomb_friction.clone(),
        ..PlantOptions::default()
    };
    let mut plant = Plant::new(arm, &options).context("the plant cannot be built")?;
    let controller_arm = kind.controller_arm(arm, &scenario.nominal_arm());
    let mut controller = Controller::new(model, controller_arm, scenario.feedback.clone())?;
    if scenario.fade && kind.learns() {
        controller = controller.fading();
    }

    let (mut here, mut middle) = (Motion::new(dof), Motion::new(dof));
    scenario.reference.at(0.0, &mut here);
    plant.set_state(&here.q, &here.qd)?;
    let mut command = Command::new(dof);
    let (mut error, mut error_rate) = (vec![0.0; dof], vec![0.0; dof]);
    let mut measured = Motion::new(dof);
    let mut measured_torque = vec![0.0; dof];
    let mut sensors = Sensors::new(&scenario.sensor_noise, seed, LOOP_STREAM);
    let mut accelerations = Accelerations::new(scenario);
    let mut log = Log::new(arm, steps);
    let variance_every = (scenario.control_rate / VARIANCE_RATE).round().max(1.0) as usize;
    let wants_variance = observers.iter().any(|observer| observer.wants_variance());

    let started = Instant::now();
    for k in 0..steps {
        let time = k as f64 * step;
        ensure!(!interrupt::requested(), "interrupted at {time:.1} s; nothing was written");
        sensors.state(plant.q(), plant.qd(), &mut measured.q, &mut measured.qd);
        let control_started = Instant::now();
        scenario.reference.at(time, &mut here);
        scenario.reference.at(time + 0.5 * step, &mut middle);
        controller.feed_forward(&middle.q, &middle.qd, &middle.qdd, &mut command);
        for joint in 0..dof {
            error[joint] = here.q[joint] - measured.q[joint];
            error_rate[joint] = here.qd[joint] - measured.qd[joint];
        }
        controller.feed_back(&measured.q, &error, &error_rate, &mut command);
        let control_time = control_started.elapsed();

        accelerations.of(&mut plant, &command.torque, &mut measured.qdd)?;
        sensors.torque(&command.torque, &mut measured_torque);
        if let Some(weights) = controller.weights() {
            log.weigh(weights);
        }
        log.push(&Step {
            time,
            q: plant.q(),
            measured: &measured,
            measured_torque: &measured_torque,
            reference: &here,
            command: &command,
            control_time,
        });
        let variance = if wants_variance && k % variance_every == 0 {
            controller.variance(&middle.q, &middle.qd, &middle.qdd)
        } else {
            None
        };
        let sample = Sample {
            time,
            q: plant.q(),
            q_ref: &here.q,
            tau_rigid: &command.feedforward.rigid,
            tau_learned: &command.feedforward.learned,
            tau_feedback: &command.feedback,
            tau_applied: &command.torque,
            variance,
        };
        for observer in &mut *observers {
            observer.sample(&sample);
        }
        plant.step(&command.torque).with_context(|| {
            format!("the loop is unstable under the model \"{}\"; {}", kind.flag(), remedy(scenario))
        })?;
    }
    let wall = started.elapsed();
    Ok(log.outcome(scenario.duration / wall.as_secs_f64()))
}

/// A joint moves almost no inertia if it moves less than this share of the largest inertia about any joint.
const NEXT_TO_NONE: f64 = 1e-6;

/// The remedy for an unstable loop: lower gains, or inertia for a joint that moves almost none, which no gains can
/// stabilise.
fn remedy(scenario: &Scenario) -> String {
    let arm = &scenario.arm;
    let mut matrix = DMatrix::zeros(arm.dof(), arm.dof());
    arm.mass_matrix(&mut arm::Workspace::new(arm), &scenario.reference.centre, &mut matrix);
    let inertias = matrix.diagonal();
    let lightest = inertias.imin();
    let unit = Quantity::Inertia.unit(arm.joints()[lightest].kind);
    if inertias[lightest] < NEXT_TO_NONE * inertias.max() {
        format!(
            "joint \"{}\" moves no more than {:.1e} {unit}: correct the <inertial> of the links beyond it, or give the joint a \
             plant.rotor_inertia",
            arm.joints()[lightest].name,
            inertias[lightest]
        )
    } else {
        "lower the gains or raise controller.rate".to_owned()
    }
}

/// The plant's accelerations. They are needed in every step, and are therefore computed by the arm's own forward dynamics,
/// which agree with those of rapier to rounding at a tenth of the cost. With dry friction, the plant itself is needed,
/// because only it knows which joints stick.
struct Accelerations<'a> {
    scenario: &'a Scenario,
    workspace: arm::Workspace,
    torque: Vec<f64>,
    dry: bool,
}

impl<'a> Accelerations<'a> {
    fn new(scenario: &'a Scenario) -> Self {
        Self {
            scenario,
            workspace: arm::Workspace::new(&scenario.arm),
            torque: vec![0.0; scenario.arm.dof()],
            dry: scenario.coulomb_friction.iter().any(|level| *level > 0.0),
        }
    }

    fn of(&mut self, plant: &mut Plant, tau: &[f64], qdd: &mut [f64]) -> Result<(), plant::PlantError> {
        if self.dry {
            return plant.accelerations(tau, qdd);
        }
        let (q, qd) = (plant.q(), plant.qd());
        for (joint, torque) in self.torque.iter_mut().enumerate() {
            *torque = tau[joint] - self.scenario.viscous_friction[joint] * qd[joint];
        }
        self.scenario.arm.forward_dynamics(&mut self.workspace, q, qd, &self.torque, qdd);
        Ok(())
    }
}

/// One control step, for the log.
struct Step<'a> {
    time: f64,
    /// The true positions.
    q: &'a [f64],
    measured: &'a Motion,
    measured_torque: &'a [f64],
    reference: &'a Motion,
    command: &'a Command,
    control_time: Duration,
}

/// The signals of a run so far.
struct Log {
    recording: Recording,
    /// The true positions, which the sensors do not report exactly.
    actual: Vec<Vec<f64>>,
    /// Columns of the reference and of the torque's parts, joint by joint.
    reference: Vec<Vec<f64>>,
    rigid: Vec<Vec<f64>>,
    learned: Vec<Vec<f64>>,
    feedback: Vec<Vec<f64>>,
    saturated: Vec<usize>,
    /// Sum and least of the weights, joint by joint.
    weights: Vec<Weight>,
    control_times: Vec<Duration>,
}

impl Log {
    fn new(arm: &Arm, steps: usize) -> Self {
        let signal = || vec![Vec::with_capacity(steps); arm.dof()];
        Self {
            recording: Recording {
                joints: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
                time: Vec::with_capacity(steps),
                q: signal(),
                qd: Some(signal()),
                qdd: Some(signal()),
                tau: signal(),
                ..Recording::default()
            },
            actual: signal(),
            reference: signal(),
            rigid: signal(),
            learned: signal(),
            feedback: signal(),
            saturated: vec![0; arm.dof()],
            weights: Vec::new(),
            control_times: Vec::with_capacity(steps),
        }
    }

    fn weigh(&mut self, weights: &[f64]) {
        let none = Weight { mean: 0.0, least: 1.0 };
        self.weights.resize(weights.len(), none);
        for (sum, &weight) in self.weights.iter_mut().zip(weights) {
            sum.mean += weight;
            sum.least = sum.least.min(weight);
        }
    }

    fn push(&mut self, step: &Step<'_>) {
        let append = |signal: &mut Vec<Vec<f64>>, values: &[f64]| {
            for (column, value) in signal.iter_mut().zip(values) {
                column.push(*value);
            }
        };
        self.recording.time.push(step.time);
        append(&mut self.recording.q, &step.measured.q);
        append(self.recording.qd.get_or_insert_default(), &step.measured.qd);
        append(self.recording.qdd.get_or_insert_default(), &step.measured.qdd);
        append(&mut self.recording.tau, step.measured_torque);
        append(&mut self.actual, step.q);
        append(&mut self.reference, &step.reference.q);
        append(&mut self.rigid, &step.command.feedforward.rigid);
        append(&mut self.learned, &step.command.feedforward.learned);
        append(&mut self.feedback, &step.command.feedback);
        for (count, cut) in self.saturated.iter_mut().zip(&step.command.saturated) {
            *count += usize::from(*cut);
        }
        self.control_times.push(step.control_time);
    }

    fn outcome(self, real_time_factor: f64) -> Outcome {
        let mut recording = self.recording;
        let steps = recording.time.len() as f64;
        let errors: Vec<Vec<f64>> = self
            .reference
            .iter()
            .zip(&self.actual)
            .map(|(reference, q)| reference.iter().zip(q).map(|(r, q)| r - q).collect())
            .collect();
        let rms = |error: &Vec<f64>| (error.iter().map(|e| e * e).sum::<f64>() / steps).sqrt();
        let max = |error: &Vec<f64>| error.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
        let (rms_error, max_error) = (errors.iter().map(rms).collect(), errors.iter().map(max).collect());
        let deviations = |reference: &Vec<f64>| {
            let mean = reference.iter().sum::<f64>() / steps;
            rms(&reference.iter().map(|r| r - mean).collect())
        };
        let reference_rms = self.reference.iter().map(deviations).collect();
        let parts = [
            ("reference", self.reference),
            ("tau_rigid", self.rigid),
            ("tau_learned", self.learned),
            ("tau_feedback", self.feedback),
        ];
        for (name, signal) in parts {
            for (joint, values) in recording.joints.iter().zip(signal) {
                recording.others.push((format!("{name}_{joint}"), values));
            }
        }
        let mut times = self.control_times;
        times.sort_unstable();
        let percentile = |share: f64| {
            let index = (share * (times.len().saturating_sub(1)) as f64).round() as usize;
            times.get(index).map_or(0.0, |time| time.as_secs_f64() * 1e6)
        };
        let mean = |sum: &Weight| Weight { mean: sum.mean / steps, ..*sum };
        Outcome {
            weights: self.weights.iter().map(mean).collect(),
            rms_error,
            max_error,
            reference_rms,
            saturated: self.saturated.iter().map(|count| *count as f64 / steps).collect(),
            real_time_factor,
            control_step_median: percentile(0.5),
            control_step_p99: percentile(0.99),
            recording,
        }
    }
}

#[cfg(test)]
mod tests;
