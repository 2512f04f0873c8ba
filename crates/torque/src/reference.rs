//! The reference motion: a recorded one, sines, or the sum of both, optionally with a fade-in and a fade-out.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::motion::Motion;
use crate::trajectory::Trajectory;

/// One sine of every joint: amplitude sin(2π frequency t + phase).
#[derive(Clone, Debug, PartialEq)]
pub struct Sine {
    /// rad or m.
    pub amplitude: Vec<f64>,
    /// Hz.
    pub frequency: Vec<f64>,
    /// rad.
    pub phase: Vec<f64>,
}

/// A fade-in from rest at the start, and a fade-out to rest at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fade {
    /// The duration of the fade-in and of the fade-out (s).
    pub seconds: f64,
    /// The time at which the motion has ended (s).
    pub end: f64,
}

/// q(t) = centre + (recorded(t) − recorded(0)) + Σ sines, one entry per joint. If the motion fades, what is added to the centre is
/// multiplied by a factor that rises from 0 to 1 and returns to 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// The centres (rad or m).
    pub centre: Vec<f64>,
    /// A recorded motion of all joints.
    pub recorded: Option<Arc<Trajectory>>,
    /// The sines.
    pub sines: Vec<Sine>,
    /// The fade-in and fade-out; `None` starts and ends in full motion.
    pub fade: Option<Fade>,
}

impl Reference {
    /// Writes the motion at `time` (s) to `motion`.
    pub fn at(&self, time: f64, motion: &mut Motion) {
        motion.q.copy_from_slice(&self.centre);
        motion.qd.fill(0.0);
        motion.qdd.fill(0.0);
        if let Some(recorded) = &self.recorded {
            recorded.add_to(time, motion);
        }
        for sine in &self.sines {
            for joint in 0..self.centre.len() {
                let omega = TAU * sine.frequency[joint];
                let (sin, cos) = (omega * time + sine.phase[joint]).sin_cos();
                let amplitude = sine.amplitude[joint];
                motion.q[joint] += amplitude * sin;
                motion.qd[joint] += amplitude * omega * cos;
                motion.qdd[joint] -= amplitude * omega * omega * sin;
            }
        }
        let Some(fade) = self.fade else { return };
        let [e, ed, edd] = fade.factor(time);
        for (joint, centre) in self.centre.iter().enumerate() {
            let (s, sd, sdd) = (motion.q[joint] - centre, motion.qd[joint], motion.qdd[joint]);
            motion.q[joint] = centre + e * s;
            motion.qd[joint] = ed * s + e * sd;
            motion.qdd[joint] = edd * s + 2.0 * ed * sd + e * sdd;
        }
    }
}

impl Fade {
    /// The factor at `time` with its first two derivatives (1, 1/s, 1/s²): x³ (10 − 15 x + 6 x²), with zero velocity
    /// and acceleration on both sides.
    fn factor(&self, time: f64) -> [f64; 3] {
        let (x, sense) =
            if time < 0.5 * self.end { (time / self.seconds, 1.0) } else { ((self.end - time) / self.seconds, -1.0) };
        if x >= 1.0 {
            return [1.0, 0.0, 0.0];
        }
        let x = x.max(0.0);
        let slope = 30.0 * x * x * (1.0 - x) * (1.0 - x);
        let curvature = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x);
        [
            x * x * x * (10.0 + x * (6.0 * x - 15.0)),
            sense * slope / self.seconds,
            curvature / (self.seconds * self.seconds),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Velocity and acceleration are the derivatives of position; fails if a factor ω is missing.
    #[test]
    fn derivatives_agree_with_differences() {
        let reference = Reference {
            centre: vec![0.3],
            recorded: None,
            sines: vec![
                Sine { amplitude: vec![0.8], frequency: vec![0.22], phase: vec![0.4] },
                Sine { amplitude: vec![0.2], frequency: vec![1.1], phase: vec![-1.0] },
            ],
            fade: Some(Fade { seconds: 1.0, end: 5.0 }),
        };
        let at = |t: f64| {
            let mut motion = Motion::new(1);
            reference.at(t, &mut motion);
            motion
        };
        let h = 1e-4;
        for t in [0.0, 0.4, 0.7, 3.1, 4.2, 4.9] {
            let (before, here, after) = (at(t - h), at(t), at(t + h));
            assert!(((after.q[0] - before.q[0]) / (2.0 * h) - here.qd[0]).abs() < 1e-6);
            assert!(((after.qd[0] - before.qd[0]) / (2.0 * h) - here.qdd[0]).abs() < 2e-3);
        }
        for t in [0.0, 5.0, 6.0] {
            assert_eq!((at(t).q[0], at(t).qd[0], at(t).qdd[0]), (0.3, 0.0, 0.0));
        }
    }
}
