//! Nanoseconds per state of the arm's algorithms, as JSON, for `benches/peers.sh`: for single states and for batches.
//!
//! The states and the checksums are those of `benches/peers/pinocchio.cpp`.

use std::hint::black_box;
use std::time::Instant;

use arm::{Arm, DMatrix, FEATURES, PARAMETERS_PER_LINK, Workspace};

/// States of the recording.
const STATES: usize = 10_000;

/// The number of states of a batch, and of a batch of regressors, which are large.
const BATCHES: [usize; 2] = [1000, 100];

/// The number of times a row is measured; the fastest time counts, because other programs disturbed it least.
const REPEATS: usize = 40;

/// Nanoseconds per state of `pass`, which computes `states` of them.
fn fastest(states: usize, mut pass: impl FnMut()) -> f64 {
    pass();
    let times = (0..REPEATS).map(|_| {
        let start = Instant::now();
        pass();
        start.elapsed().as_secs_f64() * 1e9 / states as f64
    });
    times.fold(f64::INFINITY, f64::min)
}

fn main() {
    let urdf = std::env::args().nth(1).expect("usage: arm_peers ROBOT.urdf [STATES]");
    let states = std::env::args().nth(2).map_or(STATES, |states| states.parse().expect("a number"));
    let arm = Arm::from_urdf(&urdf).expect("the robot loads");
    let n = arm.dof();
    let value = |k: usize, i: usize, phase: f64| ((k * 7 + i) as f64 * 0.37 + phase).sin();
    let rows = |phase: f64| -> Vec<f64> { (0..states * n).map(|at| value(at / n, at % n, phase)).collect() };
    let (q, qd, qdd) = (rows(0.0), rows(1.0), rows(2.0));
    // Joint after joint within each batch.
    let batches = |size: usize, phase: f64| -> Vec<f64> {
        let entry = |at: usize| {
            let (batch, rest) = (at / (size * n), at % (size * n));
            value(batch * size + rest % size, rest / size, phase)
        };
        (0..states / size * size * n).map(entry).collect()
    };
    let [usual, small] = BATCHES.map(|size| (size, [0.0, 1.0, 2.0].map(|phase| batches(size, phase))));

    let mut workspace = Workspace::new(&arm);
    let mut vector = vec![0.0; n];
    let mut features = vec![[0.0; FEATURES]; n];
    let mut mass = DMatrix::zeros(n, n);
    let mut regressor = DMatrix::zeros(n, n * PARAMETERS_PER_LINK);
    let at = |k: usize| k * n..(k + 1) * n;
    let mut rows: Vec<(&str, f64)> = Vec::new();

    let mut sums = [0.0; 4];
    for k in 0..states {
        arm.inverse_dynamics(&mut workspace, &q[at(k)], &qd[at(k)], &qdd[at(k)], &mut vector);
        sums[0] += vector.iter().sum::<f64>();
        arm.forward_dynamics(&mut workspace, &q[at(k)], &qd[at(k)], &qdd[at(k)], &mut vector);
        sums[1] += vector.iter().sum::<f64>();
        arm.mass_matrix(&mut workspace, &q[at(k)], &mut mass);
        sums[2] += mass.sum();
        arm.torque_regressor(&mut workspace, &q[at(k)], &qd[at(k)], &qdd[at(k)], &mut regressor);
        sums[3] += regressor.sum();
    }

    type Call<'a> = &'a mut dyn FnMut(&[f64], &[f64], &[f64]);
    let mut alone = |name: &'static str, call: Call| {
        let time = fastest(states, || {
            for ((q, qd), qdd) in q.chunks_exact(n).zip(qd.chunks_exact(n)).zip(qdd.chunks_exact(n)) {
                call(q, qd, qdd);
            }
        });
        rows.push((name, time));
    };
    alone("inverse_dynamics", &mut |q, qd, qdd| {
        arm.inverse_dynamics(&mut workspace, q, qd, qdd, &mut vector);
        black_box(&vector);
    });
    alone("features", &mut |q, qd, qdd| {
        arm.newton_euler_features(&mut workspace, q, qd, qdd, &mut vector, &mut features);
        black_box(&features);
    });
    alone("forward_dynamics", &mut |q, qd, qdd| {
        arm.forward_dynamics(&mut workspace, q, qd, qdd, &mut vector);
        black_box(&vector);
    });
    alone("mass_matrix", &mut |q, _, _| {
        arm.mass_matrix(&mut workspace, q, &mut mass);
        black_box(&mass);
    });
    alone("regressor", &mut |q, qd, qdd| {
        arm.torque_regressor(&mut workspace, q, qd, qdd, &mut regressor);
        black_box(&regressor);
    });

    type Batches = (usize, [Vec<f64>; 3]);
    type BatchCall<'a> = &'a dyn Fn([&[f64]; 3], &mut [f64]);
    let mut together = |name, (size, signals): &Batches, width: usize, call: BatchCall| {
        let mut output = vec![0.0; size * n * width];
        let time = fastest(states / size * size, || {
            for start in (0..signals[0].len()).step_by(size * n) {
                let all = start..start + size * n;
                call(signals.each_ref().map(|signal| &signal[all.clone()]), &mut output);
                black_box(&output);
            }
        });
        rows.push((name, time));
    };
    together("inverse_dynamics_batch", &usual, 1, &|[q, qd, qdd], tau| {
        arm.inverse_dynamics_batch(q, qd, qdd, tau);
    });
    together("forward_dynamics_batch", &usual, 1, &|[q, qd, tau], qdd| {
        arm.forward_dynamics_batch(q, qd, tau, qdd);
    });
    together("mass_matrix_batch", &usual, n, &|[q, ..], mass| {
        arm.mass_matrix_batch(q, mass);
    });
    together("regressor_batch", &small, n * PARAMETERS_PER_LINK, &|[q, qd, qdd], regressor| {
        arm.torque_regressor_batch(q, qd, qdd, regressor);
    });

    let times: Vec<String> = rows.iter().map(|(name, ns)| format!("\"{name}\": {ns:.2}")).collect();
    let sums: Vec<String> = sums.iter().map(|sum| format!("{sum:.17e}")).collect();
    println!("{{\"ns\": {{{}}}, \"sums\": [{}], \"dof\": {n}}}", times.join(", "), sums.join(", "));
}
