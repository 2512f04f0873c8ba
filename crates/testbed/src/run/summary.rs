//! The summary of a run, as it is written to JSON.

use serde::Serialize;
use torque::Feedback;

use super::fitted::{Energies, Regression};
use crate::cli::LengthScalesArg;
use crate::models::ModelKind;
use crate::scenario::Scenario;
use crate::simulation::{Tracking, Weight};

/// The content of a run's summary.json.
#[derive(Serialize)]
pub struct Summary<'a> {
    /// The format.
    pub schema: &'static str,
    pub scenario: &'a str,
    pub robot: &'a str,
    pub joints: Vec<&'a str>,
    pub train: &'a [String],
    pub seed: u64,
    /// What describes the run.
    pub settings: Settings<'a>,
    pub tracking: [Tracking; 1],
    /// Mean squared error of the torque that is fed forward on the samples of the reference, (N m)² or N²; with the fade, if there is one.
    pub torque_mse: Vec<f64>,
    /// Share of the control steps in which the effort limit cut the torque.
    pub saturated: Vec<f64>,
    pub real_time_factor: f64,
    pub control_step_us: Percentiles,
    /// The weights of the learned torques, one per joint; absent if they do not fade.
    #[serde(skip_serializing_if = "<[Weight]>::is_empty")]
    pub fade_weights: &'a [Weight],
    /// The regressions of the model, one per joint; empty if it does not learn.
    pub regressions: Vec<Regression>,
    /// The regression of all joints by energies; absent if the model has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energies: Option<Energies<'a>>,
}

#[derive(Serialize)]
pub struct Percentiles {
    pub median: f64,
    pub p99: f64,
}

/// What describes the run, with the tables and keys of a scenario's file. Lists have one entry per joint.
#[derive(Serialize)]
pub struct Settings<'a> {
    /// The scenario's file; `scenarios/NAME.toml` for one that comes with testbed.
    path: String,
    /// Length of the run (s).
    duration: f64,
    model: Model,
    reference: Rate,
    controller: Control<'a>,
    training: Training,
    plant: Friction<'a>,
    sensors: Noise<'a>,
}

#[derive(Serialize)]
struct Model {
    kind: String,
    inertia_scale: f64,
    /// Absent if the model's regressions have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    length_scales: Option<String>,
    /// The number of inducing points that was asked for; absent if none was.
    #[serde(skip_serializing_if = "Option::is_none")]
    inducing: Option<usize>,
    /// Whether the learned torque fades; absent from a model that does not learn.
    #[serde(skip_serializing_if = "Option::is_none")]
    fade: Option<bool>,
}

#[derive(Serialize)]
struct Rate {
    /// Rate of the samples for training and torque error (Hz).
    sample_rate: f64,
}

#[derive(Serialize)]
struct Control<'a> {
    /// Hz.
    rate: f64,
    feedback: &'static str,
    /// 1/s² with the feedback "mass-matrix", N m/rad or N/m with "gains".
    kp: &'a [f64],
    /// 1/s with the feedback "mass-matrix", N m s/rad or N s/m with "gains".
    kd: &'a [f64],
}

#[derive(Serialize)]
struct Training {
    /// The number of samples that the model was trained on; 0 for one that does not learn.
    samples: usize,
}

#[derive(Serialize)]
struct Friction<'a> {
    /// N m s/rad or N s/m.
    viscous_friction: &'a [f64],
    /// N m or N.
    coulomb_friction: &'a [f64],
}

#[derive(Serialize)]
struct Noise<'a> {
    /// rad or m.
    position_noise: &'a [f64],
    /// rad/s or m/s.
    velocity_noise: &'a [f64],
    /// N m or N.
    torque_noise: &'a [f64],
}

impl<'a> Settings<'a> {
    /// The settings of a run of `scenario` under the model `kind`, trained on `samples` samples with `length_scales`.
    pub fn new(
        scenario: &'a Scenario,
        kind: ModelKind,
        length_scales: Option<LengthScalesArg>,
        inducing: Option<usize>,
        samples: usize,
    ) -> Self {
        let (feedback, kp, kd) = match &scenario.feedback {
            Feedback::MassMatrix { kp, kd } => ("mass-matrix", kp, kd),
            Feedback::Gains { kp, kd } => ("gains", kp, kd),
        };
        let noise = &scenario.sensor_noise;
        Self {
            path: scenario.path.display().to_string(),
            duration: scenario.duration,
            model: Model {
                kind: kind.flag(),
                inertia_scale: scenario.inertia_scale,
                length_scales: length_scales.map(LengthScalesArg::flag),
                inducing: inducing.filter(|_| kind.learns()),
                fade: kind.learns().then_some(scenario.fade),
            },
            reference: Rate { sample_rate: scenario.sample_rate },
            controller: Control { rate: scenario.control_rate, feedback, kp, kd },
            training: Training { samples },
            plant: Friction {
                viscous_friction: &scenario.viscous_friction,
                coulomb_friction: &scenario.coulomb_friction,
            },
            sensors: Noise {
                position_noise: &noise.position,
                velocity_noise: &noise.velocity,
                torque_noise: &noise.torque,
            },
        }
    }
}
