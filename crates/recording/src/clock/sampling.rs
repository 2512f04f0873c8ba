//! Whether rows were sampled at the times of their stamps or on a regular clock, which positions show: they are smooth along the true times.

use super::{Clock, median};
use crate::interpolate::weighted;

/// The rows before and after one from which its position is predicted.
const SIDE: usize = 2;
/// The largest number of rows that are predicted.
const MOST_ROWS: usize = 20_000;
/// If the absolute weights of the nodes have a larger sum, a row is not predicted. It is 1.7 for even rows.
const MOST_WEIGHT: f64 = 4.0;
/// The largest share of the mean squares along both times that those along the stamps may have. Where noise hides the difference, it is
/// one half.
const MOST_SHARE: f64 = 1.0 / 3.0;

/// Whether the positions `q` (one list a joint) are clearly smoother along the stamps `time` (s) than along the ticks of `clock`.
pub fn is_at_stamps(time: &[f64], q: &[Vec<f64>], clock: &Clock) -> bool {
    let shares: Vec<f64> = q.iter().filter_map(|q| share_along_stamps(time, q, clock)).collect();
    !shares.is_empty() && shares.iter().sum::<f64>() < MOST_SHARE * shares.len() as f64
}

/// The share of the stamps in the sum of the squared typical errors of predictions along stamps and along ticks; `None` for a joint that
/// does not move.
fn share_along_stamps(time: &[f64], q: &[f64], clock: &Clock) -> Option<f64> {
    let centres = || {
        let pieces = clock.pieces.iter().map(|piece| piece.rows.clone());
        pieces.flat_map(|rows| (rows.start + SIDE)..rows.end.saturating_sub(SIDE))
    };
    let stride = centres().count().div_ceil(MOST_ROWS).max(1);
    let pace = |row: usize| (q[row + 1] - q[row - 1]).abs();
    let mut paces: Vec<f64> = centres().step_by(stride).map(pace).filter(|&pace| pace > 0.0).collect();
    // Only fast rows show a difference.
    let fast = median(&mut paces);
    let error = |row: usize, places: &dyn Fn(usize) -> f64| -> Option<f64> {
        let nodes = (row - SIDE..=row + SIDE).filter(|&other| other != row);
        let nodes: Vec<(f64, f64)> = nodes.map(|other| (places(other), q[other])).collect();
        let (value, weight) = weighted(&nodes, places(row));
        (weight <= MOST_WEIGHT).then_some((value - q[row]).abs())
    };
    let (mut along_stamps, mut along_ticks) = (Vec::new(), Vec::new());
    for row in centres().step_by(stride).filter(|&row| pace(row) >= fast) {
        let stamps = error(row, &|other| (time[other] - time[row]) / clock.period);
        let ticks = error(row, &|other| (clock.ticks[other] - clock.ticks[row]) as f64);
        if let (Some(stamps), Some(ticks)) = (stamps, ticks) {
            along_stamps.push(stamps);
            along_ticks.push(ticks);
        }
    }
    let [stamps, ticks] = [along_stamps, along_ticks].map(|mut errors| median(&mut errors).powi(2));
    (stamps + ticks > 0.0).then(|| stamps / (stamps + ticks))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::find;

    /// Whether a joint that is sampled at times that scatter is found to be, with stamps of these times or of the ticks.
    fn found(sampled_at_stamps: bool, step: f64) -> bool {
        let scatter = |row: usize| 0.0015 * (1.7 * row as f64).sin() * (0.3 * row as f64 * row as f64).cos();
        let stamps: Vec<f64> = (0..3000).map(|row| 0.01 * row as f64 + scatter(row)).collect();
        let sampled = |row: usize| {
            if sampled_at_stamps { stamps[row] } else { 0.01 * row as f64 }
        };
        let q = |row: usize| ((3.0 * sampled(row)).sin() / step).round() * step;
        let q: Vec<f64> = (0..stamps.len()).map(q).collect();
        let clock = find(&stamps, &[]);
        assert!(clock.regular, "the stamps have a clock");
        is_at_stamps(&stamps, &[q, vec![0.5; stamps.len()]], &clock)
    }

    #[test]
    fn positions_are_smooth_along_the_times_at_which_they_were_sampled() {
        assert!(found(true, 1e-5));
        assert!(!found(false, 1e-5));
        // An encoder with coarse steps hides the difference, so that the clock is used.
        assert!(!found(true, 0.1));
    }
}
