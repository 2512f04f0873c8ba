//! Positions that are off by whole turns, brought into the URDF's limits.

use std::f64::consts::TAU;

use arm::{Arm, JointKind};
use recording::Recording;

use super::thresholds::TURNS_SLACK;

/// Moves positions of `recording` by whole turns into the limits of `arm`, if they lie beyond them, and says so of each joint. The
/// torques do not depend on whole turns, but the positions in a report do.
pub fn into_limits(recording: &mut Recording, arm: &Arm) -> Vec<(String, String)> {
    let mut said = Vec::new();
    for (name, q) in recording.joints.iter().zip(&mut recording.q) {
        let joint = arm.joints().iter().find(|joint| joint.name == *name);
        let Some(joint) = joint.filter(|joint| joint.kind == JointKind::Revolute) else {
            continue;
        };
        let (low, high) = range(q);
        let turns = turns_off(low, high, joint.limits.lower, joint.limits.upper);
        if turns == 0.0 {
            continue;
        }
        q.iter_mut().for_each(|q| *q -= turns * TAU);
        let unit = if turns.abs() == 1.0 { "turn" } else { "turns" };
        let text = format!(
            "its positions lie {} {unit} {} the URDF's limits {:.3} … {:.3} rad, and were moved into them",
            turns.abs(),
            if turns > 0.0 { "above" } else { "below" },
            joint.limits.lower,
            joint.limits.upper
        );
        said.push((name.clone(), text));
    }
    said
}

/// By how much the positions `q` of the joints of `arm` exceed its limits at most (rad or m), after whole turns.
pub fn beyond_limits(arm: &Arm, q: &[Vec<f64>]) -> f64 {
    let of = |(joint, q): (&arm::Joint, &Vec<f64>)| {
        let (lower, upper) = (joint.limits.lower, joint.limits.upper);
        let (low, high) = range(q);
        if upper <= lower || low > high {
            return 0.0;
        }
        let moved = match joint.kind {
            JointKind::Revolute => nearest_turns(low, high, lower, upper) * TAU,
            JointKind::Prismatic => 0.0,
        };
        (lower - (low - moved)).max(high - moved - upper).max(0.0)
    };
    arm.joints().iter().zip(q).map(of).fold(0.0, f64::max)
}

/// The least and the largest of the finite values; the first is larger if there are none.
pub(crate) fn range(q: &[f64]) -> (f64, f64) {
    let known = q.iter().copied().filter(|q| q.is_finite());
    known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(q), high.max(q)))
}

/// The whole turns between the middle of a range and that of the limits.
fn nearest_turns(low: f64, high: f64, lower: f64, upper: f64) -> f64 {
    ((0.5 * (low + high) - 0.5 * (lower + upper)) / TAU).round()
}

/// The whole turns by which a range lies beyond limits; 0 if it is within them, if no number of turns brings it there, or if there are
/// no limits.
fn turns_off(low: f64, high: f64, lower: f64, upper: f64) -> f64 {
    let is_within = |turns: f64| low - turns * TAU >= lower - TURNS_SLACK && high - turns * TAU <= upper + TURNS_SLACK;
    if upper <= lower || !low.is_finite() || !high.is_finite() || is_within(0.0) {
        return 0.0;
    }
    let turns = nearest_turns(low, high, lower, upper);
    if is_within(turns) { turns } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_ranges_that_whole_turns_bring_into_the_limits_are_moved() {
        assert_eq!(turns_off(-1.0, 1.0, -2.0, 2.0), 0.0);
        assert_eq!(turns_off(TAU - 1.0, TAU + 1.0, -2.0, 2.0), 1.0);
        assert_eq!(turns_off(-2.0 * TAU - 1.0, -2.0 * TAU + 1.0, -2.0, 2.0), -2.0);
        // Half a turn off, too wide, without limits, and without values.
        assert_eq!(turns_off(2.5, 4.0, -2.0, 2.0), 0.0);
        assert_eq!(turns_off(TAU - 3.0, TAU + 3.0, -2.0, 2.0), 0.0);
        assert_eq!(turns_off(TAU, TAU, 0.0, 0.0), 0.0);
        assert_eq!(turns_off(f64::INFINITY, f64::NEG_INFINITY, -2.0, 2.0), 0.0);
    }
}
