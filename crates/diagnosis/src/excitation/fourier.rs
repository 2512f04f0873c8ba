//! A finite Fourier series per joint, at rest where it begins and ends, as a function of dimensionless coefficients.

use std::f64::consts::TAU;

use torque::{Reference, Sine};

use super::bounds::Allowed;

/// The motions in the search space: q = middle + room (c + Σ (a sin kωt + b cos kωt) / k), k from 1 to `harmonics`.
///
/// The coefficients of a joint are c, then all a, then all b. [`Self::project`]ed coefficients satisfy Σ a = 0 and Σ k b = 0,
/// so that velocity and acceleration are zero at the time 0 and at every multiple of the period.
#[derive(Clone, Debug)]
pub struct Series {
    middle: Vec<f64>,
    room: Vec<f64>,
    /// The number of harmonics.
    pub harmonics: usize,
    /// The period (s).
    pub period: f64,
}

impl Series {
    /// The allowed motion; the series are about its middle.
    pub fn new(allowed: &Allowed, harmonics: usize, period: f64) -> Self {
        Self { middle: allowed.middle.clone(), room: allowed.room.clone(), harmonics, period }
    }

    /// The number of joints.
    pub fn dof(&self) -> usize {
        self.middle.len()
    }

    /// The number of coefficients.
    pub fn len(&self) -> usize {
        self.dof() * self.per_joint()
    }

    fn per_joint(&self) -> usize {
        1 + 2 * self.harmonics
    }

    /// The nearest coefficients of a motion that is at rest at its ends.
    pub fn project(&self, coefficients: &mut [f64]) {
        let harmonics = self.harmonics;
        let weights: f64 = (1..=harmonics).map(|k| (k * k) as f64).sum();
        for joint in coefficients.chunks_exact_mut(self.per_joint()) {
            let (sines, cosines) = joint[1..].split_at_mut(harmonics);
            let mean = sines.iter().sum::<f64>() / harmonics as f64;
            sines.iter_mut().for_each(|a| *a -= mean);
            let moment = (1..).zip(cosines.iter()).map(|(k, b)| f64::from(k) * b).sum::<f64>() / weights;
            (1..).zip(cosines.iter_mut()).for_each(|(k, b)| *b -= f64::from(k) * moment);
        }
    }

    /// Makes a start of the search from random numbers: about `centre`, relative to the room, at rest at its ends.
    pub fn start(&self, coefficients: &mut [f64], centre: &[f64]) {
        for (joint, centre) in coefficients.chunks_exact_mut(self.per_joint()).zip(centre) {
            joint[0] = *centre;
        }
        self.project(coefficients);
    }

    /// The centre of a joint's motion (rad or m).
    pub fn centre(&self, coefficients: &[f64], joint: usize) -> f64 {
        self.middle[joint] + self.room[joint] * coefficients[joint * self.per_joint()]
    }

    /// Scales a joint's motion about its centre. A centre beyond the limits is moved within them first.
    pub fn shrink(&self, coefficients: &mut [f64], joint: usize, factor: f64) {
        let own = &mut coefficients[joint * self.per_joint()..(joint + 1) * self.per_joint()];
        own[0] = own[0].clamp(-0.95, 0.95);
        let factor = if factor > 0.0 { factor } else { 0.9 };
        own[1..].iter_mut().for_each(|value| *value *= factor);
    }

    /// The motion as sines, one frequency each.
    pub fn reference(&self, coefficients: &[f64]) -> Reference {
        let dof = self.dof();
        let sine = |k: usize| {
            let pairs = (0..dof).map(|joint| {
                let own = &coefficients[joint * self.per_joint() + 1..];
                let scale = self.room[joint] / k as f64;
                (scale * own[k - 1], scale * own[self.harmonics + k - 1])
            });
            let (amplitude, phase) = pairs.map(|(a, b)| (a.hypot(b), b.atan2(a))).unzip();
            Sine { amplitude, frequency: vec![k as f64 / self.period; dof], phase }
        };
        Reference {
            centre: (0..dof).map(|joint| self.centre(coefficients, joint)).collect(),
            recorded: None,
            sines: (1..=self.harmonics).map(sine).collect(),
            fade: None,
        }
    }

    /// The factors of a joint's coefficients in its position, velocity and acceleration at `time` (s): [`Self::len`] over the joints
    /// each, per unit of room.
    pub fn factors(&self, time: f64) -> [Vec<f64>; 3] {
        let mut factors = [1.0, 0.0, 0.0].map(|centre| {
            let mut list = vec![0.0; self.per_joint()];
            list[0] = centre;
            list
        });
        for k in 1..=self.harmonics {
            let omega = TAU * k as f64 / self.period;
            let (sin, cos) = (omega * time).sin_cos();
            let own = [(sin, cos), (omega * cos, -omega * sin), (-omega * omega * sin, -omega * omega * cos)];
            for (list, (a, b)) in factors.iter_mut().zip(own) {
                list[k] = a / k as f64;
                list[self.harmonics + k] = b / k as f64;
            }
        }
        factors
    }

    /// The values at one time, by [`Self::factors`] (rad or m, and per s).
    pub fn at(&self, coefficients: &[f64], factors: &[Vec<f64>; 3]) -> [Vec<f64>; 3] {
        let own = |joint: usize| &coefficients[joint * self.per_joint()..(joint + 1) * self.per_joint()];
        let sum = |list: &[f64], joint: usize| -> f64 {
            let value: f64 = list.iter().zip(own(joint)).map(|(factor, value)| factor * value).sum();
            self.room[joint] * value
        };
        let mut signals = [0, 1, 2]
            .map(|order: usize| -> Vec<f64> { (0..self.dof()).map(|joint| sum(&factors[order], joint)).collect() });
        for (q, middle) in signals[0].iter_mut().zip(&self.middle) {
            *q += middle;
        }
        signals
    }

    /// Adds to the gradient with respect to the coefficients the part from the gradients with respect to q, q̇ and q̈ at one
    /// time.
    pub fn add_gradient(&self, gradient: &mut [f64], by: &[Vec<f64>; 3], factors: &[Vec<f64>; 3]) {
        for (joint, own) in gradient.chunks_exact_mut(self.per_joint()).enumerate() {
            for (by, factors) in by.iter().zip(factors) {
                let by = self.room[joint] * by[joint];
                for (gradient, factor) in own.iter_mut().zip(factors) {
                    *gradient += by * factor;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use torque::Motion;

    use super::*;

    fn series() -> Series {
        Series { middle: vec![0.3, -1.0], room: vec![2.0, 0.5], harmonics: 5, period: 10.0 }
    }

    /// The reference is the series, is at rest at the ends of its period, and repeats; its factors give the same motion.
    #[test]
    fn a_projected_series_rests_at_its_ends() {
        let series = series();
        let mut coefficients: Vec<f64> = (0..series.len()).map(|k| (1.7 * k as f64).sin()).collect();
        series.project(&mut coefficients);
        let reference = series.reference(&coefficients);
        let at = |time: f64| {
            let mut motion = Motion::new(2);
            reference.at(time, &mut motion);
            motion
        };
        for time in [0.0, 10.0, 20.0] {
            let motion = at(time);
            for joint in 0..2 {
                assert!(motion.qd[joint].abs() < 1e-12 && motion.qdd[joint].abs() < 1e-12, "{motion:?}");
                assert!((motion.q[joint] - at(0.0).q[joint]).abs() < 1e-12);
            }
        }
        for time in [0.1, 3.7, 8.2] {
            let (motion, [q, qd, qdd]) = (at(time), series.at(&coefficients, &series.factors(time)));
            for joint in 0..2 {
                assert!((motion.q[joint] - q[joint]).abs() < 1e-12);
                assert!((motion.qd[joint] - qd[joint]).abs() < 1e-12);
                assert!((motion.qdd[joint] - qdd[joint]).abs() < 1e-12);
            }
        }
    }
}
