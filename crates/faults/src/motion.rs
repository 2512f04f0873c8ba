//! The reference motions: excitation for training, pick and place for the held-out recording.

use std::f64::consts::TAU;

use arm::{Arm, JointKind, Workspace};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::robot::Robot;

/// The period of the position loop, and the step of the plant (s).
pub(crate) const TICK: f64 = 1e-3;
/// The duration of a recording, and the pause between two recordings (s).
pub const DURATION: f64 = 25.0;
/// See [`DURATION`].
pub const PAUSE: f64 = 5.0;
/// The number of ticks that the loop runs before a recording begins.
pub(crate) const LEAD_TICKS: usize = 500;
/// The largest shares of a joint's velocity and effort limits that a motion may use.
const LIMIT_SHARE: f64 = 0.8;
/// The highest velocity of an excitation where a joint has no limit (rad/s or m/s).
const FASTEST: f64 = 2.2;

/// A motion with the nominal torque at every tick; `[tick × dof + joint]`.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    dof: usize,
    /// The time of the first recorded row (s, on the recordings' clock).
    pub start: f64,
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
    /// Feed-forward torque of the user's model (N m or N).
    pub ff: Vec<f64>,
}

impl Reference {
    /// The number of ticks, including those before the recording.
    pub(crate) fn ticks(&self) -> usize {
        self.q.len() / self.dof
    }

    /// The time of a tick (s, on the recordings' clock).
    pub(crate) fn time(&self, tick: usize) -> f64 {
        self.start + (tick as f64 - LEAD_TICKS as f64) * TICK
    }

    pub(crate) fn new(arm: &Arm, start: f64, q: Vec<f64>) -> Self {
        let n = arm.dof();
        let qd = rates(&q, n);
        let qdd = rates(&qd, n);
        let mut workspace = Workspace::new(arm);
        let mut ff = vec![0.0; q.len()];
        for (((ff, q), qd), qdd) in ff.chunks_mut(n).zip(q.chunks(n)).zip(qd.chunks(n)).zip(qdd.chunks(n)) {
            arm.inverse_dynamics(&mut workspace, q, qd, qdd, ff);
        }
        Self { dof: n, start, q, qd, qdd, ff }
    }

    /// Its first `seconds` seconds.
    pub(crate) fn first_seconds(mut self, seconds: f64) -> Self {
        let length = (LEAD_TICKS + (seconds / TICK) as usize) * self.dof;
        for values in [&mut self.q, &mut self.qd, &mut self.qdd, &mut self.ff] {
            values.truncate(length);
        }
        self
    }

    /// Whether no drive needs more than the allowed share of its effort limit.
    fn is_feasible(&self, robot: &Robot) -> bool {
        let joints = robot.arm().joints();
        let torques = self.ff.iter().zip(&self.qdd).enumerate();
        torques.into_iter().all(|(k, (ff, qdd))| {
            let j = k % self.dof;
            (ff + robot.rotor_inertias()[j] * qdd).abs() <= LIMIT_SHARE * joints[j].limits.effort
        })
    }
}

/// The time at which recording `number` of a case begins (s).
pub(crate) fn start(number: usize) -> f64 {
    number as f64 * (DURATION + PAUSE)
}

/// Velocities and accelerations by central differences.
fn rates(values: &[f64], n: usize) -> Vec<f64> {
    let last = values.len() / n - 1;
    let mut rates = vec![0.0; values.len()];
    for tick in 0..=last {
        let (before, after) = (tick.saturating_sub(1), (tick + 1).min(last));
        for j in 0..n {
            rates[tick * n + j] = (values[after * n + j] - values[before * n + j]) / ((after - before) as f64 * TICK);
        }
    }
    rates
}

/// x³ (10 − 15 x + 6 x²): it rises from 0 to 1, with zero derivatives on both sides.
fn ease(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

/// The range of a joint's motion about its home position (rad or m): half of the room within its limits, at most
/// `most`.
fn reach(robot: &Robot, j: usize, most: f64) -> f64 {
    let joint = &robot.arm().joints()[j];
    let room = (joint.limits.upper - robot.home()[j]).min(robot.home()[j] - joint.limits.lower);
    let unlimited = match joint.kind {
        JointKind::Revolute => most,
        JointKind::Prismatic => 0.4 * most,
    };
    unlimited.min(0.9 * room)
}

fn ticks() -> usize {
    LEAD_TICKS + (DURATION / TICK).round() as usize + 1
}

/// Five harmonics of 0.08 to 0.13 Hz on every joint at the same time, faded in, within the joints' limits.
pub(crate) fn excitation(robot: &Robot, start: f64, random: &mut impl Rng) -> Reference {
    let n = robot.arm().dof();
    let base: f64 = random.random_range(0.08..0.13);
    let mut waves = vec![0.0; ticks() * n];
    let mut centers = vec![0.0; n];
    for j in 0..n {
        let mut wave = vec![0.0; ticks()];
        for harmonic in 1..=5_u8 {
            let h = f64::from(harmonic);
            let normal: f64 = StandardNormal.sample(random);
            let amplitude = normal / h.powf(random.random_range(0.1..0.6));
            let phase = random.random_range(0.0..TAU);
            for (tick, value) in wave.iter_mut().enumerate() {
                let time = (tick as f64 - LEAD_TICKS as f64) * TICK;
                *value += amplitude * (TAU * base * h * time + phase).sin();
            }
        }
        let (least, most) = wave
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), &value| (least.min(value), most.max(value)));
        let reach = reach(robot, j, 1.075);
        // A peak-to-peak range of 0.85 to 1.45 and a centre within ±0.35, where the limits allow it.
        let span = random.random_range(0.79..1.35) * reach / (most - least);
        centers[j] = robot.home()[j] + random.random_range(-0.32..0.32) * reach;
        let speed = wave.windows(2).map(|pair| (pair[1] - pair[0]).abs() / TICK).fold(0.0, f64::max);
        let fastest = FASTEST.min(LIMIT_SHARE * robot.arm().joints()[j].limits.velocity);
        let scale = span.min(fastest / speed);
        for (tick, value) in wave.iter().enumerate() {
            let ramp = ease((tick as f64 - LEAD_TICKS as f64) * TICK / 2.0);
            waves[tick * n + j] = ramp * scale * (value - 0.5 * (least + most));
        }
    }
    reduced_to_limits(robot, start, &centers, &waves)
}

/// The motion `waves` about `centers`, reduced until the drives can follow it; a load that they cannot hold at rest is
/// not reduced.
fn reduced_to_limits(robot: &Robot, start: f64, centers: &[f64], waves: &[f64]) -> Reference {
    let mut size = 1.0;
    loop {
        let place = |(k, wave): (usize, &f64)| centers[k % centers.len()] + size * wave;
        let q = waves.iter().enumerate().map(place).collect();
        let reference = Reference::new(robot.arm(), start, q);
        if size < 0.3 || reference.is_feasible(robot) {
            return reference;
        }
        size *= 0.8;
    }
}

/// Motions of 1.1 to 2.3 s between random poses, with rests of 0.3 to 1 s.
pub(crate) fn pick_and_place(robot: &Robot, start: f64, random: &mut impl Rng) -> Reference {
    let n = robot.arm().dof();
    let reaches: Vec<f64> = (0..n).map(|j| reach(robot, j, 0.8)).collect();
    let mut at: Vec<f64> = reaches.iter().map(|reach| random.random_range(-0.5..0.5) * reach).collect();
    let mut waves = Vec::with_capacity(ticks() * n);
    let rest = |waves: &mut Vec<f64>, at: &[f64], length: usize| {
        for _ in 0..length {
            waves.extend_from_slice(at);
        }
    };
    rest(&mut waves, &at, LEAD_TICKS + random.random_range(0..200));
    while waves.len() < ticks() * n {
        let next: Vec<f64> = reaches.iter().map(|reach| random.random_range(-1.0..1.0) * reach).collect();
        let mut time: f64 = random.random_range(1.1..2.3);
        for j in 0..n {
            // The peak velocity of either profile is below twice its mean.
            let fastest = LIMIT_SHARE * robot.arm().joints()[j].limits.velocity;
            time = time.max(2.0 * (next[j] - at[j]).abs() / fastest);
        }
        let length = (time / TICK).round() as usize;
        let edge = random.random_range(0.25..0.4);
        let trapezoid = random.random_bool(0.5);
        for k in 1..=length {
            let x = k as f64 / length as f64;
            let part = if trapezoid { rounded_trapezoid(x, edge) } else { ease(x) };
            waves.extend(at.iter().zip(&next).map(|(at, next)| at + part * (next - at)));
        }
        at = next;
        rest(&mut waves, &at, random.random_range(300..1000));
    }
    waves.truncate(ticks() * n);
    reduced_to_limits(robot, start, robot.home(), &waves)
}

/// A profile from 0 to 1 with constant velocity in the middle; acceleration and deceleration each take the share
/// `edge` of the time.
fn rounded_trapezoid(x: f64, edge: f64) -> f64 {
    // The integral of a smooth velocity ramp: ∫ ease = x⁴ (2.5 − 3 x + x²).
    let rise = |x: f64| edge * x.powi(4) * (2.5 + x * (x - 3.0));
    let total = 1.0 - edge;
    let at = if x < edge {
        rise(x / edge)
    } else if x <= 1.0 - edge {
        0.5 * edge + (x - edge)
    } else {
        total - rise((1.0 - x) / edge)
    };
    at / total
}

#[cfg(test)]
impl Reference {
    /// The rigid torque along encoder positions.
    pub(crate) fn along(arm: &Arm, q: &[f64]) -> Vec<f64> {
        Self::new(arm, 0.0, q.to_vec()).ff
    }
}
