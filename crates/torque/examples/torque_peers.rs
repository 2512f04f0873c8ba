//! Noisy training points of Independent Joint Learning, for `benches/peers.sh`. Inputs: `SAMPLES TRAIN.csv TEST.csv`.
//!
//! The PUMA 560 moves along sines, its measured motion and torque have noise, and the masses of the nominal model are
//! 20 % too large. The columns are the thirteen inputs of joint 2 from the noisy motion, and the residual torque of
//! the nominal model. The test points are from another part of the motion, without noise.

#[path = "../tests/support/mod.rs"]
#[expect(dead_code, reason = "the tests need more of it")]
mod support;

use std::fmt::Write;

use support::{motion, puma560};

/// Standard deviations of the noise on q (rad), q̇ (rad/s), q̈ (rad/s²) and τ (N m).
const NOISE: [f64; 4] = [1e-4, 1e-2, 0.3, 0.5];

/// The number of test points.
const TESTS: usize = 2000;

/// The joint, from 0.
const JOINT: usize = 1;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [samples, train, test] = arguments.as_slice() else {
        panic!("usage: torque_peers SAMPLES TRAIN.csv TEST.csv");
    };
    let samples: usize = samples.parse().expect("a number of samples");
    let seconds = samples as f64 / 80.0;
    std::fs::write(train, table(samples, 0.0, 1.0)).expect("the table can be written");
    // The frequencies have no common period within the motion.
    std::fs::write(test, table(TESTS, seconds + 0.005, 0.0)).expect("the table can be written");
}

fn table(samples: usize, from: f64, noise: f64) -> String {
    let exact = puma560();
    let nominal = puma560().with_scaled_inertias(1.2);
    let mut workspace = arm::Workspace::new(&exact);
    let (mut tau, mut rigid) = (vec![0.0; 6], vec![0.0; 6]);
    let mut features = vec![[0.0; arm::FEATURES]; 6];
    let mut random = Random(1);
    let mut text = String::from("x0,x1,x2,x3,x4,x5,x6,x7,x8,x9,x10,x11,x12,y\n");
    for k in 0..samples {
        let mut state = motion(from + k as f64 / 80.0, 0);
        let [q, qd, qdd] = &state;
        exact.inverse_dynamics(&mut workspace, q, qd, qdd, &mut tau);
        for (signal, deviation) in state.iter_mut().zip(NOISE) {
            for value in signal {
                *value += noise * deviation * random.normal();
            }
        }
        let [q, qd, qdd] = &state;
        nominal.newton_euler_features(&mut workspace, q, qd, qdd, &mut rigid, &mut features);
        let left = tau[JOINT] + noise * NOISE[3] * random.normal() - rigid[JOINT];
        for value in features[JOINT] {
            write!(text, "{value:.9},").expect("a string takes it");
        }
        writeln!(text, "{left:.9}").expect("a string takes it");
    }
    text
}

/// A pseudorandom generator with a fixed seed.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number with mean 0 and variance 1: the sum of twelve uniform numbers, centred.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}
