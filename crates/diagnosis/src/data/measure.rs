//! Measurements on the recordings before any fit: scales, noise, the largest torques.

use arm::{Arm, Workspace};
use effects::Scales;
use nalgebra::{DMatrix, SMatrix, SVector};

use crate::data::motion::{Chunk, Motions, SourceRecording};
use crate::data::rigid::Rigid;
use crate::data::statistics::{deviation, mean, quantile_of_sorted};
use crate::thresholds::{DEAD, NEEDED_QUANTILE, NOISE_ALONE, RANGE_QUANTILES, REST, REST_NOISE, SPEED_QUANTILE};

/// The number of poses of a section at which the mass matrix is evaluated to judge the noise.
const POSES: usize = 10;

/// The ridge of the fit in [`inertial`], relative to each column's square.
const ALIKE: f64 = 1e-6;

/// The largest measured torque of each joint (N m or N).
pub fn largest(motions: &Motions) -> Vec<f64> {
    let torques = |joint: usize| motions.chunks.iter().flat_map(move |chunk| &chunk.tau[joint]);
    (0..motions.dof)
        .map(|joint| torques(joint).fold(0.0_f64, |largest, tau| largest.max(tau.abs())))
        .collect()
}

/// The torque that each joint needs by the model, without the largest 0.1 % (N m or N).
pub fn needed(motions: &Motions, rigid: &[Rigid]) -> Vec<f64> {
    let needed = |joint: usize| {
        let mut needed: Vec<f64> = rigid
            .iter()
            .flat_map(|rigid| rigid.tau[joint].iter().map(|tau| tau.abs()))
            .collect();
        let at = (NEEDED_QUANTILE * needed.len() as f64) as usize;
        if needed.is_empty() {
            0.0
        } else {
            *needed.select_nth_unstable_by(at, f64::total_cmp).1
        }
    };
    (0..motions.dof).map(needed).collect()
}

/// The standard deviation of the torque that accelerations need on each joint in the training recordings, after both filters,
/// over that of the measured torque; zero if there is no measured torque.
///
/// It is what multiples of the model's inertial torque and of the joint's own acceleration explain of the measured torque beside
/// gravity, friction and a constant: many URDFs omit the inertias of the drives, which may be most of what the joint moves.
pub fn inertial(motions: &Motions, rigid: &[Rigid], torque: &[f64]) -> Vec<f64> {
    let share = |joint: usize| {
        if torque[joint] <= 0.0 {
            return 0.0;
        }
        let mut columns: [Vec<f64>; 6] = Default::default();
        let mut measured = Vec::new();
        let chunks = motions.chunks.iter().zip(rigid);
        for (chunk, rigid) in chunks.filter(|(chunk, _)| is_fitted(motions, chunk)) {
            let (qd, qdd) = (&chunk.qd[joint], &chunk.qdd[joint]);
            let links = |tick: usize| -> f64 {
                (0..motions.dof)
                    .map(|by| rigid.mass[joint][by][tick] * chunk.qdd[by][tick])
                    .sum()
            };
            let along =
                |signal: &dyn Fn(usize) -> f64| chunk.filter(&(0..chunk.ticks()).map(signal).collect::<Vec<f64>>());
            let signals: [&dyn Fn(usize) -> f64; 6] = [
                &links,
                &|tick| qdd[tick],
                &|tick| rigid.tau[joint][tick] - links(tick),
                &|tick| qd[tick],
                &|tick| qd[tick].signum(),
                &|_| 1.0,
            ];
            for (column, signal) in columns.iter_mut().zip(signals) {
                column.extend(along(signal));
            }
            measured.extend(chunk.filter(&chunk.tau[joint]));
        }
        let inner = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let size = columns
            .each_ref()
            .map(|column| inner(column, column).sqrt().max(1e-300));
        // The ridge lets columns that are multiples of each other share the torque.
        let normal = SMatrix::<f64, 6, 6>::from_fn(|i, k| {
            let ridge = if i == k { ALIKE } else { 0.0 };
            inner(&columns[i], &columns[k]) / (size[i] * size[k]) + ridge
        });
        let right = SVector::<f64, 6>::from_fn(|i, _| inner(&columns[i], &measured) / size[i]);
        let Some(factor) = normal.cholesky() else { return 0.0 };
        let fitted = factor.solve(&right);
        let (links, own) = (fitted[0] / size[0], fitted[1] / size[1]);
        let needed = columns[0].iter().zip(&columns[1]).map(|(a, b)| links * a + own * b);
        deviation(needed) / torque[joint]
    };
    (0..motions.dof).map(share).collect()
}

/// The standard deviation of each joint's measured torque in the training recordings (N m or N).
pub fn deviations(motions: &Motions) -> Vec<f64> {
    let chunks = || motions.chunks.iter().filter(|chunk| is_fitted(motions, chunk));
    (0..motions.dof)
        .map(|joint| deviation(chunks().flat_map(move |chunk| &chunk.tau[joint])))
        .collect()
}

/// The largest part of a joint's torque that the noise of the positions causes through the mass matrix, and the joint.
pub fn noise_share(motions: &Motions, arm: &Arm) -> (f64, usize) {
    let mut workspace = Workspace::new(arm);
    let mut mass = DMatrix::zeros(motions.dof, motions.dof);
    let mut largest = DMatrix::<f64>::zeros(motions.dof, motions.dof);
    let fitted = |chunk: &&Chunk| !motions.sources[chunk.recording].held_out;
    for chunk in motions.chunks.iter().filter(fitted) {
        for tick in (0..chunk.ticks()).step_by((chunk.ticks() / POSES).max(1)) {
            let q: Vec<f64> = chunk.q.iter().map(|q| q[tick]).collect();
            arm.mass_matrix(&mut workspace, &q, &mut mass);
            largest = largest.zip_map(&mass, |a, b| a.max(b.abs()));
        }
    }
    let torque = deviations(motions);
    let share = |joint: usize| {
        if torque[joint] <= 0.0 || motions.tempo[joint] == 0.0 {
            return 0.0;
        }
        let of = |source: &SourceRecording| -> f64 {
            let parts = (0..motions.dof).map(|by| (largest[(joint, by)] * source.acceleration_noise[by]).powi(2));
            parts.sum::<f64>().sqrt() / torque[joint]
        };
        let shares = motions.sources.iter().filter(|source| !source.held_out).map(of);
        shares.fold(0.0, f64::max)
    };
    (0..motions.dof)
        .map(|joint| (share(joint), joint))
        .fold((0.0, 0), |most, next| if next.0 > most.0 { next } else { most })
}

/// The joints with dead channels: their `torque` does not vary while the model's does, apart from noise.
pub fn dead(motions: &Motions, rigid: &[Rigid], torque: &[f64]) -> Vec<usize> {
    let fitted = || {
        let chunks = motions.chunks.iter().zip(rigid);
        chunks.filter(|(chunk, _)| is_fitted(motions, chunk))
    };
    let is_dead = |&joint: &usize| {
        let needed = deviation(fitted().flat_map(move |(_, rigid)| &rigid.tau[joint]));
        let noise = motions.sources.iter().map(|source| source.torque_noise[joint]);
        let noise = noise.fold(0.0, f64::max);
        torque[joint] <= (NOISE_ALONE * noise).max(1e-9 * needed) && torque[joint] <= DEAD * needed
    };
    (0..motions.dof).filter(is_dead).collect()
}

fn is_fitted(motions: &Motions, chunk: &Chunk) -> bool {
    !motions.sources[chunk.recording].held_out
}

/// Speeds and ranges of all joints, with their torques.
pub fn scales(motions: &Motions, torque: Vec<f64>) -> Scales {
    let sorted = |pick: &dyn Fn(&Chunk) -> Vec<f64>| -> Vec<f64> {
        let mut values: Vec<f64> = motions.chunks.iter().flat_map(pick).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let mut scales = Scales {
        speed: Vec::new(),
        rest: Vec::new(),
        middle: Vec::new(),
        range: Vec::new(),
        torque,
    };
    for joint in 0..motions.dof {
        let speeds = sorted(&|chunk| chunk.qd[joint].iter().map(|v| v.abs()).collect());
        let positions = sorted(&|chunk| chunk.q[joint].clone());
        let speed = quantile_of_sorted(&speeds, SPEED_QUANTILE);
        let noise = motions
            .sources
            .iter()
            .map(|source| source.velocity_noise[joint])
            .fold(0.0, f64::max);
        scales.speed.push(speed);
        scales.rest.push((REST * speed).max(REST_NOISE * noise).max(1e-6));
        let (low, high) = (
            quantile_of_sorted(&positions, RANGE_QUANTILES.0),
            quantile_of_sorted(&positions, RANGE_QUANTILES.1),
        );
        scales.middle.push(0.5 * (low + high));
        scales.range.push((high - low).max(1e-6));
    }
    scales
}

/// The time between rows of each recording (s).
pub fn seconds(motions: &Motions) -> Vec<f64> {
    let mut seconds = vec![0.0; motions.sources.len()];
    for chunk in &motions.chunks {
        seconds[chunk.recording] = chunk.period * chunk.stride as f64;
    }
    seconds
}

/// First and last time of each chunk, by recording (s).
pub fn spans(motions: &Motions) -> Vec<Vec<(f64, f64)>> {
    let mut spans: Vec<Vec<(f64, f64)>> = vec![Vec::new(); motions.sources.len()];
    for chunk in &motions.chunks {
        spans[chunk.recording].push((chunk.time(0), chunk.time(chunk.ticks() - 1)));
    }
    spans
}

/// The variance of the filtered torque's noise, and of the rigid torque's noise due to that of the positions.
pub fn noise(motions: &Motions, rigid: &[Rigid], fitted: &[bool]) -> Vec<f64> {
    (0..motions.dof)
        .map(|joint| {
            let mut largest = 0.0_f64;
            for (source, &fitted) in motions.sources.iter().zip(fitted) {
                if !fitted {
                    continue;
                }
                let mut variance = source.torque_noise[joint].powi(2);
                for by in 0..motions.dof {
                    let mass = mean(rigid.iter().flat_map(|r| &r.mass[joint][by]));
                    variance += (mass * source.acceleration_noise[by]).powi(2);
                }
                largest = largest.max(variance);
            }
            largest
        })
        .collect()
}
