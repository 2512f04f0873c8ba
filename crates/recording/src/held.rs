//! Rows that repeat the previous sample, from a logger that is faster than the drive.

use crate::{Recording, Warning};

/// The smallest number of samples in which repetitions are recognised.
const LEAST_RUNS: usize = 20;
/// The smallest share of the samples that must be repeated equally often.
const ALIKE: f64 = 0.8;
/// Samples of positions that are held for more rows than this may be held for one more or one less.
const DRIFTS_FROM: usize = 3;
/// The largest number of rows with which a sample is repeated once in a while; a longer stretch is a rest.
const MOST_REPEATED: usize = 5;
/// The least share of the rows that repeat the row before while the arm moves. By chance, and at a low speed, hardly any does.
const LEAST_REPEATED: f64 = 0.01;
/// Two steps of a position are those of the same encoder if they differ by less than this part.
const SAME_LINE: f64 = 0.01;

/// The recording with each sample once, and a warning, if samples were written several times, always or once in a while, or if positions
/// were refreshed in some of the rows only, whatever the other signals do; `None` otherwise.
///
/// The positions of repeated samples are constant and then jump, so that their derivatives are meaningless, and they are older than the
/// torques of the same rows.
pub fn without_held(recording: &Recording) -> Option<(Recording, Warning)> {
    let equal = runs(recording, true);
    if let Some((held, samples)) = samples(&equal, &is_multiple) {
        let warning = Warning::Held { rows: recording.len(), samples: samples.len(), held };
        return Some((picked(recording, &samples), warning));
    }
    if let Some(samples) = once_in_a_while(recording, &equal) {
        let warning = Warning::Repeated { rows: recording.len(), repeated: recording.len() - samples.len() };
        return Some((picked(recording, &samples), warning));
    }
    let runs = runs(recording, false);
    let (held, samples) = samples(&runs, &is_equal).filter(|_| !is_one_encoder(recording, &runs))?;
    let warning = Warning::HeldPositions { rows: recording.len(), samples: samples.len(), held };
    Some((picked(recording, &samples), warning))
}

/// Whether a sample was written `length` times if most samples were written `held` times. The clock of the logger drifts relative to that of
/// the drive, so that a sample is sometimes repeated once more or once less. Values that remain constant for longer are separate samples
/// with the same value.
fn is_multiple(length: usize, held: usize) -> bool {
    let rest = length % held;
    rest <= 1 || rest + 1 >= held
}

/// As [`is_multiple`] for positions alone, which a coarse encoder also repeats, but for different numbers of rows.
fn is_equal(length: usize, held: usize) -> bool {
    length == held || (held > DRIFTS_FROM && length.abs_diff(held) <= 1)
}

/// Whether the positions change by the lines of one coarse encoder, which a joint passes at a constant speed.
fn is_one_encoder(recording: &Recording, runs: &[(usize, usize)]) -> bool {
    let step = |row: usize| -> Option<f64> {
        let mut steps = recording.q.iter().map(|q| (q[row] - q[row - 1]).abs());
        let first = steps.by_ref().find(|&step| step > 0.0)?;
        steps.all(|step| step == 0.0).then_some(first)
    };
    let mut alone: Vec<f64> = runs.iter().skip(1).filter_map(|&(row, _)| step(row)).collect();
    if alone.is_empty() {
        return false;
    }
    let middle = alone.len() / 2;
    let line = *alone.select_nth_unstable_by(middle, f64::total_cmp).1;
    let lines = alone.iter().filter(|&&step| (step - line).abs() < SAME_LINE * line).count();
    lines as f64 >= ALIKE * (runs.len() - 1) as f64
}

/// The number of rows for which most samples of `runs` are held, and the rows of the samples; `None` if samples are not held, or if too few
/// runs are alike.
fn samples(runs: &[(usize, usize)], is_alike: &dyn Fn(usize, usize) -> bool) -> Option<(usize, Vec<usize>)> {
    let mut lengths: Vec<usize> = runs.iter().map(|&(_, length)| length).collect();
    if lengths.len() < LEAST_RUNS {
        return None;
    }
    let middle = lengths.len() / 2;
    let held = *lengths.select_nth_unstable(middle).1;
    let alike = lengths.iter().filter(|&&length| is_alike(length, held)).count();
    if held < 2 || (alike as f64) < ALIKE * lengths.len() as f64 {
        return None;
    }
    let times = |length: usize| ((length as f64 / held as f64).round() as usize).max(1);
    let rows = runs
        .iter()
        .flat_map(|&(first, length)| (0..times(length)).map(move |sample| first + (sample * held).min(length - 1)));
    Some((held, rows.collect()))
}

/// The rows without those that repeat the row before while the arm moves: a logger writes the last value when no new one has come. `None` if
/// there are hardly any.
fn once_in_a_while(recording: &Recording, runs: &[(usize, usize)]) -> Option<Vec<usize>> {
    let moves = |row: usize| recording.q.iter().any(|q| q[row] != q[row - 1]);
    let is_repeated = |&(first, length): &(usize, usize)| {
        let next = first + length;
        (2..=1 + MOST_REPEATED).contains(&length)
            && (first == 0 || moves(first))
            && (next == recording.len() || moves(next))
    };
    let kept = runs.iter().flat_map(|run| run.0..if is_repeated(run) { run.0 + 1 } else { run.0 + run.1 });
    let kept: Vec<usize> = kept.collect();
    let repeated = recording.len() - kept.len();
    (repeated as f64 >= LEAST_REPEATED * recording.len() as f64).then_some(kept)
}

/// First row and length of each stretch of rows with the same positions, and, with `all`, the same velocities and torques.
fn runs(recording: &Recording, all: bool) -> Vec<(usize, usize)> {
    let signals = || {
        let others = recording.tau.iter().chain(recording.qd.iter().flatten());
        recording.q.iter().chain(others.filter(move |_| all))
    };
    let repeats = |row: usize| {
        recording.breaks.binary_search(&row).is_err() && signals().all(|signal| signal[row] == signal[row - 1])
    };
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for row in 0..recording.len() {
        match runs.last_mut() {
            Some((_, length)) if repeats(row) => *length += 1,
            _ => runs.push((row, 1)),
        }
    }
    runs
}

/// The recording's rows `rows` alone.
fn picked(recording: &Recording, rows: &[usize]) -> Recording {
    let pick = |values: &mut Vec<f64>| *values = rows.iter().map(|&row| values[row]).collect();
    let mut picked = recording.clone();
    pick(&mut picked.time);
    picked.channels_mut().for_each(|(_, values)| pick(values));
    picked.breaks.iter_mut().for_each(|at| *at = rows.partition_point(|row| row < at));
    picked
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 500 samples of a swing, each written as many times as `times` says.
    fn written(times: impl Fn(usize) -> usize) -> Recording {
        let samples: Vec<usize> = (0..500).flat_map(|sample| vec![sample; times(sample)]).collect();
        Recording {
            joints: vec!["a".into()],
            time: (0..samples.len()).map(|row| row as f64 * 0.0025).collect(),
            q: vec![samples.iter().map(|&k| (0.02 * k as f64).sin()).collect()],
            tau: vec![samples.iter().map(|&k| (0.03 * k as f64).cos()).collect()],
            ..Recording::default()
        }
    }

    #[test]
    fn each_sample_is_left_once() {
        let recording = written(|sample| [4, 4, 4, 5, 4, 3][sample % 6]);
        let (thinned, warning) = without_held(&recording).expect("samples are held");
        assert_eq!(thinned.q[0].len(), 500);
        assert!(thinned.q[0].windows(2).all(|pair| pair[0] != pair[1]));
        let expected = Warning::Held { rows: recording.len(), samples: 500, held: 4 };
        assert_eq!(warning, expected);
        let (regular, warnings) = recording.regular().expect("it has a clock");
        assert!(warnings.contains(&expected), "{warnings:?}");
        assert!((regular.period - 0.01).abs() < 1e-4, "{}", regular.period);
    }

    #[test]
    fn rows_that_are_repeated_once_in_a_while_are_left_out() {
        let recording = written(|sample| if sample % 10 == 3 { 2 } else { 1 });
        let (thinned, warning) = without_held(&recording).expect("rows are repeated");
        assert_eq!((thinned.len(), warning), (500, Warning::Repeated { rows: 550, repeated: 50 }));
        let (regular, _) = recording.regular().expect("it has a clock");
        assert_eq!((regular.period, regular.len()), (0.0025, 550));
        assert!(without_held(&written(|sample| if sample % 200 == 3 { 2 } else { 1 })).is_none(), "two of 500");
    }

    #[test]
    fn positions_that_are_held_under_torques_are_left_once() {
        let mut recording = written(|_| 3);
        recording.tau = vec![(0..recording.len()).map(|row| (0.01 * row as f64).cos()).collect()];
        let (thinned, warning) = without_held(&recording).expect("positions are held");
        assert_eq!((thinned.len(), thinned.tau[0][100]), (500, recording.tau[0][300]));
        let expected = Warning::HeldPositions { rows: 1500, samples: 500, held: 3 };
        assert_eq!(warning, expected);
    }

    /// A joint passes the lines of a coarse encoder at different speeds.
    #[test]
    fn a_coarse_encoder_does_not_hold_its_positions() {
        let mut recording = written(|_| 1);
        recording.tau = vec![(0..recording.len()).map(|row| (0.3 * row as f64).cos()).collect()];
        for quantum in [0.02, 0.04, 0.06] {
            let coarse = recording.q[0].iter().map(|q| (q / quantum).round() * quantum).collect();
            let recording = Recording { q: vec![coarse], ..recording.clone() };
            assert!(without_held(&recording).is_none(), "{quantum}");
        }
        let at_constant_speed = (0..recording.len()).map(|row| 0.01 * (row as f64 / 7.4).floor()).collect();
        let recording = Recording { q: vec![at_constant_speed], ..recording };
        assert!(without_held(&recording).is_none());
    }

    #[test]
    fn held_positions_may_drift_and_rest() {
        let times = |sample: usize| match sample {
            100 | 300 => 200,
            _ => [5, 5, 6, 5, 4][sample % 5],
        };
        let mut recording = written(times);
        recording.tau = vec![(0..recording.len()).map(|row| (0.01 * row as f64).cos()).collect()];
        let (thinned, warning) = without_held(&recording).expect("positions are held");
        assert!(matches!(warning, Warning::HeldPositions { held: 5, .. }), "{warning:?}");
        assert_eq!(thinned.len(), 500 + 2 * 39);
    }

    #[test]
    fn a_robot_that_rests_is_not_held() {
        assert!(without_held(&written(|_| 1)).is_none());
        let rests = |sample: usize| if sample.is_multiple_of(50) { 100 } else { 1 };
        assert!(without_held(&written(rests)).is_none());
    }

    #[test]
    fn a_sample_that_comes_again_is_another() {
        let (thinned, _) =
            without_held(&written(|sample| if sample == 100 { 40 } else { 4 })).expect("samples are held");
        assert_eq!(thinned.len(), 509);
    }
}
