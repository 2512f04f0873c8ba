//! Error and computing time of a millisecond of the plant by order, as JSON, for `benches/peers.sh`. Inputs:
//! `ROBOT.urdf TRACK.csv`.
//!
//! The arm tracks sines in closed loop for two seconds: inverse dynamics of the reference plus feedback at 1 kHz, with
//! constant torques between the ticks. The error is the largest distance (rad) from the same loop on the arm's own
//! forward dynamics, integrated by the Runge-Kutta method with steps of 20 µs. The track is written so that MuJoCo can
//! follow it.

use std::fmt::Write;
use std::time::Instant;

use arm::{Arm, DMatrix, Workspace};
use plant::{Plant, PlantOptions};

/// Gains of position (1/s²) and velocity (1/s), to be multiplied by each joint's own inertia at q = 0.
const GAINS: [f64; 2] = [100.0, 20.0];

/// The number of milliseconds of the track.
const LENGTH: usize = 2000;

/// The number of steps of the exact solution per millisecond.
const SUBSTEPS: usize = 50;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [urdf, track] = arguments.as_slice() else {
        panic!("usage: plant_peers ROBOT.urdf TRACK.csv");
    };
    let arm = Arm::from_urdf(urdf).expect("the robot loads");
    let track_of = exact_track(&arm);
    std::fs::write(track, table(&track_of)).expect("the track can be written");
    let orders: Vec<String> = (1..=4)
        .map(|order| {
            let (error, nanoseconds) = plant(&arm, order, &track_of);
            format!("{{\"order\": {order}, \"error\": {error:e}, \"ns\": {nanoseconds:.1}}}")
        })
        .collect();
    println!("{{\"orders\": [{}]}}", orders.join(", "));
}

/// The reference q, q̇, its torque, and the exact positions at the end of each millisecond.
struct Track {
    /// The gains of position and velocity for each joint.
    gains: [Vec<f64>; 2],
    start: [Vec<f64>; 2],
    rows: Vec<[Vec<f64>; 4]>,
}

fn reference(n: usize, time: f64) -> [Vec<f64>; 3] {
    let each = |value: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        (0..n).map(|i| value(0.5 - 0.05 * i as f64, std::f64::consts::TAU * (0.4 + 0.07 * i as f64))).collect()
    };
    [
        each(&|amplitude, omega| amplitude * (omega * time).sin()),
        each(&|amplitude, omega| amplitude * omega * (omega * time).cos()),
        each(&|amplitude, omega| -amplitude * omega * omega * (omega * time).sin()),
    ]
}

fn command(gains: &[Vec<f64>; 2], [wanted, speed, torque]: [&[f64]; 3], q: &[f64], qd: &[f64]) -> Vec<f64> {
    (0..q.len()).map(|i| torque[i] + (gains[0][i] * (wanted[i] - q[i]) + gains[1][i] * (speed[i] - qd[i]))).collect()
}

fn exact_track(arm: &Arm) -> Track {
    let n = arm.dof();
    let mut workspace = Workspace::new(arm);
    let [mut q, mut qd, _] = reference(n, 0.0);
    let start = [q.clone(), qd.clone()];
    let mut mass = DMatrix::zeros(n, n);
    arm.mass_matrix(&mut workspace, &q, &mut mass);
    let gains = GAINS.map(|gain| (0..n).map(|i| gain * mass[(i, i)]).collect());
    let mut rows = Vec::with_capacity(LENGTH);
    for k in 0..LENGTH {
        let [wanted, speed, acceleration] = reference(n, 1e-3 * k as f64);
        let mut torque = vec![0.0; n];
        arm.inverse_dynamics(&mut workspace, &wanted, &speed, &acceleration, &mut torque);
        let tau = command(&gains, [&wanted, &speed, &torque], &q, &qd);
        for _ in 0..SUBSTEPS {
            runge_kutta(arm, &mut workspace, &mut q, &mut qd, &tau, 1e-3 / SUBSTEPS as f64);
        }
        rows.push([wanted, speed, torque, q.clone()]);
    }
    Track { gains, start, rows }
}

fn runge_kutta(arm: &Arm, workspace: &mut Workspace, q: &mut [f64], qd: &mut [f64], tau: &[f64], step: f64) {
    let n = q.len();
    let (mut move_by, mut speed_by) = (vec![0.0; n], vec![0.0; n]);
    let (mut slope, mut curve) = (vec![0.0; n], vec![0.0; n]);
    for (share, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
        let at: Vec<f64> = (0..n).map(|i| q[i] + share * step * slope[i]).collect();
        let speed: Vec<f64> = (0..n).map(|i| qd[i] + share * step * curve[i]).collect();
        arm.forward_dynamics(workspace, &at, &speed, tau, &mut curve);
        slope = speed;
        for i in 0..n {
            move_by[i] += step / 6.0 * weight * slope[i];
            speed_by[i] += step / 6.0 * weight * curve[i];
        }
    }
    for i in 0..n {
        q[i] += move_by[i];
        qd[i] += speed_by[i];
    }
}

/// The gains, the start, then the rows.
fn table(track: &Track) -> String {
    let width = 4 * track.start[0].len();
    let mut text = String::new();
    let mut line = |values: Vec<f64>| {
        let mut values: Vec<String> = values.iter().map(|value| format!("{value:e}")).collect();
        values.resize(width, "0".into());
        writeln!(text, "{}", values.join(",")).expect("a string takes it");
    };
    line(track.gains.concat());
    line(track.start.concat());
    for row in &track.rows {
        line(row.concat());
    }
    text
}

/// The plant's error along the track (rad), and the median time of one of its steps (ns).
fn plant(arm: &Arm, order: usize, track: &Track) -> (f64, f64) {
    let options = PlantOptions { order, ..PlantOptions::default() };
    let mut worst = 0.0_f64;
    let mut plant = Plant::new(arm, &options).expect("the robot can be simulated");
    plant.set_state(&track.start[0], &track.start[1]).expect("finite values");
    let mut times = Vec::with_capacity(track.rows.len());
    for [wanted, speed, torque, exact] in &track.rows {
        let tau = command(&track.gains, [wanted, speed, torque], plant.q(), plant.qd());
        let begun = Instant::now();
        plant.step(&tau).expect("the step is taken");
        times.push(begun.elapsed().as_secs_f64() * 1e9);
        for (q, exact) in plant.q().iter().zip(exact) {
            worst = worst.max((q - exact).abs());
        }
    }
    times.sort_by(f64::total_cmp);
    (worst, times[times.len() / 2])
}
