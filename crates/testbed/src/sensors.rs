//! Sensors: the true values plus seeded, normally distributed noise.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Standard deviations of the sensors' noise, one per joint.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorNoise {
    /// Positions (rad or m).
    pub position: Vec<f64>,
    /// Velocities (rad/s or m/s).
    pub velocity: Vec<f64>,
    /// Torques (N m or N).
    pub torque: Vec<f64>,
}

/// Sensors with their own noise; the same seed gives the same noise.
pub struct Sensors<'a> {
    noise: &'a SensorNoise,
    generator: ChaCha8Rng,
}

impl<'a> Sensors<'a> {
    /// Sensors with the noise of `seed`. Different `stream`s of one seed have independent noise.
    pub fn new(noise: &'a SensorNoise, seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self { noise, generator }
    }

    /// The measured positions and velocities of a true state, into `measured_q` and `measured_qd`.
    pub fn state(&mut self, q: &[f64], qd: &[f64], measured_q: &mut [f64], measured_qd: &mut [f64]) {
        disturb(&mut self.generator, q, &self.noise.position, measured_q);
        disturb(&mut self.generator, qd, &self.noise.velocity, measured_qd);
    }

    /// The measured torques of the true ones, into `measured`.
    pub fn torque(&mut self, tau: &[f64], measured: &mut [f64]) {
        disturb(&mut self.generator, tau, &self.noise.torque, measured);
    }
}

fn disturb(generator: &mut ChaCha8Rng, truth: &[f64], deviation: &[f64], measured: &mut [f64]) {
    for joint in 0..truth.len() {
        let normal: f64 = StandardNormal.sample(generator);
        measured[joint] = truth[joint] + deviation[joint] * normal;
    }
}
