//! Scenarios: a robot that follows a reference under a controller.

mod raw;
pub mod recorded;
mod validate;
pub mod writer;

use std::path::PathBuf;

use anyhow::Context;
use arm::Arm;
use torque::{Feedback, Reference};

use crate::cli::{ChainArgs, LengthScalesArg};
use crate::models::ModelKind;
use crate::sensors::SensorNoise;

/// A validated scenario. Vectors have one entry per joint of the arm.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The name by which it was requested, without folder and extension.
    pub name: String,
    /// Its file.
    pub path: PathBuf,
    /// A description in one line.
    pub title: String,
    /// The true arm, with the drives' inertia.
    pub arm: Arm,
    /// The path of the URDF; meshes are searched beside it.
    pub urdf: PathBuf,
    /// Length of the run (s).
    pub duration: f64,
    /// The torque model, unless the command line gives another.
    pub model: ModelKind,
    /// The length scales of its regressions, unless the command line gives others.
    pub length_scales: LengthScalesArg,
    /// Whether its learned torque fades to zero away from the training data, unless the command line decides.
    pub fade: bool,
    /// The factor on the masses and inertia tensors of the controller's model.
    pub inertia_scale: f64,
    /// The motion to follow.
    pub reference: Reference,
    /// Rate at which the reference is sampled for training and torque error (Hz).
    pub sample_rate: f64,
    /// Rate of the control loop (Hz).
    pub control_rate: f64,
    /// Feedback law and gains.
    pub feedback: Feedback,
    /// The scenarios that models are trained on by default.
    pub training: Vec<String>,
    /// Viscous friction of the plant (N m s/rad or N s/m).
    pub viscous_friction: Vec<f64>,
    /// Coulomb friction of the plant (N m or N).
    pub coulomb_friction: Vec<f64>,
    /// Doubts about the robot.
    pub notes: Vec<String>,
    /// The noise of the sensors.
    pub sensor_noise: SensorNoise,
}

impl Scenario {
    /// Reads the scenario `name`: a file, or the name of one that comes with testbed.
    ///
    /// # Errors
    /// In one line: file, line, key, reason and remedy.
    pub fn load(name: &str) -> anyhow::Result<Self> {
        Self::load_chain(name, &ChainArgs::default())
    }

    /// Loads a scenario as [`Self::load`] does, with the joints that `chain` selects in place of the file's.
    ///
    /// # Errors
    /// Those of [`Self::load`].
    pub fn load_chain(name: &str, chain: &ChainArgs) -> anyhow::Result<Self> {
        Self::read(&crate::library::find_scenario(name)?, chain)
    }

    /// Reads the scenario `name` that comes with testbed, whatever is below the current folder.
    ///
    /// # Errors
    /// If there is no such scenario.
    pub fn built_in(name: &str) -> anyhow::Result<Self> {
        let source = crate::library::built_in_scenario(name);
        let source = source.with_context(|| format!("no scenario \"{name}\" comes with testbed"))?;
        Self::read(&source, &ChainArgs::default())
    }

    fn read(source: &study::Source, chain: &ChainArgs) -> anyhow::Result<Self> {
        let raw = raw::parse(source)?;
        validate::scenario(source, raw, chain)
    }

    /// The arm in the controller's model: masses and inertia tensors multiplied by the scenario's factor.
    pub fn nominal_arm(&self) -> Arm {
        self.arm.clone().with_scaled_inertias(self.inertia_scale)
    }

    /// Time and state of the reference samples, from 0, `sample_rate` apart: as many as fit into the duration.
    pub fn sample_times(&self) -> impl Iterator<Item = f64> + use<> {
        let (count, rate) = ((self.duration * self.sample_rate).round() as usize, self.sample_rate);
        (0..count).map(move |k| k as f64 / rate)
    }
}
