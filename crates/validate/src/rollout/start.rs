//! The measured state at the start of a window, by a local cubic.

use super::Course;

/// Half the span of the cubic (s).
const HALF_SPAN: f64 = 0.04;
/// The rate at which a guided joint returns to its recorded path (rad/s).
const GUIDING_RATE: f64 = 50.0;

/// The number of ticks on either side of the start that the cubic uses.
pub(super) fn side(period: f64) -> usize {
    ((HALF_SPAN / period).round() as usize).max(4)
}

/// A state of the robot, one entry per joint, as the encoders report it.
pub(super) struct Start {
    pub(super) tick: usize,
    pub(super) q: Vec<f64>,
    pub(super) qd: Vec<f64>,
    pub(super) qdd: Vec<f64>,
    /// Measured torque, smoothed (N m or N).
    pub(super) tau: Vec<f64>,
}

impl Start {
    /// The state at `tick`, which has `side` ticks of its segment on either side.
    pub(super) fn measured(course: &Course<'_>, tick: usize, side: usize) -> Self {
        let recording = course.recording;
        let of = |signal: &[Vec<f64>]| -> Vec<[f64; 3]> {
            let window = |&column: &usize| cubic(&signal[column][tick - side..=tick + side], recording.period);
            course.columns.iter().map(window).collect()
        };
        let motion = of(&recording.q);
        Self {
            tick,
            q: motion.iter().map(|m| m[0]).collect(),
            qd: motion.iter().map(|m| m[1]).collect(),
            qdd: motion.iter().map(|m| m[2]).collect(),
            tau: of(&recording.tau).iter().map(|m| m[0]).collect(),
        }
    }
}

/// The torque that keeps joint `j` of `inertia` on its recorded path, `into` seconds after `tick`, at `q` and `qd` (rad, rad/s).
pub(super) fn guiding_torque(
    course: &Course<'_>,
    j: usize,
    tick: usize,
    into: f64,
    (q, qd): (f64, f64),
    inertia: f64,
) -> f64 {
    let recording = course.recording;
    let side = side(recording.period);
    let inside = recording.segments.iter().find(|segment| segment.ticks.contains(&tick));
    let ticks = inside.map_or(0..recording.q[0].len(), |segment| segment.ticks.clone());
    // Near the end of its segment, the last cubic is continued.
    let middle = tick.clamp(ticks.start + side, ticks.end - 1 - side);
    let [place, slope, bend] = cubic(&recording.q[course.columns[j]][middle - side..=middle + side], recording.period);
    let time = (tick as f64 - middle as f64) * recording.period + into;
    let (wanted, rate) = (place + time * (slope + 0.5 * time * bend), slope + time * bend);
    inertia * (bend + 2.0 * GUIDING_RATE * (rate - qd) + GUIDING_RATE * GUIDING_RATE * (wanted - q))
}

/// Value, slope and second derivative at the middle of equidistant values (an odd number), from a cubic least-squares fit.
fn cubic(values: &[f64], period: f64) -> [f64; 3] {
    let side = (values.len() / 2) as f64;
    let places = || (0..values.len()).map(|k| k as f64 - side);
    let moment = |power: i32| -> f64 { places().map(|x| x.powi(power)).sum() };
    let against = |power: i32| -> f64 { places().zip(values).map(|(x, y)| x.powi(power) * y).sum() };
    let (m0, m2, m4, m6) = (moment(0), moment(2), moment(4), moment(6));
    let even = m0 * m4 - m2 * m2;
    let odd = m2 * m6 - m4 * m4;
    [
        (m4 * against(0) - m2 * against(2)) / even,
        (m6 * against(1) - m4 * against(3)) / (odd * period),
        2.0 * (m0 * against(2) - m2 * against(0)) / (even * period * period),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_reproduced() {
        let period = 0.01;
        let at = |t: f64| 1.0 + 2.0 * t - 3.0 * t * t + 40.0 * t * t * t;
        let values: Vec<f64> = (-4..=4).map(|k| at(f64::from(k) * period)).collect();
        let [value, slope, bend] = cubic(&values, period);
        assert!((value - 1.0).abs() < 1e-12 && (slope - 2.0).abs() < 1e-10 && (bend + 6.0).abs() < 1e-8);
    }
}
