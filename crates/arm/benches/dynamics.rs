//! The time of one call of each algorithm, on the PUMA 560 or on the URDF in `TESTBED_BENCH_URDF`.

use arm::{Arm, DMatrix, Workspace};
use divan::Bencher;

fn arm() -> Arm {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/puma560.urdf");
    let path = std::env::var("TESTBED_BENCH_URDF").unwrap_or_else(|_| default.into());
    Arm::from_urdf(path).expect("the robot loads")
}

/// 256 different states, so that branch prediction and caches cannot adapt to one.
fn states(n: usize) -> Vec<[Vec<f64>; 3]> {
    let vector = |k: usize, phase: f64| (0..n).map(|i| ((k * 7 + i) as f64 * 0.37 + phase).sin()).collect();
    (0..256).map(|k| [vector(k, 0.0), vector(k, 1.0), vector(k, 2.0)]).collect()
}

fn run(bencher: Bencher, mut call: impl FnMut(&Arm, &mut Workspace, &[Vec<f64>; 3], &mut [f64])) {
    let arm = arm();
    let states = states(arm.dof());
    let mut workspace = Workspace::new(&arm);
    let mut out = vec![0.0; arm.dof()];
    let mut k = 0;
    bencher.bench_local(|| {
        k = (k + 1) % states.len();
        call(&arm, &mut workspace, &states[k], &mut out);
        out[0]
    });
}

#[divan::bench]
fn inverse_dynamics(bencher: Bencher) {
    run(bencher, |arm, w, [q, qd, qdd], tau| {
        arm.inverse_dynamics(w, q, qd, qdd, tau);
    });
}

#[divan::bench]
fn forward_dynamics(bencher: Bencher) {
    run(bencher, |arm, w, [q, qd, tau], qdd| {
        arm.forward_dynamics(w, q, qd, tau, qdd);
    });
}

#[divan::bench]
fn mass_matrix(bencher: Bencher) {
    let n = arm().dof();
    let mut m = DMatrix::zeros(n, n);
    run(bencher, move |arm, w, [q, ..], _| arm.mass_matrix(w, q, &mut m));
}

#[divan::bench]
fn torque_regressor(bencher: Bencher) {
    let n = arm().dof();
    let mut y = DMatrix::zeros(n, 10 * n);
    run(bencher, move |arm, w, [q, qd, qdd], _| {
        arm.torque_regressor(w, q, qd, qdd, &mut y);
    });
}

fn main() {
    divan::main();
}
