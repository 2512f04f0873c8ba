//! Samples for training and testing torque models, from a scenario's reference or from a recording.

use std::path::Path;

use anyhow::{Context, anyhow, bail, ensure};
use arm::Arm;
use recording::{Recording, RecordingError};
use torque::{Motion, Reference, Samples};

use crate::cli::ChainArgs;
use crate::scenario::Scenario;
use crate::scenario::recorded::columns;
use crate::sensors::Sensors;
use study::named;

/// The stream of the sensors' noise in the training samples, which is independent of that in the loop.
const TRAINING_STREAM: u64 = 2;

/// The torque (N m or N) that the plant of `scenario` needs for a motion: rigid-body dynamics, drives and friction.
pub struct TrueTorque<'a> {
    arm: &'a Arm,
    viscous: &'a [f64],
    coulomb: &'a [f64],
    workspace: arm::Workspace,
}

impl<'a> TrueTorque<'a> {
    /// The true torques of `scenario`'s plant.
    pub fn new(scenario: &'a Scenario) -> Self {
        Self {
            arm: &scenario.arm,
            viscous: &scenario.viscous_friction,
            coulomb: &scenario.coulomb_friction,
            workspace: arm::Workspace::new(&scenario.arm),
        }
    }

    /// The torques for `motion`, into `tau`. At standstill, Coulomb friction counts as zero.
    pub fn of(&mut self, motion: &Motion, tau: &mut [f64]) {
        self.arm.inverse_dynamics(&mut self.workspace, &motion.q, &motion.qd, &motion.qdd, tau);
        for (joint, tau) in tau.iter_mut().enumerate() {
            let speed = motion.qd[joint];
            let direction = if speed == 0.0 { 0.0 } else { speed.signum() };
            *tau += self.viscous[joint] * speed + self.coulomb[joint] * direction;
        }
    }
}

/// Samples of `reference` at `times` (s), with the torques that `plant`'s plant needs for it, as
/// `sensors` report them: the paper's data.
///
/// # Errors
/// If the reference is for another arm.
pub fn reference_samples(
    plant: &Scenario,
    reference: &Reference,
    times: impl Iterator<Item = f64>,
    mut sensors: Option<&mut Sensors<'_>>,
    samples: &mut Samples,
) -> anyhow::Result<()> {
    let dof = plant.arm.dof();
    let mut motion = Motion::new(reference.centre.len());
    let mut tau = vec![0.0; dof];
    let mut measured = vec![0.0; dof];
    let mut torque = TrueTorque::new(plant);
    ensure!(
        reference.centre.len() == dof,
        "the reference is for {} joints, the robot \"{}\" has {dof}",
        reference.centre.len(),
        plant.arm.name()
    );
    for time in times {
        reference.at(time, &mut motion);
        torque.of(&motion, &mut tau);
        match &mut sensors {
            Some(sensors) => sensors.torque(&tau, &mut measured),
            None => measured.copy_from_slice(&tau),
        }
        samples.push(torque::Sample { q: &motion.q, qd: &motion.qd, qdd: &motion.qdd, tau: &measured })?;
    }
    Ok(())
}

/// The samples of the reference of `scenario` itself.
///
/// # Errors
/// If its reference does not fit its arm.
pub fn own_samples(scenario: &Scenario) -> anyhow::Result<Samples> {
    let mut samples = Samples::new(scenario.arm.dof());
    reference_samples(scenario, &scenario.reference, scenario.sample_times(), None, &mut samples)?;
    Ok(samples)
}

/// The samples of all `sources`: scenarios by name or file, whose references are sampled on the plant of `scenario` with
/// the joints that `chain` selects, and recordings (files that are not `.toml`) with accelerations, thinned to the
/// scenario's sample rate.
///
/// # Errors
/// If a source cannot be read or is of another robot.
pub fn training_samples(
    scenario: &Scenario,
    sources: &[String],
    chain: &ChainArgs,
    seed: u64,
) -> anyhow::Result<Samples> {
    let mut samples = Samples::new(scenario.arm.dof());
    let mut sensors = Sensors::new(&scenario.sensor_noise, seed, TRAINING_STREAM);
    for source in sources {
        let of_source = || format!("training on {source}");
        if is_recording(source) {
            let recording = read_recording(Path::new(source), &scenario.arm).context("training")?;
            recording_samples(scenario, &recording, &mut samples).with_context(of_source)?;
        } else {
            let task = Scenario::load_chain(source, chain).context("training")?;
            reference_samples(scenario, &task.reference, task.sample_times(), Some(&mut sensors), &mut samples)
                .with_context(of_source)?;
        }
    }
    Ok(samples)
}

/// Whether the training data `source` are a recording, and not a scenario.
pub fn is_recording(source: &str) -> bool {
    let path = Path::new(source);
    let ends = |end: &str| path.extension().is_some_and(|extension| extension == end);
    ends("csv") || (path.exists() && !ends("toml"))
}

/// Settings of the scenarios among `sources` that differ from those of `scenario` and have no effect, a sentence for each scenario: its
/// reference is sampled on the plant of `scenario`.
///
/// # Errors
/// If a scenario cannot be read.
pub fn unused_settings(scenario: &Scenario, sources: &[String], chain: &ChainArgs) -> anyhow::Result<Vec<String>> {
    let mut notes = Vec::new();
    for source in sources.iter().filter(|source| !is_recording(source)) {
        let task = Scenario::load_chain(source, chain)?;
        let own = |own: &[f64], used: &[f64]| own != used && own.iter().any(|value| *value != 0.0);
        let (noise, used) = (&task.sensor_noise, &scenario.sensor_noise);
        let differ = [
            ("robot or plant.rotor_inertia", task.arm.joints() != scenario.arm.joints()),
            ("plant.viscous_friction", own(&task.viscous_friction, &scenario.viscous_friction)),
            ("plant.coulomb_friction", own(&task.coulomb_friction, &scenario.coulomb_friction)),
            ("sensors.position_noise", own(&noise.position, &used.position)),
            ("sensors.velocity_noise", own(&noise.velocity, &used.velocity)),
            ("sensors.torque_noise", own(&noise.torque, &used.torque)),
            ("model.inertia_scale", task.inertia_scale != 1.0 && task.inertia_scale != scenario.inertia_scale),
        ];
        let differ: Vec<&str> = differ.iter().filter(|(_, differs)| *differs).map(|(key, _)| *key).collect();
        if !differ.is_empty() {
            notes.push(format!(
                "{source}: only its reference is used; plant, sensors and model are those of {}, which differ in {}",
                scenario.name,
                report::words::list(&differ)
            ));
        }
    }
    Ok(notes)
}

/// Reads a recording to train on. There is no column map here, so that none is proposed for another header.
fn read_recording(path: &Path, arm: &Arm) -> anyhow::Result<Recording> {
    named::read(path, None, Some(arm)).map_err(|error| match error {
        RecordingError::Header { path, has_lines, .. } => anyhow!(
            "{}{}: its columns are not those of a recording to train on: t (s), and for every joint q_<joint>, qd_<joint>, \
             qdd_<joint> (rad, rad/s, rad/s²) and tau_<joint> (N m); name them so (`testbed inspect FILE` says what is missing)",
            path.display(),
            if has_lines { ":1" } else { "" }
        ),
        other => other.into(),
    })
}

fn recording_samples(scenario: &Scenario, recording: &Recording, samples: &mut Samples) -> anyhow::Result<()> {
    let order = columns(recording, &scenario.arm)?;
    let (Some(qd), Some(qdd)) = (&recording.qd, &recording.qdd) else {
        let lacks = match (&recording.qd, &recording.qdd) {
            (None, None) => "qd_<joint> (rad/s) and qdd_<joint> (rad/s²)",
            (None, Some(_)) => "qd_<joint> (rad/s)",
            _ => "qdd_<joint> (rad/s²)",
        };
        bail!(
            "it lacks the columns {lacks}, which training needs; a run's recording.csv has them, and for a robot's recording they qd_ are \
             the central differences of the positions after a low-pass filter without phase shift, qdd_ those of qd_; filter the torques alike"
        );
    };
    let mut next = f64::NEG_INFINITY;
    for (k, &time) in recording.time.iter().enumerate() {
        // A tolerance of half a microsecond for the rounding of stamps.
        if time < next - 5e-7 {
            continue;
        }
        // The next sample is due one period after the last due time, or one period after this sample if there was a gap.
        let period = 1.0 / scenario.sample_rate;
        next = if time < next + period { next + period } else { time + period };
        let pick = |signal: &recording::Signal| order.iter().map(|&joint| signal[joint][k]).collect::<Vec<f64>>();
        samples.push(torque::Sample {
            q: &pick(&recording.q),
            qd: &pick(qd),
            qdd: &pick(qdd),
            tau: &pick(&recording.tau),
        })?;
    }
    Ok(())
}
