//! Measurements on the recordings before any fit: scales, noise, the largest torques.

use arm::{Arm, Workspace};
use effects::Scales;
use nalgebra::DMatrix;

use crate::data::motion::{Chunk, Motions, SourceRecording};
use crate::data::rigid::Rigid;
use crate::data::statistics::{deviation, eliminate, mean, quantile_of_sorted};
use crate::thresholds::{
    DEAD, NEEDED_QUANTILE, NOISE_ALONE, RANGE_QUANTILES, REST, REST_NOISE, ROUNDING, SPEED_QUANTILE, TURNING,
    TURNING_NOISE,
};

/// The number of poses of a section at which the mass matrix is evaluated to judge the noise.
const POSES: usize = 10;

/// The largest measured torque of each joint in the training recordings (N m or N).
pub fn largest(motions: &Motions) -> Vec<f64> {
    let fitted = || motions.chunks.iter().filter(|chunk| is_fitted(motions, chunk));
    let torques = |joint: usize| fitted().flat_map(move |chunk| &chunk.tau[joint]);
    (0..motions.dof).map(|joint| torques(joint).fold(0.0_f64, |largest, tau| largest.max(tau.abs()))).collect()
}

/// The torque that each joint needs by the model, without the largest 0.1 % (N m or N).
pub fn needed(motions: &Motions, rigid: &[Rigid]) -> Vec<f64> {
    let needed = |joint: usize| {
        let mut needed: Vec<f64> =
            rigid.iter().flat_map(|rigid| rigid.tau[joint].iter().map(|tau| tau.abs())).collect();
        let at = (NEEDED_QUANTILE * needed.len() as f64) as usize;
        if needed.is_empty() { 0.0 } else { *needed.select_nth_unstable_by(at, f64::total_cmp).1 }
    };
    (0..motions.dof).map(needed).collect()
}

/// The standard deviation of the torque that accelerations need on each joint in the training recordings, after both filters,
/// over that of the measured torque; zero if there is no measured torque.
///
/// It is the larger of what the URDF's links need and what the drive's inertia explains of the measured torque: many URDFs omit the
/// inertias of the drives, which may be most of what a joint moves.
pub fn inertial(motions: &Motions, rigid: &[Rigid], torque: &[f64]) -> Vec<f64> {
    let share = |joint: usize| {
        if torque[joint] <= 0.0 {
            return 0.0;
        }
        let mut signals = Inertial::default();
        let chunks = motions.chunks.iter().zip(rigid);
        for (chunk, rigid) in chunks.filter(|(chunk, _)| is_fitted(motions, chunk)) {
            signals.add(joint, chunk, rigid);
        }
        deviation(signals.0[LINKS].iter()).max(signals.explained_by_acceleration()) / torque[joint]
    };
    (0..motions.dof).map(share).collect()
}

/// The number of signals of a joint in [`Inertial`].
const SIGNALS: usize = 10;
/// The torque that the URDF's links need for accelerations, the joint's own acceleration, and the measured torque; before them is what
/// else may explain the torque.
const LINKS: usize = SIGNALS - 3;
const OWN: usize = SIGNALS - 2;
const MEASURED: usize = SIGNALS - 1;
/// Signals of a joint on the rows of the training recordings.
#[derive(Default)]
struct Inertial([Vec<f64>; SIGNALS]);

impl Inertial {
    fn add(&mut self, joint: usize, chunk: &Chunk, rigid: &Rigid) {
        let (q, qd, qdd) = (&chunk.q[joint], &chunk.qd[joint], &chunk.qdd[joint]);
        let links = |tick: usize| -> f64 {
            let accelerations = rigid.mass[joint].iter().zip(&chunk.qdd);
            accelerations.map(|(mass, qdd)| mass[tick] * qdd[tick]).sum()
        };
        // In a slow or periodic motion, a wrong gravity torque resembles one of the accelerations.
        let signals: [&dyn Fn(usize) -> f64; SIGNALS] = [
            &|_| 1.0,
            &|tick| rigid.tau[joint][tick] - links(tick),
            &|tick| q[tick],
            &|tick| q[tick].sin(),
            &|tick| q[tick].cos(),
            &|tick| qd[tick],
            &|tick| qd[tick].signum(),
            &links,
            &|tick| qdd[tick],
            &|tick| chunk.tau[joint][tick],
        ];
        for (values, signal) in self.0.iter_mut().zip(signals) {
            values.extend(chunk.filter(&(0..chunk.ticks()).map(signal).collect::<Vec<f64>>()));
        }
    }

    /// The standard deviation of the measured torque that the accelerations of links and drive explain beside all other signals, with
    /// inertias that are not negative (N m or N).
    fn explained_by_acceleration(&self) -> f64 {
        let inner = |i: usize, k: usize| -> f64 { self.0[i].iter().zip(&self.0[k]).map(|(a, b)| a * b).sum() };
        let whole: [[f64; SIGNALS]; SIGNALS] = std::array::from_fn(|i| std::array::from_fn(|k| inner(i, k)));
        let mut residual = whole;
        for signal in 0..LINKS {
            eliminate(&mut residual, &whole, signal);
        }
        let before = residual[MEASURED][MEASURED];
        // Either alone, and both.
        let sets: [&[usize]; 3] = [&[LINKS], &[OWN], &[LINKS, OWN]];
        let explained = sets.map(|set| {
            let mut rest = residual;
            let mut is_positive = true;
            for &signal in set {
                is_positive &= rest[signal][MEASURED] >= 0.0;
                eliminate(&mut rest, &whole, signal);
            }
            if is_positive { before - rest[MEASURED][MEASURED] } else { 0.0 }
        });
        let most = explained.into_iter().fold(0.0, f64::max);
        (most / self.0[MEASURED].len().max(1) as f64).sqrt()
    }
}

/// The standard deviation of each joint's measured torque in the training recordings (N m or N).
pub fn deviations(motions: &Motions) -> Vec<f64> {
    let chunks = || motions.chunks.iter().filter(|chunk| is_fitted(motions, chunk));
    (0..motions.dof).map(|joint| deviation(chunks().flat_map(move |chunk| &chunk.tau[joint]))).collect()
}

/// The largest part of the torque of a joint that `moves` that the noise of the positions causes through the mass matrix, and the joint.
pub fn noise_share(motions: &Motions, arm: &Arm, moves: &[bool]) -> (f64, usize) {
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
        if torque[joint] <= 0.0 || !moves[joint] {
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

/// The joints with dead channels: their `torque` does not vary while the model's does, apart from noise, or varies by rounding alone.
pub fn dead(motions: &Motions, rigid: &[Rigid], torque: &[f64]) -> Vec<usize> {
    let fitted = || {
        let chunks = motions.chunks.iter().zip(rigid);
        chunks.filter(|(chunk, _)| is_fitted(motions, chunk))
    };
    let largest = torque.iter().copied().fold(0.0, f64::max);
    let is_dead = |&joint: &usize| {
        if torque[joint] <= ROUNDING * largest {
            return true;
        }
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
        turning: Vec::new(),
        middle: Vec::new(),
        range: Vec::new(),
        swept: Vec::new(),
        torque,
    };
    for joint in 0..motions.dof {
        let speeds = sorted(&|chunk| chunk.qd[joint].iter().map(|v| v.abs()).collect());
        let positions = sorted(&|chunk| chunk.q[joint].clone());
        let speed = quantile_of_sorted(&speeds, SPEED_QUANTILE);
        let noise = motions.sources.iter().map(|source| source.velocity_noise[joint]).fold(0.0, f64::max);
        scales.speed.push(speed);
        scales.rest.push((REST * speed).max(REST_NOISE * noise).max(1e-6));
        scales.turning.push((TURNING * speed).max(TURNING_NOISE * noise).max(1e-7));
        let (low, high) =
            (quantile_of_sorted(&positions, RANGE_QUANTILES.0), quantile_of_sorted(&positions, RANGE_QUANTILES.1));
        scales.middle.push(0.5 * (low + high));
        scales.range.push((high - low).max(1e-6));
        scales.swept.push(swept(motions, joint, scales.rest[joint]));
    }
    scales
}

/// The difference of the highest and the lowest position of a joint in the training recordings while it is faster than `rest` (rad or m).
fn swept(motions: &Motions, joint: usize, rest: f64) -> f64 {
    let fitted = motions.chunks.iter().filter(|chunk| is_fitted(motions, chunk));
    let ends = fitted
        .flat_map(|chunk| chunk.q[joint].iter().zip(&chunk.qd[joint]))
        .filter(|(_, qd)| qd.abs() > rest)
        .fold(None, |ends: Option<(f64, f64)>, (&q, _)| {
            Some(ends.map_or((q, q), |(low, high)| (low.min(q), high.max(q))))
        });
    ends.map_or(0.0, |(low, high)| high - low)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Signals of a joint with the inertia `links` in the URDF, where the measured torque is a function of q, q̇ and q̈, in three sines of
    /// these frequencies (Hz).
    fn signals(links: f64, hertz: [f64; 3], torque: impl Fn(f64, f64, f64) -> f64) -> Inertial {
        let mut signals = Inertial::default();
        for k in 0..2000 {
            let time = 0.02 * f64::from(k);
            let [mut q, mut qd, mut qdd] = [0.4, 0.0, 0.0];
            for (turn, hertz) in hertz.into_iter().enumerate() {
                let omega = std::f64::consts::TAU * hertz;
                let (sin, cos) = (omega * time + turn as f64).sin_cos();
                q += 0.3 * sin;
                qd += 0.3 * omega * cos;
                qdd -= 0.3 * omega * omega * sin;
            }
            let row = [1.0, 10.0 * q.sin(), q, q.sin(), q.cos(), qd, qd.signum(), links * qdd, qdd, torque(q, qd, qdd)];
            signals.0.iter_mut().zip(row).for_each(|(values, value)| values.push(value));
        }
        signals
    }

    /// The links need nothing, and the drive needs all.
    #[test]
    fn the_inertia_of_a_drive_is_seen_where_the_links_have_none() {
        for links in [0.0, 1e-6] {
            let signals = signals(links, [0.3, 0.5, 0.8], |_, qd, qdd| 0.2 * qdd + 0.1 * qd + 0.05 * qd.signum());
            let truth = 0.2 * deviation(signals.0[OWN].iter());
            let found = signals.explained_by_acceleration();
            // The position resembles the acceleration, so that a part of it may be either.
            assert!((0.5..1.0).contains(&(found / truth)), "{links}: {found} of {truth}");
        }
    }

    /// A gravity torque of 3 N m that the URDF does not have, in a slow motion, is not the torque of an acceleration.
    #[test]
    fn a_wrong_gravity_torque_is_no_inertia() {
        for hertz in [[0.1, 0.1, 0.1], [0.05, 0.09, 0.13]] {
            let signals = signals(0.3, hertz, |q, _, qdd| 10.0 * q.sin() + 3.0 * q.cos() + 0.3 * qdd);
            let needed = 0.3 * deviation(signals.0[OWN].iter());
            let found = signals.explained_by_acceleration();
            assert!(found <= needed * 1.001, "{hertz:?}: {found} of {needed}");
        }
        // An inertia is not negative.
        let signals = signals(0.3, [0.3, 0.5, 0.8], |_, _, qdd| -0.3 * qdd);
        assert_eq!(signals.explained_by_acceleration(), 0.0);
    }
}
