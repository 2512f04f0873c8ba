//! From a plan, or from given effects, to recordings and their truth.

use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use recording::Recording;

use crate::campaign::CasePlan;
use crate::draw::ordinary_friction;
use crate::error::FaultError;
use crate::expressed_share::{Torques, deviation, share, smooth};
use crate::fault::Leaves;
use crate::machine::{Machine, Run, TICK};
use crate::motion::{LEAD, Reference, excitation, pick_and_place, start};
use crate::robot::Robot;
use crate::sensor::Sensors;
use crate::truth::{Injected, Truth};

mod search;

/// Recordings of a machine in which physics is concealed, and the truth about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Concealment {
    /// What was concealed.
    pub truth: Truth,
    /// The URDF that the user believes.
    pub urdf: String,
    /// Excitation.
    pub train: Vec<Recording>,
    /// Pick and place.
    pub held_out: Recording,
}

/// How effects that are given are recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// What motions and noise are drawn from.
    pub seed: u64,
    /// Rows a second: a part of 1000 (Hz).
    pub rate: u32,
    /// Whether stamps jitter by a tenth of the period.
    pub jitter: bool,
    /// Whether a hundredth of the rows is lost.
    pub lost: bool,
    /// How many training recordings there are.
    pub training: usize,
    /// Whether every joint has ordinary friction on top, drawn from the seed.
    pub background_friction: bool,
}

impl Default for Settings {
    /// Three recordings at 250 Hz with a clean clock, and nothing but the effects.
    fn default() -> Self {
        Self {
            seed: 0,
            rate: 250,
            jitter: false,
            lost: false,
            training: 3,
            background_friction: false,
        }
    }
}

/// Rates that a drive of 1 kHz can be recorded at (Hz).
pub const RATES: [u32; 8] = [1000, 500, 250, 200, 125, 100, 50, 40];

/// Rows lie so many ticks apart in hard cases: mostly 100 to 500 Hz.
const HARD_TICKS: [usize; 9] = [1, 2, 2, 4, 4, 5, 5, 8, 10];

/// How many training recordings an easy and a hard case have.
pub(crate) const TRAINING: [usize; 2] = [3, 2];

/// A case under way: what is drawn first, and what does not change with the effects.
pub(crate) struct Stage<'a> {
    pub robot: &'a Robot,
    pub training: Vec<Reference>,
    pub held_out: Reference,
    /// Ordinary friction: Coulomb level and viscous coefficient of every joint, and the exponent of the latter.
    pub friction: Option<(Vec<(f64, f64)>, f64)>,
    /// Standard deviation of the torque that the training motions cost nominally (N m or N).
    pub spreads: Vec<f64>,
    pub sensors: Sensors,
}

/// Streams of randomness, so that a change in one leaves the others.
#[derive(Clone, Copy)]
enum Stream {
    Motion,
    Friction,
    Sensors,
    Noise,
    Effects,
}

/// The stream of the noise on what is recorded of a case later.
pub(crate) const AGAIN: u64 = 8;

fn random(seed: u64, stream: Stream) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(stream as u64);
    random
}

impl<'a> Stage<'a> {
    fn new(robot: &'a Robot, seed: u64, hard: bool, training: usize, background: bool) -> Self {
        let n = robot.arm().dof();
        let mut motion = random(seed, Stream::Motion);
        let training: Vec<Reference> = (0..training)
            .map(|k| excitation(robot, start(k), &mut motion))
            .collect();
        let held_out = pick_and_place(robot, start(training.len()), &mut motion);
        let spreads: Vec<f64> = (0..n).map(|j| spread(robot, &training, j)).collect();
        let mut draw = random(seed, Stream::Friction);
        let levels = ordinary_friction(&spreads, &mut draw);
        let exponent = if hard && draw.random_bool(0.3) { 0.7 } else { 1.0 };
        let mut sensors = random(seed, Stream::Sensors);
        let noises: &[f64] = if hard {
            &[1.0, 2.0, 6.0]
        } else {
            &[1.0, 1.0, 2.0, 2.0, 6.0]
        };
        let noise = 0.006 * noises.choose(&mut sensors).copied().unwrap_or(1.0);
        Self {
            robot,
            friction: background.then_some((levels, exponent)),
            sensors: Sensors {
                ticks: if hard {
                    HARD_TICKS.choose(&mut sensors).copied().unwrap_or(4)
                } else {
                    4
                },
                jitter: hard,
                lost: hard,
                quantum: [1e-5, 2e-5, 2e-5, 5e-5].choose(&mut sensors).copied().unwrap_or(2e-5),
                noise: spreads
                    .iter()
                    .map(|s| s * noise * sensors.random_range(0.92..1.08))
                    .collect(),
            },
            training,
            held_out,
            spreads,
        }
    }

    /// Ordinary friction as effects, of joints where `effects` bring no dry friction of their own.
    pub(crate) fn background(&self, effects: &[Injected]) -> Vec<Injected> {
        let Some((levels, exponent)) = &self.friction else {
            return Vec::new();
        };
        let mut background = Vec::new();
        for (joint, (coulomb, viscous)) in self.robot.arm().joints().iter().zip(levels) {
            let own = |effect: &Injected| {
                effect.joint.as_deref() == Some(&joint.name) && effect.leaves() == Leaves::DryFriction
            };
            // A drifting or loaded friction stays what it is; the plain one is in it.
            if !effects.iter().any(own) {
                background.push(Injected::new("coulomb_friction", Some(&joint.name)).with("level", *coulomb));
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

    /// Runs the machine with the background and `effects`, or with what stays of effect `without`.
    pub(crate) fn run(
        &self,
        effects: &[Injected],
        without: Option<usize>,
        reference: &Reference,
    ) -> Result<Run, FaultError> {
        let background = self.background(effects);
        let all: Vec<&Injected> = effects.iter().chain(&background).collect();
        Machine::new(self.robot, &all, without)?.run(reference, self.sensors.quantum)
    }

    /// The torques of a run below 20 Hz, and the largest part of a joint's above.
    pub(crate) fn torques(&self, run: &Run) -> (Torques, f64) {
        smooth(&run.tau, self.robot.arm().dof(), TICK, LEAD)
    }

    /// Runs of all recordings, the last one held out; the torques of those for training.
    pub(crate) fn run_all(&self, effects: &[Injected]) -> Result<(Vec<Run>, Vec<Torques>), FaultError> {
        let references = self.training.iter().chain([&self.held_out]);
        let runs: Vec<Run> = references
            .map(|reference| self.run(effects, None, reference))
            .collect::<Result<_, _>>()?;
        let training = &runs[..self.training.len()];
        let torques = training.iter().map(|run| self.torques(run).0).collect();
        Ok((runs, torques))
    }

    /// The expressed share of effect `which`: all training recordings, with and without it; `first` is the first without it, where it
    /// is known.
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

    fn finish(&self, name: &str, seed: u64, effects: Vec<Injected>, runs: &[Run]) -> Concealment {
        let mut noise = random(seed, Stream::Noise);
        let references = self.training.iter().chain([&self.held_out]);
        let mut train: Vec<Recording> = references
            .zip(runs)
            .map(|(reference, run)| self.sensors.record(self.robot, reference, run, &mut noise))
            .collect();
        let held_out = train.pop().unwrap_or_default();
        let joints = self.robot.arm().joints().iter().zip(self.robot.rotor_inertias());
        let mut concealed: Vec<Injected> = joints
            .filter(|(_, rotor)| **rotor > 0.0)
            .map(|(joint, rotor)| Injected::new("rotor_inertia", Some(&joint.name)).with("inertia", *rotor))
            .collect();
        concealed.extend(self.background(&effects));
        concealed.extend(effects);
        Concealment {
            truth: Truth {
                case: name.to_owned(),
                robot: self.robot.name().to_owned(),
                seed,
                concealed,
                background_friction: self.friction.is_some(),
                torque_noise: self.sensors.noise.clone(),
                encoder_quantum: self.sensors.quantum,
                period: self.sensors.period(),
            },
            urdf: self.robot.urdf().to_owned(),
            train,
            held_out,
        }
    }
}

/// The standard deviation of the torque of joint `j` along motions, nominally and with its drive.
fn spread(robot: &Robot, motions: &[Reference], j: usize) -> f64 {
    let (n, rotor) = (robot.arm().dof(), robot.rotor_inertias()[j]);
    let torque = |motion: &Reference| -> Vec<f64> {
        let of_joint = motion.ff.iter().zip(&motion.qdd).skip(j).step_by(n);
        of_joint.map(|(ff, qdd)| ff + rotor * qdd).collect()
    };
    deviation(&motions.iter().flat_map(torque).collect::<Vec<f64>>())
}

/// Conceals `effects`, as they are given, in recordings of `robot`.
///
/// # Errors
/// [`FaultError::Effect`] or [`FaultError::Setting`], with the remedy, if something cannot be; [`FaultError::Lost`] if the position
/// loop cannot hold the machine.
pub fn conceal_effects(
    robot: &Robot,
    name: &str,
    effects: &[Injected],
    settings: &Settings,
) -> Result<Concealment, FaultError> {
    if !RATES.contains(&settings.rate) {
        let known: Vec<String> = RATES.iter().map(ToString::to_string).collect();
        let (rate, known) = (settings.rate, known.join(", "));
        return Err(FaultError::Setting(format!(
            "the rate is {rate} Hz; give one of {known} Hz"
        )));
    }
    if settings.training == 0 {
        return Err(FaultError::Setting(
            "there is no training recording; ask for one at least".into(),
        ));
    }
    let Settings { seed, training, .. } = *settings;
    let mut stage = Stage::new(robot, seed, false, training, settings.background_friction);
    stage.sensors.ticks = (1000 / settings.rate) as usize;
    stage.sensors.jitter = settings.jitter;
    stage.sensors.lost = settings.lost;
    let mut effects = effects.to_vec();
    let last = stage.held_out.time(stage.held_out.ticks());
    for (k, effect) in effects.iter().enumerate() {
        let fail = |reason: String| {
            let effect = effect.effect.clone();
            Err(FaultError::Effect { effect, reason })
        };
        effect.check(&robot.driven())?;
        if let Some(onset) = effect.onset.filter(|onset| !(0.0..last).contains(onset)) {
            return fail(format!(
                "its onset is {onset} s; the recordings are from 0 to {last:.0} s: give a time in them, or none"
            ));
        }
        if effects[..k].iter().any(|other| other.is_again(effect)) {
            return fail("is given twice on one joint; one is one effect".into());
        }
    }
    let (runs, torques) = stage.run_all(&effects)?;
    for which in 0..effects.len() {
        effects[which].expressed_share = Some(stage.share(&effects, which, &torques, None)?);
    }
    Ok(stage.finish(name, seed, effects, &runs))
}

/// Draws what `plan` says, until it shows and the machine runs soundly, and records it.
///
/// # Errors
/// [`FaultError::NotExpressed`] if no draw comes out; [`FaultError::Plant`] if the robot cannot be simulated.
pub fn conceal_case(robot: &Robot, plan: &CasePlan) -> Result<Concealment, FaultError> {
    let training = TRAINING[usize::from(plan.hard)];
    let stage = Stage::new(robot, plan.seed, plan.hard, training, plan.background_friction);
    if plan.effects.is_empty() {
        let (runs, _) = stage.run_all(&[])?;
        return Ok(stage.finish(&plan.name, plan.seed, Vec::new(), &runs));
    }
    let mut draw = random(plan.seed, Stream::Effects);
    let (effects, runs) = search::search(&stage, plan, &mut draw)?;
    Ok(stage.finish(&plan.name, plan.seed, effects, &runs))
}

#[cfg(test)]
mod tests;
