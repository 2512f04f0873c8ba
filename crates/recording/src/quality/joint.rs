//! The quality of the signals of one joint.

use serde::Serialize;

use super::measures;
use super::slopes::Slopes;
use crate::statistics::quantile;
use crate::{Recording, RegularRecording};

/// The smallest range of a motion (rad or m).
const LEAST_RANGE: f64 = 1e-3;

/// The quality of one joint's signals.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointQuality {
    /// The joint.
    pub joint: String,
    /// Smallest and largest position (rad or m).
    pub q_range: (f64, f64),
    /// Largest speed, by the positions (rad/s or m/s).
    pub speed_max: f64,
    /// Smallest and largest torque (N m or N).
    pub tau_range: (f64, f64),
    /// Standard deviation of the torque (N m or N).
    pub tau_deviation: f64,
    /// The encoder's step (rad or m), where the positions are multiples of one.
    pub q_step: Option<f64>,
    /// The torque's step (N m or N), where the torques are multiples of one.
    pub tau_step: Option<f64>,
    /// White noise of the position, standard deviation (rad or m).
    pub q_noise: f64,
    /// White noise of the recorded velocity, standard deviation (rad/s or m/s).
    pub qd_noise: Option<f64>,
    /// White noise of the torque, standard deviation (N m or N).
    pub tau_noise: f64,
    /// The delay of the recorded velocity relative to the positions' slope (s).
    pub velocity_lag: Option<f64>,
    /// The ratio of the recorded velocity to the positions' slope: 1 if they agree.
    pub velocity_ratio: Option<f64>,
    /// The correlation of the two at that lag.
    pub velocity_correlation: Option<f64>,
    /// Whether the joint moves.
    pub moves: bool,
    /// The share of the time in which it moves.
    pub moving_share: f64,
    /// The number of reversals of its direction.
    pub reversals: usize,
    /// Torque plateaus, low and high: the value (N m or N) and the share of the time at that value.
    pub plateaus: [Option<(f64, f64)>; 2],
}

impl JointQuality {
    /// The quality of `joint` with the velocity `motion`; the recorded velocity is evaluated elsewhere.
    pub(super) fn of(recording: &Recording, regular: &RegularRecording, joint: usize, motion: &Slopes) -> Self {
        let (q, tau) = (&regular.q[joint], &regular.tau[joint]);
        let (low, high) = measures::range(q);
        // Interpolated values are not multiples of the quantiser's step.
        let q_step = measures::step(&recording.q[joint]);
        let tau_step = measures::step(&recording.tau[joint]);
        let q_noise = measures::noise(q, &regular.segments);
        let mut speeds: Vec<f64> =
            measures::inner(&regular.segments, motion.side).map(|tick| motion.speed[tick].abs()).collect();
        let speed_max = quantile(&mut speeds, 1.0);
        let unsure = motion.gain * q_noise.max(q_step.unwrap_or(0.0) / 12.0_f64.sqrt());
        let range = high - low;
        let wide = range > LEAST_RANGE.max(10.0 * q_noise).max(20.0 * q_step.unwrap_or(0.0));
        let moves = wide && (speed_max > 6.0 * unsure || range > 50.0 * q_noise);
        let slow = (0.01 * speed_max).max(4.0 * unsure);
        let moving = speeds.iter().filter(|&&speed| speed > slow).count();
        let mean = tau.iter().sum::<f64>() / tau.len().max(1) as f64;
        let variance = tau.iter().map(|tau| (tau - mean).powi(2)).sum::<f64>() / tau.len().max(1) as f64;
        Self {
            joint: regular.joints[joint].clone(),
            q_range: (low, high),
            speed_max,
            tau_range: measures::range(tau),
            tau_deviation: variance.sqrt(),
            q_step,
            tau_step,
            q_noise,
            qd_noise: None,
            tau_noise: measures::noise(tau, &regular.segments),
            velocity_lag: None,
            velocity_ratio: None,
            velocity_correlation: None,
            moves,
            moving_share: if moves { moving as f64 / speeds.len().max(1) as f64 } else { 0.0 },
            reversals: if moves { reversals(&motion.speed, slow) } else { 0 },
            plateaus: measures::plateaus(tau, &regular.segments, tau_step),
        }
    }
}

/// The number of sign changes between velocities beyond `slow`.
fn reversals(speed: &[f64], slow: f64) -> usize {
    let mut direction = 0.0;
    let mut count = 0;
    for speed in speed.iter().filter(|speed| speed.abs() > slow) {
        if direction != 0.0 && speed.signum() != direction {
            count += 1;
        }
        direction = speed.signum();
    }
    count
}
