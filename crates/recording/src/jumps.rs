//! Positions that jump between two rows by more than an arm can move: an encoder that loses its position, frozen data, or runs that were
//! appended.

use crate::{Recording, Warning};

/// The largest acceleration of an arm's joint (rad/s² or m/s²); those of fast parallel robots are below 500.
const LARGEST_ACCELERATION: f64 = 1e3;
/// The smallest jump (rad or m).
const LEAST: f64 = 0.01;
/// The smallest ratio of a jump to the steps of the motion.
const TIMES_OTHERS: f64 = 10.0;
/// The share of the steps that are those of the motion; the others may be jumps.
const OF_MOTION: f64 = 0.995;
/// The largest ratio of the steps before and after a jump to the jump.
const NEIGHBOUR: f64 = 0.25;
/// The largest number of jumps of a joint in a recording.
const MOST: usize = 20;
/// Rows that are more periods apart are not compared.
const GAP: f64 = 3.0;

/// The rows at which a run of `recording` begins: those of the recording, and those before which the position of a joint jumps, so that no
/// filter mixes the positions before and after. Adds one warning if there are jumps.
pub fn breaks(recording: &Recording, warnings: &mut Vec<Warning>) -> Vec<usize> {
    let of_joint = |q: &Vec<f64>| jumps(&recording.time, q, &recording.breaks);
    let by_joint: Vec<Vec<usize>> = recording.q.iter().map(of_joint).collect();
    let mut rows = by_joint.concat();
    rows.sort_unstable();
    rows.dedup();
    let Some(&first) = rows.first() else { return recording.breaks.clone() };
    let jumps = rows.len();
    let jumping = (0..by_joint.len()).filter(|&joint| by_joint[joint].contains(&first));
    let step = |joint: usize| recording.q[joint][first] - recording.q[joint][first - 1];
    let largest = jumping.max_by(|&a, &b| step(a).abs().total_cmp(&step(b).abs())).unwrap_or_default();
    let (joint, time) = (recording.joints[largest].clone(), recording.time[first]);
    warnings.push(Warning::Jumps { joint, jumps, time, size: step(largest) });
    rows.extend(&recording.breaks);
    rows.sort_unstable();
    rows
}

/// The rows before which `q` (rad or m) jumps, where no run begins.
fn jumps(time: &[f64], q: &[f64], breaks: &[usize]) -> Vec<usize> {
    if q.len() < 4 {
        return Vec::new();
    }
    let mut periods: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = periods.len() / 2;
    let period = *periods.select_nth_unstable_by(middle, f64::total_cmp).1;
    let step = |row: usize| q[row] - q[row - 1];
    // A joint may rest most of the time.
    let mut sizes: Vec<f64> = (1..q.len()).map(|row| step(row).abs()).filter(|&step| step > 0.0).collect();
    if sizes.len() < 2 {
        return Vec::new();
    }
    let most = ((sizes.len() as f64 * OF_MOTION) as usize).min(sizes.len() - 2);
    let motion = *sizes.select_nth_unstable_by(most, f64::total_cmp).1;
    let least = LEAST.max(TIMES_OTHERS * motion).max(LARGEST_ACCELERATION * period * period);
    let follows = |row: usize| breaks.binary_search(&row).is_err() && time[row] - time[row - 1] <= GAP * period;
    let is_jump = |&row: &usize| {
        let jump = step(row).abs();
        // A step back in the next row is a spike, and a large step before or after belongs to a fast motion.
        jump > least
            && (row - 1..=row + 1).all(follows)
            && step(row - 1).abs().max(step(row + 1).abs()) <= NEIGHBOUR * jump
    };
    let jumps: Vec<usize> = (2..q.len() - 1).filter(is_jump).collect();
    // More of them are a property of the signal, as of positions that are seldom refreshed.
    if jumps.len() > MOST { Vec::new() } else { jumps }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two seconds of a motion (rad) at 500 Hz, and its times (s).
    fn motion() -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..1000).map(|row| f64::from(row) * 2e-3).collect();
        let q = time.iter().map(|t| (3.0 * t).sin()).collect();
        (time, q)
    }

    #[test]
    fn a_lost_position_is_a_jump() {
        let (time, mut q) = motion();
        q[600..].iter_mut().for_each(|q| *q += 0.2);
        assert_eq!(jumps(&time, &q, &[]), [600]);
        assert!(jumps(&time, &q, &[600]).is_empty(), "there a run begins already");
    }

    #[test]
    fn motion_spikes_and_slow_logs_have_no_jumps() {
        let (time, mut q) = motion();
        q[600] += 0.2;
        assert!(jumps(&time, &q, &[]).is_empty());
        // At 10 Hz, a joint moves by 0.5 rad between two rows and rests before and after.
        let slow: Vec<f64> = (0..1000).map(|row| f64::from(row) * 0.1).collect();
        let rest: Vec<f64> = (0..1000).map(|row| if row < 600 { 0.0 } else { 0.5 }).collect();
        assert!(jumps(&slow, &rest, &[]).is_empty());
        // One line of a coarse encoder.
        let line: Vec<f64> = rest.iter().map(|q| 0.01 * q).collect();
        assert!(jumps(&time, &line, &[]).is_empty());
    }
}
