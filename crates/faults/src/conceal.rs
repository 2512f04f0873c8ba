//! From a plan, or from given effects, to recordings and their ground truth.

use recording::Recording;

use crate::campaign::CasePlan;
use crate::error::FaultError;
use crate::motion::{LEAD_TICKS, Reference};
use crate::robot::Robot;
use crate::truth::{Injected, Truth};

mod real_life;
mod search;
mod stage;
mod streams;

pub(crate) use stage::TRAINING;
use stage::{Kind, Stage};
pub(crate) use streams::RECORD_AGAIN;
use streams::{Stream, random};

/// Recordings of a machine with injected faults, and the ground truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Concealment {
    /// The ground truth.
    pub truth: Truth,
    /// The URDF that the user has.
    pub urdf: String,
    /// Excitation.
    pub train: Vec<Recording>,
    /// Pick and place.
    pub held_out: Recording,
}

/// Settings of the recordings of given effects.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The seed of motions and noise.
    pub seed: u64,
    /// The rate of the rows (Hz), a divisor of 1000.
    pub rate: u32,
    /// Whether stamps jitter by a tenth of the period.
    pub jitter: bool,
    /// Whether a hundredth of the rows is lost.
    pub lost: bool,
    /// The number of training recordings.
    pub training: usize,
    /// Whether baseline friction on every joint is added, drawn from the seed.
    pub background_friction: bool,
    /// Whether the case resembles a real robot ([`CasePlan::lifelike`]).
    pub lifelike: bool,
    /// The relative error of all inertial parameters of the URDF.
    pub urdf_error: f64,
}

impl Default for Settings {
    /// Three recordings at 250 Hz with a clean clock, and only the given effects.
    fn default() -> Self {
        Self {
            seed: 0,
            rate: 250,
            jitter: false,
            lost: false,
            training: 3,
            background_friction: false,
            lifelike: false,
            urdf_error: 0.0,
        }
    }
}

/// Rates that a drive of 1 kHz can be recorded at (Hz).
pub const RATES: [u32; 8] = [1000, 500, 250, 200, 125, 100, 50, 40];

/// Injects given `effects` in recordings of `robot`.
///
/// # Errors
/// [`FaultError::Effect`] or [`FaultError::Setting`], with the remedy, if an effect or a setting is impossible;
/// [`FaultError::Lost`] if the position loop cannot hold the machine.
pub fn conceal_effects(
    robot: &Robot,
    name: &str,
    effects: &[Injected],
    settings: &Settings,
) -> Result<Concealment, FaultError> {
    if !RATES.contains(&settings.rate) {
        let known: Vec<String> = RATES.iter().map(ToString::to_string).collect();
        let (rate, known) = (settings.rate, known.join(", "));
        return Err(FaultError::Setting(format!("the rate is {rate} Hz; give one of {known} Hz")));
    }
    if settings.training == 0 {
        return Err(FaultError::Setting("there is no training recording; ask for one at least".into()));
    }
    let kind = Kind {
        seed: settings.seed,
        hard: false,
        training: settings.training,
        friction: settings.background_friction,
        lifelike: settings.lifelike,
        urdf_error: settings.urdf_error,
    };
    let mut stage = Stage::new(robot, kind)?;
    stage.sensors.ticks = (1000 / settings.rate) as usize;
    stage.sensors.jitter = settings.jitter;
    stage.sensors.lost = settings.lost;
    let joint_of = |name: &str| robot.arm().joints().iter().position(|joint| joint.name == name);
    let mut effects: Vec<Injected> = effects.iter().map(|effect| effect.listed_for_outer_joint(joint_of)).collect();
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
        let is_its_rotor = |other: &Injected| other.effect == "rotor_inertia" && other.joint == effect.joint;
        if effect.parameters.contains_key("rotor") && effects.iter().any(is_its_rotor) {
            return fail(
                "its rotor and the rotor_inertia on its joint are one inertia; leave one of the two out".into(),
            );
        }
        if let ("external_contact", Some(from)) = (effect.effect.as_str(), effect.number("start")) {
            let to = from + effect.number("duration").unwrap_or(0.0);
            let recordings = || stage.training.iter().chain([&stage.held_out]);
            let span = |run: &Reference| [run.time(LEAD_TICKS), run.time(run.ticks())];
            if !recordings().map(span).any(|[first, last]| first <= from && to <= last) {
                let spans = recordings().map(span).map(|[first, last]| format!("{first:.0} to {last:.0} s"));
                let spans = spans.collect::<Vec<_>>().join(", ");
                return fail(format!("it lasts from {from} to {to} s; let it be within one recording ({spans})"));
            }
        }
        if effects[..k].iter().any(|other| other.is_same_effect(effect)) {
            return fail("is given twice on one joint; one is one effect".into());
        }
    }
    let (runs, torques) = stage.run_all(&effects)?;
    for which in 0..effects.len() {
        effects[which].expressed_share = Some(stage.share(&effects, which, &torques, None)?);
    }
    stage.finish(name, effects, &runs)
}

/// Draws the faults of `plan` until they are detectable and the position loop is stable, and records the machine.
///
/// # Errors
/// [`FaultError::NotExpressed`] if no draw is accepted; [`FaultError::Plant`] if the robot cannot be simulated.
pub fn conceal_case(robot: &Robot, plan: &CasePlan) -> Result<Concealment, FaultError> {
    let kind = Kind {
        seed: plan.seed,
        hard: plan.hard,
        training: TRAINING[usize::from(plan.hard)],
        friction: plan.background_friction,
        lifelike: plan.lifelike,
        urdf_error: plan.urdf_error,
    };
    let stage = Stage::new(robot, kind)?;
    if plan.effects.is_empty() {
        let (runs, _) = stage.run_all(&[])?;
        return stage.finish(&plan.name, Vec::new(), &runs);
    }
    let mut draw = random(plan.seed, Stream::Effects);
    let (effects, runs) = search::search(&stage, plan, &mut draw)?;
    stage.finish(&plan.name, effects, &runs)
}

#[cfg(test)]
mod tests;
