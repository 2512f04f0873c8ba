//! The time of a millisecond of the plant by order, and that of a Runge-Kutta step of the analytic dynamics for
//! comparison.
#![allow(missing_docs)]

#[path = "../src/test_arms.rs"]
mod test_arms;

use divan::Bencher;
use plant::{Plant, PlantOptions};
use test_arms::{Reference, puma};

fn main() {
    divan::main();
}

/// A free motion from rest; the torques do not affect the computing time.
const START: [f64; 6] = [0.3, -0.4, 0.5, 0.6, -0.7, 0.8];

fn plant(options: PlantOptions) -> Plant {
    let mut plant = Plant::new(&puma(), &options).expect("the PUMA can be simulated");
    plant.set_state(&START, &START).expect("six finite values");
    plant
}

#[divan::bench(args = [1, 2, 3, 4])]
fn smooth(bencher: Bencher, order: usize) {
    let mut plant = plant(PlantOptions { order, ..PlantOptions::default() });
    bencher.bench_local(|| {
        plant.set_state(&START, &START).expect("six finite values");
        plant.step(&[0.0; 6])
    });
}

/// Joint 1 at rest under a torque below its friction, the others sliding.
#[divan::bench]
fn one_of_six_stuck(bencher: Bencher) {
    let mut plant = plant(PlantOptions { coulomb: vec![1e3, 0.1, 0.1, 1e-3, 1e-3, 1e-3], ..PlantOptions::default() });
    let mut qd = START;
    qd[0] = 0.0;
    bencher.bench_local(|| {
        plant.set_state(&START, &qd).expect("six finite values");
        plant.step(&[0.0; 6])
    });
}

/// Joint 1 stops within the step.
#[divan::bench]
fn one_of_six_stopping(bencher: Bencher) {
    let mut plant = plant(PlantOptions { coulomb: vec![100.0, 0.1, 0.1, 1e-3, 1e-3, 1e-3], ..PlantOptions::default() });
    let mut qd = START;
    qd[0] = 0.01;
    bencher.bench_local(|| {
        plant.set_state(&START, &qd).expect("six finite values");
        plant.step(&[0.0; 6])
    });
    assert!(plant.is_stuck(0), "joint 1 should stop");
}

#[divan::bench]
fn analytic_runge_kutta(bencher: Bencher) {
    let arm = puma();
    let mut reference = Reference::new(&arm);
    bencher.bench_local(|| {
        let (mut q, mut qd) = (START, START);
        reference.run(&mut q, &mut qd, &[0.0; 6], 1e-3, 1);
        q
    });
}
