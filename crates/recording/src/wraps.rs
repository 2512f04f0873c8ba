//! Encoders whose positions wrap at a turn: the positions are made continuous.

use std::f64::consts::{PI, TAU};

use crate::{Quantity, Recording, Warning};

/// The range of a wrapped position may exceed a turn by this (rad).
const MARGIN: f64 = 1e-2;
/// The largest deviation of a jump from a turn, in multiples of the largest other step.
const STEPS: f64 = 4.0;
/// Rows that are more periods apart are not compared.
const GAP: f64 = 3.0;
/// The largest step between rows at which a jump can be distinguished from motion (rad).
const LARGEST_STEP: f64 = 0.25 * PI;

/// Makes the positions of `recording` continuous where an encoder wraps at a turn, and adds a warning.
pub fn unwrap(recording: &mut Recording) {
    let secondary = recording.q_secondary.iter_mut().map(Option::as_mut).enumerate();
    let secondary = secondary.filter_map(|(joint, q)| Some((joint, q?, Quantity::SecondaryPosition)));
    let primary = recording.q.iter_mut().enumerate();
    let all = primary.map(|(joint, q)| (joint, q, Quantity::Position)).chain(secondary);
    let mut warnings = Vec::new();
    for (joint, q, quantity) in all {
        let jumps = continuous(&recording.time, q, &recording.breaks);
        if let Some(&first) = jumps.first() {
            warnings.push(Warning::Unwrapped {
                joint: recording.joints[joint].clone(),
                quantity,
                jumps: jumps.len(),
                time: recording.time[first],
            });
        }
    }
    recording.warnings.extend(warnings);
}

/// Removes the jumps by a turn from `q` if it is that of a wrapped encoder: its range is at most a turn, and some
/// steps are a turn plus or minus a motion as small as all other steps. Returns the rows after the jumps. Over a gap
/// the shorter way is assumed, which makes no difference to a model.
fn continuous(time: &[f64], q: &mut [f64], breaks: &[usize]) -> Vec<usize> {
    let (low, high) = q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    if high - low > TAU + MARGIN || high - low < TAU - 2.0 * LARGEST_STEP {
        return Vec::new();
    }
    let begins = |row: usize| breaks.binary_search(&row).is_ok();
    let step = |row: usize| q[row] - q[row - 1];
    let mut periods: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = periods.len() / 2;
    let longest = GAP * *periods.select_nth_unstable_by(middle, f64::total_cmp).1;
    let next = |row: &usize| !begins(*row) && time[*row] - time[row - 1] <= longest;
    let steps = || (1..q.len()).filter(next).map(step);
    let largest = steps().map(f64::abs).filter(|step| *step < PI).fold(0.0, f64::max);
    let mut turns = steps().filter(|step| step.abs() >= PI).peekable();
    let is_turn = |step: f64| (step.abs() - TAU).abs() <= STEPS * largest + MARGIN;
    if largest > LARGEST_STEP || turns.peek().is_none() || !turns.all(is_turn) {
        return Vec::new();
    }
    let jumps: Vec<(usize, f64)> = (1..q.len())
        .filter(|&row| !begins(row) && step(row).abs() >= PI)
        .map(|row| (row, -TAU * step(row).signum()))
        .collect();
    let mut shift = 0.0;
    let mut next = jumps.iter().peekable();
    for row in 1..q.len() {
        if begins(row) {
            shift = 0.0;
        }
        if let Some((_, turn)) = next.next_if(|(jump, _)| *jump == row) {
            shift += turn;
        }
        q[row] += shift;
    }
    jumps.into_iter().map(|(row, _)| row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn continuous(q: &mut [f64], breaks: &[usize]) -> Vec<usize> {
        let time: Vec<f64> = (0..q.len()).map(|row| row as f64 * 1e-3).collect();
        super::continuous(&time, q, breaks)
    }

    /// A motion of several turns, wrapped to `[low, low + 2π)`.
    fn wrapped(low: f64) -> (Vec<f64>, Vec<f64>) {
        let truth: Vec<f64> = (0..2000).map(|k| 9.0 * (f64::from(k) * 3e-3).sin() + 0.4).collect();
        let wrapped = truth.iter().map(|q| low + (q - low).rem_euclid(TAU)).collect();
        (truth, wrapped)
    }

    #[test]
    fn a_wrapped_encoder_becomes_continuous() {
        for low in [-PI, 0.0] {
            let (truth, mut q) = wrapped(low);
            let jumps = continuous(&mut q, &[]);
            assert!(jumps.len() >= 4, "{}", jumps.len());
            let shift = q[0] - truth[0];
            assert!((shift / TAU - (shift / TAU).round()).abs() < 1e-9);
            for (q, truth) in q.iter().zip(&truth) {
                assert!((q - truth - shift).abs() < 1e-9, "{q} {truth}");
            }
        }
    }

    #[test]
    fn what_is_no_wrap_stays_as_it_is() {
        let (truth, mut cut) = wrapped(-PI);
        let mut q = truth.clone();
        assert!(continuous(&mut q, &[]).is_empty() && q == truth);
        // A spike that differs from a turn.
        cut[1000] += 1.0;
        let before = cut.clone();
        assert!(continuous(&mut cut, &[]).is_empty() && cut == before);
        // Two runs at both ends of a turn.
        let mut runs = [vec![-3.1; 100], vec![3.1; 100]].concat();
        assert!(continuous(&mut runs, &[100]).is_empty());
    }
}
