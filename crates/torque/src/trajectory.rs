//! A recorded motion that a reference can follow.

use crate::motion::Motion;

/// Positions at equal times with their first two derivatives. Between two times, the motion is the polynomial of fifth degree with the
/// values and derivatives on both sides, so that position, velocity and acceleration are continuous.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// The time between points (s).
    period: f64,
    /// At least one.
    points: Vec<Motion>,
}

impl Trajectory {
    /// The motion through `points`, which are `period` (s) apart; `None` without a point, or if they differ in their number of joints.
    pub fn new(period: f64, points: Vec<Motion>) -> Option<Self> {
        let dof = points.first()?.q.len();
        let has_all = |point: &Motion| [&point.q, &point.qd, &point.qdd].iter().all(|values| values.len() == dof);
        points.iter().all(has_all).then_some(Self { period, points })
    }

    /// The first positions (rad or m).
    pub fn start(&self) -> &[f64] {
        &self.points[0].q
    }

    /// The time of the last point (s); the first one has the time 0.
    pub fn duration(&self) -> f64 {
        self.period * (self.points.len() - 1) as f64
    }

    /// Adds the motion of every joint at `time` (s), relative to its first position, to `motion`. More than a period before the first point
    /// and after the last one, it stands still there.
    pub fn add_to(&self, time: f64, motion: &mut Motion) {
        let last = self.points.len() - 1;
        let place = (time / self.period).clamp(0.0, last as f64);
        let from = (place.floor() as usize).min(last.saturating_sub(1));
        let (a, b) = (&self.points[from], &self.points[(from + 1).min(last)]);
        let rests = time < -self.period || time > self.duration() + self.period;
        let (x, h) = (place - from as f64, self.period);
        for (joint, start) in self.start().iter().enumerate() {
            // The coefficients of x³, x⁴ and x⁵ follow from the values at x = 1.
            let (step, slope, bend) = (b.q[joint] - a.q[joint], h * a.qd[joint], h * h * a.qdd[joint]);
            let (next_slope, next_bend) = (h * b.qd[joint], h * h * b.qdd[joint]);
            let c3 = 10.0 * step - 6.0 * slope - 4.0 * next_slope - 1.5 * bend + 0.5 * next_bend;
            let c4 = -15.0 * step + 8.0 * slope + 7.0 * next_slope + 1.5 * bend - next_bend;
            let c5 = 6.0 * step - 3.0 * slope - 3.0 * next_slope - 0.5 * bend + 0.5 * next_bend;
            motion.q[joint] += a.q[joint] - start + x * (slope + x * (0.5 * bend + x * (c3 + x * (c4 + x * c5))));
            if rests {
                continue;
            }
            motion.qd[joint] += (slope + x * (bend + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))) / h;
            motion.qdd[joint] += (bend + x * (6.0 * c3 + x * (12.0 * c4 + x * 20.0 * c5))) / (h * h);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(q: f64, qd: f64, qdd: f64) -> Motion {
        Motion { q: vec![q], qd: vec![qd], qdd: vec![qdd] }
    }

    fn at(trajectory: &Trajectory, time: f64) -> [f64; 3] {
        let mut motion = Motion::new(1);
        trajectory.add_to(time, &mut motion);
        [motion.q[0], motion.qd[0], motion.qdd[0]]
    }

    /// A polynomial of fifth degree is met everywhere, from its values at three times.
    #[test]
    fn a_polynomial_of_fifth_degree_is_met() {
        let value = |t: f64| 0.3 + t * (0.5 + t * (-1.0 + t * (2.0 + t * (0.7 - 0.4 * t))));
        let slope = |t: f64| 0.5 + t * (-2.0 + t * (6.0 + t * (2.8 - 2.0 * t)));
        let bend = |t: f64| -2.0 + t * (12.0 + t * (8.4 - 8.0 * t));
        let points = [0.0, 0.25, 0.5].map(|t| point(value(t), slope(t), bend(t)));
        let trajectory = Trajectory::new(0.25, points.into()).expect("three points");
        assert_eq!(trajectory.duration(), 0.5);
        for t in [0.0, 0.1, 0.25, 0.4, 0.5] {
            let [q, qd, qdd] = at(&trajectory, t);
            assert!((q - (value(t) - 0.3)).abs() < 1e-13, "{t}: {q}");
            assert!((qd - slope(t)).abs() < 1e-12, "{t}: {qd}");
            assert!((qdd - bend(t)).abs() < 1e-11, "{t}: {qdd}");
        }
    }

    #[test]
    fn the_motion_rests_before_and_after() {
        let trajectory = Trajectory::new(0.5, vec![point(1.0, 1.0, 0.0), point(1.5, 1.0, 0.0)]).expect("two points");
        assert_eq!(at(&trajectory, -1.0), [0.0; 3]);
        assert_eq!(at(&trajectory, 2.0), [0.5, 0.0, 0.0]);
        let alone = Trajectory::new(0.5, vec![point(1.0, 0.0, 0.0)]).expect("one point");
        assert_eq!(at(&alone, 0.0), [0.0; 3]);
        assert!(Trajectory::new(0.5, Vec::new()).is_none());
        assert!(Trajectory::new(0.5, vec![point(1.0, 0.0, 0.0), Motion::new(2)]).is_none());
    }
}
