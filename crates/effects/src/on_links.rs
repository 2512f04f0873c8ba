//! Torques on the links' side of the gears that the model of the arm does not contain, such as those of springs and transmission couplings.

use crate::signals::Slope;
use crate::{OnLinks, Signals, Term};

/// The step of a difference, relative to the range of the position, to the velocity within which the smooth sign changes, and to 1 rad/s² or
/// m/s². The laws are smooth, and most are linear.
const STEP: f64 = 1e-3;

impl OnLinks {
    /// The torques of `terms` with their coefficients along `motion`.
    pub fn new(terms: &[(Term, f64)], motion: &Signals<'_>) -> Self {
        let joints = 0..motion.q.len();
        let sum = |joint: usize, motion: &Signals<'_>| {
            let mut sum = vec![0.0; motion.ticks()];
            for (term, value) in terms {
                let column = term.column(joint, motion).unwrap_or_default();
                sum.iter_mut().zip(column).for_each(|(sum, x)| *sum += value * x);
            }
            sum
        };
        let torque: Vec<Vec<f64>> = joints.clone().map(|joint| sum(joint, motion)).collect();
        let mut moved: Vec<usize> = terms.iter().flat_map(|(term, _)| term.of).collect();
        moved.sort_unstable();
        moved.dedup();
        let mut slopes = Vec::new();
        for of in moved {
            let steps = [STEP * motion.scales.range[of], STEP * motion.scales.turning[of], STEP];
            let mut by: Vec<[Vec<f64>; 3]> = vec![Default::default(); joints.len()];
            for (order, step) in steps.into_iter().enumerate() {
                let mut signals = [motion.q, motion.qd, motion.qdd].map(<[Vec<f64>]>::to_vec);
                signals[order][of].iter_mut().for_each(|x| *x += step);
                let [q, qd, qdd] = &signals;
                let shifted = Signals { q, qd, qdd, ..*motion };
                for (on, by) in by.iter_mut().enumerate() {
                    let after = sum(on, &shifted);
                    by[order] = after.iter().zip(&torque[on]).map(|(after, before)| (after - before) / step).collect();
                }
            }
            let slope = |(on, by)| Slope { on, of, by };
            let is_there = |slope: &Slope| slope.by.iter().flatten().any(|&x| x != 0.0);
            slopes.extend(by.into_iter().enumerate().map(slope).filter(is_there));
        }
        Self { torque, slopes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Law;
    use crate::laws::POSITION;
    use crate::test_support::along;

    static OTHER: Law =
        Law { name: "other", column: |_, joint, motion| Some(motion.qdd[1 - joint].clone()), ..Law::PLAIN };

    /// A spring on the joint depends on its position, a coupling on the acceleration of the other joint.
    #[test]
    fn its_slopes_are_those_of_its_laws() {
        along(|motion| {
            let coupling = Term::about(&OTHER, 1).of(0);
            let terms = [(Term::on(&POSITION, 0).form(1), 5.0), (coupling, 3.0)];
            let found = OnLinks::new(&terms, motion);
            let tick = motion.ticks() / 2;
            let torque = 5.0 * motion.q[0][tick] + 3.0 * motion.qdd[1][tick];
            assert!((found.torque[0][tick] - torque).abs() < 1e-9, "{} {torque}", found.torque[0][tick]);
            for ((on, of), expected) in
                [((0, 0), [5.0, 0.0, 0.0]), ((0, 1), [0.0, 0.0, 3.0]), ((1, 0), [0.0, 0.0, 3.0]), ((1, 1), [0.0; 3])]
            {
                for (slope, expected) in found.slopes(on, of, tick).into_iter().zip(expected) {
                    assert!((slope - expected).abs() < 1e-6, "on {on} of {of}: {slope} {expected}");
                }
            }
            let mut torque = vec![0.0; motion.ticks()];
            found.add_change((1, 0), &vec![[0.1, 0.2, 2.0]; motion.ticks()], &mut torque);
            assert!(torque.iter().all(|torque| (torque - 6.0).abs() < 1e-6));
        });
    }
}
