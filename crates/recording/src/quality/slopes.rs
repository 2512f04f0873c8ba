//! The velocity from slopes of the positions.

use crate::Segment;

/// The duration over which a slope is computed (s), if the clock is fast enough.
const SPAN: f64 = 0.008;

/// The velocity of a joint from slopes of its positions.
pub struct Slopes {
    /// The slopes, at every tick with enough neighbours; 0 elsewhere.
    pub speed: Vec<f64>,
    /// The number of neighbours on either side.
    pub side: usize,
    /// The ratio of the noise of the slope (rad/s) to that of the position (rad), in 1/s.
    pub gain: f64,
}

impl Slopes {
    /// The slopes of `q` over a few milliseconds.
    pub fn of(q: &[f64], segments: &[Segment], period: f64) -> Self {
        let side = ((SPAN / period).round() as usize).clamp(1, 16);
        let squares: f64 = 2.0 * (1..=side).map(|k| (k * k) as f64).sum::<f64>();
        let mut speed = vec![0.0; q.len()];
        for segment in segments {
            for k in segment.ticks.start + side..segment.ticks.end.saturating_sub(side) {
                let rise: f64 = (1..=side).map(|away| away as f64 * (q[k + away] - q[k - away])).sum();
                speed[k] = rise / (squares * period);
            }
        }
        Self { speed, side, gain: 1.0 / (squares.sqrt() * period) }
    }
}
