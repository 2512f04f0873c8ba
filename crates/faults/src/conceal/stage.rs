//! A case in preparation: motions, baseline friction and sensors, which are drawn before the effects.

use arm::{Inertia, Matrix3, Vector3};
use rand::Rng;
use rand::seq::IndexedRandom;
use recording::Recording;

use super::Concealment;
use super::real_life::RealLife;
use super::streams::{Stream, random};
use crate::draw::baseline_friction;
use crate::error::FaultError;
use crate::expressed_share::{Torques, deviation, low_passed, share};
use crate::fault::Leaves;
use crate::machine::{Machine, Run};
use crate::motion::{DURATION, LEAD_TICKS, PAUSE, Reference, TICK, excitation, pick_and_place, start};
use crate::robot::Robot;
use crate::sensor::Sensors;
use crate::site::log_uniform;
use crate::truth::{Injected, Truth};
use crate::urdf_error::{with_inertial_errors, with_tool};

/// The number of ticks between rows in hard cases: mostly 100 to 500 Hz.
const HARD_TICKS: [usize; 9] = [1, 2, 2, 4, 4, 5, 5, 8, 10];

/// Standard deviations of the torque noise, relative to the torque.
const NOISE: (f64, f64) = (0.003, 0.036);
/// The duration of the run that tests whether the loop can hold the gearboxes (s).
const TRIAL: f64 = 8.0;
/// The largest increase of the torque above 20 Hz due to the gearboxes.
const MOST_ADDED_ABOVE: f64 = 0.05;

/// The number of training recordings of an easy and of a hard case.
pub(crate) const TRAINING: [usize; 2] = [3, 2];

/// A case in preparation: everything that does not depend on the effects.
pub(crate) struct Stage<'a> {
    pub robot: &'a Robot,
    pub training: Vec<Reference>,
    pub held_out: Reference,
    /// Baseline friction: Coulomb level and viscous coefficient of every joint, and the exponent of the viscous law.
    pub friction: Option<(Vec<(f64, f64)>, f64)>,
    /// Standard deviation of the torque that the training motions require nominally (N m or N).
    pub spreads: Vec<f64>,
    /// The standard deviation of the torque of the URDF's bodies, without drives (N m or N).
    pub loads: Vec<f64>,
    pub sensors: Sensors,
    /// The properties of a real robot; none in a plain case.
    pub real: Option<RealLife>,
    seed: u64,
    urdf_error: f64,
}

/// The settings of a case except its effects.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kind {
    pub seed: u64,
    pub hard: bool,
    /// The number of training recordings.
    pub training: usize,
    /// Whether every joint has baseline friction.
    pub friction: bool,
    /// Whether it resembles a real robot.
    pub lifelike: bool,
    /// The relative error of the URDF.
    pub urdf_error: f64,
}

impl<'a> Stage<'a> {
    /// # Errors
    /// [`FaultError::Plant`] if the robot cannot be simulated.
    pub(super) fn new(robot: &'a Robot, kind: Kind) -> Result<Self, FaultError> {
        let Kind { seed, hard, .. } = kind;
        let n = robot.arm().dof();
        let mut motion = random(seed, Stream::Motion);
        let training: Vec<Reference> = (0..kind.training).map(|k| excitation(robot, start(k), &mut motion)).collect();
        let held_out = pick_and_place(robot, start(training.len()), &mut motion);
        let spreads: Vec<f64> = (0..n).map(|j| spread(robot, &training, j, true)).collect();
        let loads = (0..n).map(|j| spread(robot, &training, j, false)).collect();
        let mut draw = random(seed, Stream::Friction);
        let levels = baseline_friction(&spreads, &mut draw);
        let exponent = if hard && draw.random_bool(0.3) { 0.7 } else { 1.0 };
        let mut sensors = random(seed, Stream::Sensors);
        let noise = log_uniform(NOISE.0, NOISE.1, &mut sensors);
        let real = kind.lifelike.then(|| RealLife::draw(robot, &training, &spreads, seed));
        let mut stage = Self {
            robot,
            friction: kind.friction.then_some((levels, exponent)),
            sensors: Sensors {
                ticks: if hard { HARD_TICKS.choose(&mut sensors).copied().unwrap_or(4) } else { 4 },
                jitter: hard,
                lost: hard,
                quantum: [1e-5, 2e-5, 2e-5, 5e-5].choose(&mut sensors).copied().unwrap_or(2e-5),
                noise: spreads.iter().map(|s| s * noise * sensors.random_range(0.92..1.08)).collect(),
                noise_time: real.as_ref().map_or(0.0, |real| real.noise_time),
                torque_quantum: real.as_ref().map_or_else(Vec::new, |real| real.torque_quantum.clone()),
                own_clocks: real.as_ref().is_some_and(|real| real.own_clocks),
            },
            training,
            held_out,
            spreads,
            loads,
            real,
            seed,
            urdf_error: kind.urdf_error,
        };
        stage.remove_unstable_gearboxes()?;
        Ok(stage)
    }

    /// Gearboxes with which the position loop is unstable are removed.
    fn remove_unstable_gearboxes(&mut self) -> Result<(), FaultError> {
        let Some(real) = self.real.as_mut().filter(|real| !real.gearboxes.is_empty()) else {
            return Ok(());
        };
        let gearboxes = std::mem::take(&mut real.gearboxes);
        let trial = self.training[0].clone().first_seconds(TRIAL);
        let (_, rigid) = self.torques(&self.run(&[], None, &trial)?);
        self.set_gearboxes(gearboxes);
        let holds = match self.run(&[], None, &trial) {
            Ok(run) => self.torques(&run).1 < rigid + MOST_ADDED_ABOVE,
            Err(FaultError::Lost { .. } | FaultError::Plant(_)) => false,
            Err(error) => return Err(error),
        };
        if !holds {
            self.set_gearboxes(Vec::new());
        }
        Ok(())
    }

    fn set_gearboxes(&mut self, gearboxes: Vec<Injected>) {
        if let Some(real) = &mut self.real {
            real.gearboxes = gearboxes;
        }
    }

    /// Baseline friction as effects, on joints where `effects` have no such friction of their own; and the small
    /// effects of real joints.
    pub(crate) fn background(&self, effects: &[Injected]) -> Vec<Injected> {
        let mut background = self.baseline(effects);
        background.extend(self.real.iter().flat_map(|real| real.beside(effects)));
        background
    }

    fn baseline(&self, effects: &[Injected]) -> Vec<Injected> {
        let Some((levels, exponent)) = &self.friction else {
            return Vec::new();
        };
        let mut background = Vec::new();
        for (joint, (coulomb, viscous)) in self.robot.arm().joints().iter().zip(levels) {
            let own = |effect: &Injected| {
                effect.joint.as_deref() == Some(&joint.name) && effect.leaves() == Leaves::DryFriction
            };
            let has = |name: &str| effects.iter().any(|e| e.effect == name && e.joint.as_deref() == Some(&joint.name));
            // A friction curve, drift or load dependence includes the plain friction.
            if !effects.iter().any(own) && !has("coulomb_friction") {
                background.push(Injected::new("coulomb_friction", Some(&joint.name)).with("level", *coulomb));
            }
            if has("viscous_friction") {
                continue;
            }
            let viscous = Injected::new("viscous_friction", Some(&joint.name)).with("coefficient", *viscous);
            background.push(if *exponent == 1.0 {
                viscous
            } else {
                viscous.with("exponent", *exponent).formed("power")
            });
        }
        background
    }

    /// Runs the machine with the background and `effects`; of the effect with index `without`, only the part that
    /// remains.
    pub(crate) fn run(
        &self,
        effects: &[Injected],
        without: Option<usize>,
        reference: &Reference,
    ) -> Result<Run, FaultError> {
        let mut background = self.background(effects);
        let number = (reference.start / (DURATION + PAUSE)).round() as usize;
        let factors = self.real.as_ref().and_then(|real| real.friction.get(number));
        if let Some(factors) = factors {
            for (joint, factor) in self.robot.arm().joints().iter().zip(factors) {
                let viscous = background.iter_mut().filter(|effect| {
                    effect.effect == "viscous_friction" && effect.joint.as_deref() == Some(&joint.name)
                });
                for viscous in viscous {
                    let coefficient = viscous.number("coefficient").unwrap_or(0.0);
                    *viscous = viscous.clone().with("coefficient", factor * coefficient);
                }
            }
        }
        let all: Vec<&Injected> = effects.iter().chain(&background).collect();
        let machine = Machine::new(self.robot, &all, without)?;
        let machine = match factors {
            Some(factors) => machine.with_friction(factors),
            None => machine,
        };
        machine.run(reference, self.sensors.quantum)
    }

    /// The torques of a run below 20 Hz, and the largest share of a joint's torque above.
    pub(crate) fn torques(&self, run: &Run) -> (Torques, f64) {
        low_passed(&run.tau, self.robot.arm().dof(), TICK, LEAD_TICKS)
    }

    /// Runs of all recordings, the last one held out; and the torques of the training recordings.
    pub(crate) fn run_all(&self, effects: &[Injected]) -> Result<(Vec<Run>, Vec<Torques>), FaultError> {
        let references = self.training.iter().chain([&self.held_out]);
        let runs: Vec<Run> =
            references.map(|reference| self.run(effects, None, reference)).collect::<Result<_, _>>()?;
        let training = &runs[..self.training.len()];
        let torques = training.iter().map(|run| self.torques(run).0).collect();
        Ok((runs, torques))
    }

    /// The expressed share of the effect with index `which`: all training recordings, with and without it. `first` is
    /// the first one without it, if it is known.
    pub(crate) fn share(
        &self,
        effects: &[Injected],
        which: usize,
        with: &[Torques],
        first: Option<&Torques>,
    ) -> Result<f64, FaultError> {
        let mut without: Vec<Torques> = first.into_iter().cloned().collect();
        for reference in &self.training[without.len()..] {
            without.push(self.torques(&self.run(effects, Some(which), reference)?).0);
        }
        let is_constant = effects[which].fault().is_some_and(|fault| fault.is_constant);
        Ok(share(with, &without, is_constant))
    }

    /// The case: the recordings of `runs`, and the ground truth.
    ///
    /// # Errors
    /// [`FaultError::Setting`] if the URDF cannot be given the requested error.
    pub(super) fn finish(&self, name: &str, effects: Vec<Injected>, runs: &[Run]) -> Result<Concealment, FaultError> {
        let seed = self.seed;
        let mut noise = random(seed, Stream::Noise);
        let sensors = Sensors {
            own_clocks: self.sensors.own_clocks && !effects.iter().any(depends_on_time),
            ..self.sensors.clone()
        };
        let mut urdf = with_inertial_errors(self.robot.urdf(), self.urdf_error, &mut random(seed, Stream::Urdf))?;
        for tool in effects.iter().filter(|effect| effect.is_not_mounted()) {
            urdf = with_tool(&urdf, &self.robot.arm().tool_frame().name, &body_of(tool))?;
        }
        let references = self.training.iter().chain([&self.held_out]);
        let mut train: Vec<Recording> = references
            .zip(runs)
            .map(|(reference, run)| sensors.record(self.robot, reference, run, &mut noise))
            .collect();
        let held_out = train.pop().unwrap_or_default();
        let joints = self.robot.arm().joints().iter().zip(self.robot.rotor_inertias());
        let mut injected: Vec<Injected> = joints
            .filter(|(_, rotor)| **rotor > 0.0)
            .map(|(joint, rotor)| Injected::new("rotor_inertia", Some(&joint.name)).with("inertia", *rotor))
            .collect();
        injected.extend(self.background(&effects));
        injected.extend(effects);
        Ok(Concealment {
            truth: Truth {
                case: name.to_owned(),
                robot: self.robot.name().to_owned(),
                seed,
                injected,
                background_friction: self.friction.is_some(),
                torque_noise: self.sensors.noise.clone(),
                encoder_quantum: self.sensors.quantum,
                period: self.sensors.period(),
                urdf_sigma: Some(self.urdf_error),
                lifelike: self.real.as_ref().map(|real| real.entry(sensors.own_clocks)),
            },
            urdf,
            train,
            held_out,
        })
    }
}

/// Whether an effect depends on the time, which is not known with separate clocks of the files.
fn depends_on_time(effect: &Injected) -> bool {
    effect.onset.is_some() || effect.effect == "thermal_drift" || effect.number("start").is_some()
}

/// The body that is drawn in the URDF for a tool that is not mounted.
fn body_of(tool: &Injected) -> Inertia {
    let list = |name: &str| -> Vec<f64> {
        let values = tool.parameters.get(name).and_then(serde_json::Value::as_array);
        values.map_or_else(Vec::new, |values| values.iter().filter_map(serde_json::Value::as_f64).collect())
    };
    let at = |list: &[f64], k: usize| list.get(k).copied().unwrap_or(0.0);
    let (com, moments) = (list("com"), list("inertia"));
    let [xx, xy, yy, xz, yz, zz] = std::array::from_fn(|k| -at(&moments, k));
    Inertia {
        mass: -tool.number("mass").unwrap_or(0.0),
        com: Vector3::new(at(&com, 0), at(&com, 1), at(&com, 2)),
        tensor: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    }
}

/// The nominal standard deviation of the torque of joint `j` along motions, with or without its drive.
fn spread(robot: &Robot, motions: &[Reference], j: usize, with_drive: bool) -> f64 {
    let (n, rotor) = (robot.arm().dof(), if with_drive { robot.rotor_inertias()[j] } else { 0.0 });
    let torque = |motion: &Reference| -> Vec<f64> {
        let of_joint = motion.ff.iter().zip(&motion.qdd).skip(j).step_by(n);
        of_joint.map(|(ff, qdd)| ff + rotor * qdd).collect()
    };
    deviation(&motions.iter().flat_map(torque).collect::<Vec<f64>>())
}
