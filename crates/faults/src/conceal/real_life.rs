//! Properties of real recordings in addition to the injected faults: small effects on every joint, and friction that differs
//! between recordings.

use std::f64::consts::TAU;

use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::streams::{Stream, random};
use crate::motion::Reference;
use crate::robot::Robot;
use crate::site::{log_uniform, sign};
use crate::truth::{Injected, Lifelike};

/// The largest deviation of a recording's friction from the mean, relative.
const FRICTION_SPREAD: f64 = 0.1;
/// Relative standard deviations of the torque constants of one robot.
const CONSTANTS: (f64, f64) = (0.03, 0.10);
/// The sizes of the small effects of every joint, relative to its torque; together with their level, they remain below
/// the required share.
const SMALL_SHARES: (f64, f64) = (0.002, 0.010);
/// The natural frequency of a link on its elastic gearbox while the drive is held (Hz): from within the bandwidth to
/// beyond it.
const GEARBOX: (f64, f64) = (10.0, 80.0);

/// The properties of a case that resembles a real robot.
#[derive(Default)]
pub(crate) struct RealLife {
    /// Small effects of every joint.
    pub small: Vec<Injected>,
    /// Elastic gearboxes.
    pub gearboxes: Vec<Injected>,
    /// Factor of all friction, `[recording][joint]`.
    pub friction: Vec<Vec<f64>>,
    /// Time constant of the noise on torques (s); 0: white.
    pub noise_time: f64,
    /// The steps in which torques are reported (N m or N).
    pub torque_quantum: Vec<f64>,
    /// Whether each file has its own clock; only if no fault depends on the time.
    pub own_clocks: bool,
}

impl RealLife {
    /// Draws them for a robot that moves along `training`, with torques of the standard deviations `spreads` (N m or
    /// N).
    pub(super) fn draw(robot: &Robot, training: &[Reference], spreads: &[f64], seed: u64) -> Self {
        let random = &mut random(seed, Stream::RealLife);
        let names: Vec<&str> = robot.arm().joints().iter().map(|joint| joint.name.as_str()).collect();
        let constants = log_uniform(CONSTANTS.0, CONSTANTS.1, random);
        let mut small = Vec::new();
        for (j, name) in names.iter().enumerate() {
            let load = load(training, names.len(), j).max(spreads[j]);
            small.extend(small_effects(name, spreads[j], load, random));
            let normal: f64 = StandardNormal.sample(random);
            let factor = 1.0 + constants * normal.clamp(-3.0, 3.0);
            small.push(Injected::new("torque_scale", Some(name)).with("factor", factor).minor());
        }
        let mut joints: Vec<usize> = (0..names.len()).collect();
        joints.shuffle(random);
        joints.truncate(if random.random_bool(0.5) { random.random_range(1..3) } else { 0 });
        let gearboxes = joints.into_iter().map(|j| gearbox(robot, j, random)).collect();
        let mut days =
            || (0..names.len()).map(|_| random.random_range(1.0 - FRICTION_SPREAD..1.0 + FRICTION_SPREAD)).collect();
        let friction = (0..=training.len()).map(|_| days()).collect();
        Self {
            small,
            gearboxes,
            friction,
            noise_time: if random.random_bool(0.5) { log_uniform(0.002, 0.03, random) } else { 0.0 },
            torque_quantum: match random.random_bool(0.5) {
                true => spreads.iter().map(|spread| spread * log_uniform(0.001, 0.02, random)).collect(),
                false => Vec::new(),
            },
            own_clocks: random.random_bool(1.0 / 3.0),
        }
    }

    /// The small effects of all joints, except where one of `effects` is the same on that joint.
    pub(super) fn beside<'a>(&'a self, effects: &'a [Injected]) -> impl Iterator<Item = Injected> + 'a {
        let all = self.small.iter().chain(&self.gearboxes);
        all.filter(|small| !effects.iter().any(|effect| replaces(effect, small))).cloned()
    }

    /// The properties as an entry of the ground truth.
    pub(super) fn entry(&self, own_clocks: bool) -> Lifelike {
        Lifelike {
            friction: self.friction.clone(),
            noise_time: self.noise_time,
            torque_quantum: self.torque_quantum.clone(),
            own_clocks,
        }
    }
}

/// Whether a joint with `effect` has no `small` effect, because both are the same effect or parts of one drive train.
fn replaces(effect: &Injected, small: &Injected) -> bool {
    let is_drive_train =
        |of: &Injected| matches!(of.effect.as_str(), "joint_elasticity" | "backlash" | "rotor_inertia");
    effect.joint == small.joint && (effect.effect == small.effect || is_drive_train(effect) && is_drive_train(small))
}

/// The root mean square of the nominal torque of joint `j` of `dof` along `training` (N m or N).
fn load(training: &[Reference], dof: usize, j: usize) -> f64 {
    let torques = || training.iter().flat_map(|motion| motion.ff.iter().skip(j).step_by(dof));
    let count = torques().count().max(1) as f64;
    (torques().map(|tau| tau * tau).sum::<f64>() / count).sqrt()
}

/// The small effects of a joint.
fn small_effects(joint: &str, spread: f64, load: f64, random: &mut ChaCha8Rng) -> [Injected; 4] {
    let mut size = || log_uniform(SMALL_SHARES.0, SMALL_SHARES.1, random);
    let [fading, half, gain, ripple] =
        [size() * spread, 0.7 * size() * spread, size() * spread / load.max(1e-12), size() * spread];
    let on = |name: &str| Injected::new(name, Some(joint)).minor();
    let (positive, negative) = if sign(random) > 0.0 { (2.0 * half, 0.0) } else { (0.0, 2.0 * half) };
    [
        on("stribeck_friction")
            .with("coulomb", 0.0)
            .with("breakaway", fading)
            .with("velocity", random.random_range(0.05..0.3)),
        on("friction_asymmetry").with("positive", positive).with("negative", negative),
        on("load_dependent_friction").with("coulomb", 0.0).with("gain", gain),
        on("torque_ripple")
            .with("amplitude", ripple)
            .with("periods", f64::from(random.random_range(14_u8..61)))
            .with("phase", random.random_range(0.0..TAU)),
    ]
}

/// An elastic gearbox between the rotor of a joint's drive and its link.
fn gearbox(robot: &Robot, j: usize, random: &mut ChaCha8Rng) -> Injected {
    let (link, own) = (robot.link_inertia(j), robot.rotor(j));
    let drawn = link * random.random_range(0.3..1.0);
    let rotor = if own > 0.0 { own } else { drawn };
    let frequency = TAU * log_uniform(GEARBOX.0, GEARBOX.1, random);
    let stiffness = link * frequency * frequency;
    Injected::new("joint_elasticity", Some(&robot.arm().joints()[j].name))
        .with("stiffness", stiffness)
        .with("damping", 0.1 * (stiffness * link.min(rotor)).sqrt())
        .with("rotor", rotor)
        .minor()
}
