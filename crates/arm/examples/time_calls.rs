//! Prints the nanoseconds of a call of each algorithm on a URDF, for `benches/peers.sh`.
//!
//! ```sh
//! cargo run --release -p arm --example time_calls -- robot.urdf 200000
//! ```

use std::hint::black_box;
use std::time::Instant;

use arm::{Arm, DMatrix, Workspace};

/// States to walk through, so that no branch learns one by heart.
const STATES: usize = 256;

fn per_call(calls: usize, mut call: impl FnMut(usize)) -> f64 {
    (0..1000).for_each(|k| call(k % STATES));
    let start = Instant::now();
    (0..calls).for_each(|k| call(k % STATES));
    start.elapsed().as_secs_f64() * 1e9 / calls as f64
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [urdf, calls] = arguments.as_slice() else {
        return Err("usage: ROBOT.urdf CALLS".into());
    };
    let arm = Arm::from_urdf(urdf)?;
    let calls: usize = calls.parse()?;
    let n = arm.dof();
    let vector =
        |k: usize, phase: f64| -> Vec<f64> { (0..n).map(|i| ((k * 7 + i) as f64 * 0.37 + phase).sin()).collect() };
    let states: Vec<[Vec<f64>; 3]> = (0..STATES)
        .map(|k| [vector(k, 0.0), vector(k, 1.0), vector(k, 2.0)])
        .collect();
    let mut workspace = Workspace::new(&arm);
    let mut out = vec![0.0; n];
    let mut mass = DMatrix::zeros(n, n);
    let mut regressor = DMatrix::zeros(n, arm::PARAMETERS_PER_LINK * n);
    let inverse = per_call(calls, |k| {
        let [q, qd, qdd] = &states[k];
        arm.inverse_dynamics(&mut workspace, q, qd, qdd, &mut out);
        black_box(out[0]);
    });
    let forward = per_call(calls, |k| {
        let [q, qd, tau] = &states[k];
        arm.forward_dynamics(&mut workspace, q, qd, tau, &mut out);
        black_box(out[0]);
    });
    let matrix = per_call(calls, |k| {
        arm.mass_matrix(&mut workspace, &states[k][0], &mut mass);
        black_box(mass[0]);
    });
    let columns = per_call(calls, |k| {
        let [q, qd, qdd] = &states[k];
        arm.torque_regressor(&mut workspace, q, qd, qdd, &mut regressor);
        black_box(regressor[0]);
    });
    println!(
        "{{\"inverse dynamics\": {inverse:.1}, \"forward dynamics\": {forward:.1}, \"mass matrix\": {matrix:.1}, \"torque regressor\": {columns:.1}}}"
    );
    Ok(())
}
