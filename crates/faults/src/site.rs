//! A joint for which a fault is drawn, and the data from which its size is drawn.

use std::f64::consts::TAU;
use std::ops::Range;

use rand::Rng;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

use crate::robot::Robot;
use crate::truth::Injected;

/// The relative standard deviation of a drive's torque constant that nobody has measured.
const TORQUE_CONSTANT: f64 = 0.05;
/// The smallest drawn factor, in standard deviations of torque constants and of the URDF's errors combined, so that it
/// can be distinguished from these.
const LEAST_DEVIATIONS: f64 = 2.0;

/// The data from which sizes are drawn.
pub(crate) struct Scales<'a> {
    pub robot: &'a Robot,
    pub hard: bool,
    /// Whether the case resembles a real robot.
    pub lifelike: bool,
    /// Standard deviation of each joint's torque (N m or N), without faults.
    pub spreads: &'a [f64],
    /// The standard deviation of the torque of the URDF's bodies, without drives (N m or N).
    pub loads: &'a [f64],
    /// The approximate relative error of all inertial parameters of the URDF.
    pub urdf_error: f64,
    /// The absolute torques of each joint in increasing order (N m or N).
    pub torques: &'a [Vec<f64>],
    /// Baseline dry friction (N m or N), 0 where there is none.
    pub coulomb: &'a [f64],
    /// When the first training recording begins and the last ends (s).
    pub span: (f64, f64),
}

/// A joint for which a fault is drawn.
pub(crate) struct Site<'a> {
    scales: &'a Scales<'a>,
    pub robot: &'a Robot,
    /// Whether the case is hard.
    pub hard: bool,
    /// Whether the case resembles a real robot.
    pub lifelike: bool,
    /// When the first training recording begins and the last ends (s).
    pub span: (f64, f64),
    pub joint: usize,
}

impl Scales<'_> {
    /// The joint with the index `joint`.
    pub(crate) fn site(&self, joint: usize) -> Site<'_> {
        Site { scales: self, robot: self.robot, hard: self.hard, lifelike: self.lifelike, span: self.span, joint }
    }
}

impl<'a> Site<'a> {
    /// Standard deviation of the joint's torque (N m or N), without faults.
    pub(crate) fn spread(&self) -> f64 {
        self.scales.spreads[self.joint]
    }

    /// The absolute torques of the joint in increasing order (N m or N).
    pub(crate) fn torques(&self) -> &'a [f64] {
        &self.scales.torques[self.joint]
    }

    /// The centre of the joint's motions (rad or m).
    pub(crate) fn home(&self) -> f64 {
        self.robot.home()[self.joint]
    }

    /// The inertia that the joint moves while the other joints are held, without its drive (kg m² or kg).
    pub(crate) fn link_inertia(&self) -> f64 {
        self.robot.link_inertia(self.joint)
    }

    /// The baseline inertia of the joint's drive, 0 where it has none (kg m² or kg).
    pub(crate) fn rotor_inertia(&self) -> f64 {
        self.robot.rotor(self.joint)
    }

    /// A factor that differs from 1 by a relative amount in `parts`, or by more, if errors of the URDF's masses, of
    /// which `bodies` count equally, and of the torque constants would produce the same factor: a smaller one cannot
    /// be distinguished from these errors.
    pub(crate) fn factor(&self, parts: Range<f64>, bodies: f64, random: &mut ChaCha8Rng) -> f64 {
        let constant = if self.lifelike { TORQUE_CONSTANT } else { 0.0 };
        let least = LEAST_DEVIATIONS * constant.hypot(self.scales.urdf_error / bodies.sqrt());
        let parts = parts.start.max(least)..parts.end.max(1.5 * least);
        let (part, sign) = (random.random_range(parts), sign(random));
        if sign > 0.0 { 1.0 + part } else { 1.0 / (1.0 + part) }
    }

    /// The payload (kg) that the arm could carry.
    pub(crate) fn load(&self) -> f64 {
        0.07 * self.robot.mass()
    }

    /// The plain dry friction below a friction curve (N m or N), which is that of the joint or a drawn one; and one of
    /// three forms, the first in easy cases.
    pub(crate) fn dry_friction(&self, random: &mut ChaCha8Rng) -> (f64, usize) {
        let drawn = self.spread() * random.random_range(0.08..0.25);
        let own = self.scales.coulomb[self.joint];
        let form = if self.hard { random.random_range(0..3) } else { 0 };
        (if own > 0.0 { own } else { drawn }, form)
    }

    /// Another joint's name and a phase; they are drawn for every fault outside the catalogue.
    pub(crate) fn other_and_phase(&self, random: &mut ChaCha8Rng) -> (&'a str, f64) {
        let joints = self.robot.arm().joints();
        let others: Vec<usize> = (0..joints.len()).filter(|&o| o != self.joint).collect();
        let other = others.choose(random).copied().unwrap_or(self.joint);
        (&joints[other].name, random.random_range(0.0..TAU))
    }
}

/// `bare` in another form than the first, with a probability of one half.
pub(crate) fn perhaps_in_form(bare: Injected, form: &str, random: &mut ChaCha8Rng) -> Injected {
    if random.random_bool(0.5) { bare.formed(form) } else { bare }
}

/// A number whose logarithm is distributed uniformly between the logarithms of `least` and `most`.
pub(crate) fn log_uniform(least: f64, most: f64, random: &mut ChaCha8Rng) -> f64 {
    random.random_range(least.ln()..most.ln()).exp()
}

/// 1 or −1.
pub(crate) fn sign(random: &mut ChaCha8Rng) -> f64 {
    if random.random_bool(0.5) { 1.0 } else { -1.0 }
}
