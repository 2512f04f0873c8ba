//! Smoothed motion and torque at a few hundred instants, by local parabolas.

use recording::RegularRecording;

use super::thresholds::{DIRECTION_UNCERTAIN, MOVES};
use super::turns::range;

/// Half the span of a parabola (s).
const HALF_SPAN: f64 = 0.04;
/// The number of instants.
const INSTANTS: usize = 800;

/// Motion and torque at instants, `signal[joint][instant]`; the joints are in the requested order.
pub struct Smooth {
    pub q: Vec<Vec<f64>>,
    pub qd: Vec<Vec<f64>>,
    pub qdd: Vec<Vec<f64>>,
    pub tau: Vec<Vec<f64>>,
    /// Dry friction of unit size: the sign of the velocity, smooth about zero.
    pub dry: Vec<Vec<f64>>,
}

/// The sign of the `speeds`, smooth below a part of the largest one.
fn dry(speeds: &[f64]) -> Vec<f64> {
    let top = speeds.iter().fold(1e-9_f64, |top, speed| top.max(speed.abs()));
    speeds.iter().map(|speed| (speed / (DIRECTION_UNCERTAIN * top)).tanh()).collect()
}

/// Weights of a least-squares parabola over 2 `side` + 1 ticks: value, slope (1/s) and bend (1/s²).
struct Parabola {
    side: usize,
    value: Vec<f64>,
    slope: Vec<f64>,
    bend: Vec<f64>,
}

impl Parabola {
    fn new(side: usize, period: f64) -> Self {
        let places = || (0..=2 * side).map(|k| k as f64 - side as f64);
        let count = (2 * side + 1) as f64;
        let second: f64 = places().map(|x| x * x).sum();
        let fourth: f64 = places().map(|x| x.powi(4)).sum();
        let determinant = count * fourth - second * second;
        Self {
            side,
            value: places().map(|x| (fourth - x * x * second) / determinant).collect(),
            slope: places().map(|x| x / (second * period)).collect(),
            bend: places().map(|x| 2.0 * (count * x * x - second) / (determinant * period * period)).collect(),
        }
    }

    fn at(&self, weights: &[f64], values: &[f64], tick: usize) -> f64 {
        let window = &values[tick - self.side..=tick + self.side];
        weights.iter().zip(window).map(|(weight, value)| weight * value).sum()
    }
}

impl Smooth {
    /// The recording's `joints` at evenly spread instants.
    pub fn of(regular: &RegularRecording, joints: &[usize]) -> Self {
        let side = ((HALF_SPAN / regular.period).round() as usize).max(2);
        let parabola = Parabola::new(side, regular.period);
        let inner = regular
            .segments
            .iter()
            .flat_map(|segment| segment.ticks.start + side..segment.ticks.end.saturating_sub(side));
        let ticks: Vec<usize> = inner.collect();
        let stride = (ticks.len() / INSTANTS).max(1);
        let sample = |weights: &[f64], signal: &recording::Signal| -> Vec<Vec<f64>> {
            let of = |joint: &usize| {
                let values = &signal[*joint];
                ticks.iter().step_by(stride).map(|&tick| parabola.at(weights, values, tick)).collect()
            };
            joints.iter().map(of).collect()
        };
        let qd = sample(&parabola.slope, &regular.q);
        Self {
            q: sample(&parabola.value, &regular.q),
            dry: qd.iter().map(|speeds| dry(speeds)).collect(),
            qd,
            qdd: sample(&parabola.bend, &regular.q),
            tau: sample(&parabola.value, &regular.tau),
        }
    }

    /// Whether each joint moves by more than [`MOVES`].
    pub fn moves(&self) -> Vec<bool> {
        let moves = |q: &Vec<f64>| {
            let (low, high) = range(q);
            high - low > MOVES
        };
        self.q.iter().map(moves).collect()
    }

    /// The number of instants.
    pub fn len(&self) -> usize {
        self.tau.first().map_or(0, Vec::len)
    }
}
