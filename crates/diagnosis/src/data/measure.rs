//! What is measured of the recordings before anything is fitted: scales, noise, sizes to try.

use arm::{Inertia, Matrix3, Vector3};

use crate::data::motion::{Chunk, Motions};
use crate::data::rigid::Rigid;
use crate::regression::columns::Scales;
use crate::regression::term::Term;
use crate::search::candidate::{Cause, GAPS, STOP_RATIOS};
use crate::thresholds;

/// A torque limit is at least this part of what the motion needs, by a model that may be wrong.
const BELOW_NEED: f64 = 0.7;

/// Where the ends of a gap may swing against the link, before they are refined (Hz).
const STOP_FREQUENCY: f64 = 20.0;

/// A torque that varies by less than this part of what the model needs …
const DEAD: f64 = 0.05;
/// … and by no more than so many times its noise behind both filters is a dead channel.
const NOISE_ALONE: f64 = 4.0;

/// The body of ten inertial parameters about a frame's origin; possible or not.
pub fn inertia(parameters: &[f64; 10]) -> Inertia {
    let [mass, hx, hy, hz, xx, xy, yy, xz, yz, zz] = *parameters;
    let com = Vector3::new(hx, hy, hz) / mass;
    let about_origin = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    Inertia {
        mass,
        com,
        tensor: about_origin - mass * (Matrix3::identity() * com.norm_squared() - com * com.transpose()),
    }
}

/// The mean; zero of nothing.
pub fn mean<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value;
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Elasticities by their resonance, gaps with sprung ends, and torque limits by the largest torque.
pub fn drives(
    joint: usize,
    mass: f64,
    scales: &Scales,
    motions: &Motions,
    rigid: &[Rigid],
) -> Vec<(Cause, Option<usize>, Vec<Term>)> {
    let mut list = Vec::new();
    if scales.speed[joint] <= scales.rest[joint] {
        return list;
    }
    if mass > 0.0 {
        for hertz in [2.5, 3.5, 5.0, 7.0, 10.0, 14.0, 20.0, 28.0] {
            let omega = 2.0 * std::f64::consts::PI * hertz;
            let elastic = Term::Elastic {
                joint,
                stiffness: mass * omega * omega,
                damping: 2.0 * thresholds::DAMPING_RATIO * mass * omega,
            };
            list.push((Cause::Elasticity, Some(joint), vec![elastic, Term::Acceleration(joint)]));
        }
        for (share, ratio) in GAPS.iter().flat_map(|&share| STOP_RATIOS.map(|ratio| (share, ratio))) {
            let gap = Term::Gap {
                joint,
                halfgap: share * scales.range[joint].min(1.5),
                stop: mass * (2.0 * std::f64::consts::PI * STOP_FREQUENCY).powi(2),
                ratio,
            };
            list.push((Cause::Backlash, Some(joint), vec![gap, Term::Acceleration(joint)]));
        }
    }
    let largest = motions
        .chunks
        .iter()
        .flat_map(|chunk| &chunk.tau[joint])
        .fold(0.0_f64, |largest, tau| largest.max(tau.abs()));
    // A drive that moved or held the arm against this torque is not limited far below it.
    let mut needed: Vec<f64> = rigid
        .iter()
        .flat_map(|rigid| rigid.tau[joint].iter().map(|tau| tau.abs()))
        .collect();
    let at = (0.999 * needed.len() as f64) as usize;
    let needed = if needed.is_empty() {
        0.0
    } else {
        *needed.select_nth_unstable_by(at, f64::total_cmp).1
    };
    // A position loop may ask for many times what the drive can give.
    let wound_up = [0.027, 0.036, 0.048, 0.064, 0.085, 0.11, 0.15];
    let usual = [0.2, 0.27, 0.36, 0.45, 0.55, 0.65, 0.73, 0.8, 0.86, 0.91, 0.95];
    for share in wound_up.into_iter().chain(usual) {
        let limit = share * largest;
        if limit < BELOW_NEED * needed {
            continue;
        }
        list.push((Cause::Saturation, Some(joint), vec![Term::Excess { joint, limit }]));
    }
    list
}

/// The standard deviation of each joint's measured torque in the recordings to be fitted (N m or N).
pub fn deviations(motions: &Motions) -> Vec<f64> {
    let chunks = || motions.chunks.iter().filter(|chunk| is_fitted(motions, chunk));
    (0..motions.dof)
        .map(|joint| deviation(&|| chunks().flat_map(move |chunk| &chunk.tau[joint])))
        .collect()
}

/// The joints whose `torque` does not vary as the model's does: a dead channel, whatever noise it has.
pub fn dead(motions: &Motions, rigid: &[Rigid], torque: &[f64]) -> Vec<usize> {
    let fitted = || {
        let chunks = motions.chunks.iter().zip(rigid);
        chunks.filter(|(chunk, _)| is_fitted(motions, chunk))
    };
    let is_dead = |&joint: &usize| {
        let needed = deviation(&|| fitted().flat_map(move |(_, rigid)| &rigid.tau[joint]));
        let noise = motions.sources.iter().map(|source| source.torque_noise[joint]);
        let noise = noise.fold(0.0, f64::max);
        torque[joint] <= (NOISE_ALONE * noise).max(1e-9 * needed) && torque[joint] <= DEAD * needed
    };
    (0..motions.dof).filter(is_dead).collect()
}

fn is_fitted(motions: &Motions, chunk: &Chunk) -> bool {
    !motions.sources[chunk.recording].held_out
}

fn deviation<'a, I: Iterator<Item = &'a f64>>(values: &dyn Fn() -> I) -> f64 {
    let middle = mean(values());
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for value in values() {
        sum += (value - middle).powi(2);
        count += 1.0;
    }
    (sum / count.max(1.0)).sqrt()
}

/// Speeds and ranges of all joints, with their torques.
pub fn scales(motions: &Motions, torque: Vec<f64>) -> Scales {
    let sorted = |pick: &dyn Fn(&Chunk) -> Vec<f64>| -> Vec<f64> {
        let mut values: Vec<f64> = motions.chunks.iter().flat_map(pick).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let quantile = |sorted: &[f64], share: f64| -> f64 {
        let last = sorted.len().saturating_sub(1);
        sorted
            .get((share * last as f64).round() as usize)
            .copied()
            .unwrap_or(0.0)
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
        let speed = quantile(&speeds, 0.99);
        let noise = motions
            .sources
            .iter()
            .map(|source| source.velocity_noise[joint])
            .fold(0.0, f64::max);
        scales.speed.push(speed);
        scales.rest.push((thresholds::REST * speed).max(6.0 * noise).max(1e-6));
        let (low, high) = (quantile(&positions, 0.002), quantile(&positions, 0.998));
        scales.middle.push(0.5 * (low + high));
        scales.range.push((high - low).max(1e-6));
    }
    scales
}

/// From row to row of each recording (s).
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

/// The variance of the filtered torque's noise and of the rigid torque's, by the positions' noise.
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
