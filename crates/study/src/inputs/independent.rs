//! Whether recordings are independent: whether one contains a stretch of another, sample for sample.

use std::collections::BTreeSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use recording::RegularRecording;

/// The length of a stretch in samples. That this many samples of a moving arm, torques included, are equal is not a
/// coincidence.
const STRETCH: usize = 50;

/// On average, one of this many samples begins a stretch.
const EVERY: u64 = 32;

/// Some stretches of motion of a recording, each as a hash of its positions and torques. The positions determine where
/// stretches begin, so that a part of a recording has the same stretches under another name or at other times. They are
/// taken before parts of a long recording are dropped.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Stretches(BTreeSet<u64>);

impl Stretches {
    pub(super) fn of(recording: &RegularRecording) -> Self {
        let begins = 0..(recording.len() + 1).saturating_sub(STRETCH);
        let is_begin = |&at: &usize| {
            let row = recording.q.iter().map(|q| q[at].to_bits());
            let moves = || recording.q.iter().any(|q| q[at] != q[at + STRETCH - 1]);
            hash(row).is_multiple_of(EVERY) && moves()
        };
        let stretch = |at: usize| {
            let signals = recording.q.iter().chain(&recording.tau);
            hash(signals.flat_map(|signal| signal[at..at + STRETCH].iter().map(|value| value.to_bits())))
        };
        Self(begins.filter(is_begin).map(stretch).collect())
    }

    /// Whether both are of the same samples.
    pub(super) fn are_all_of(&self, other: &Self) -> bool {
        !self.0.is_empty() && self == other
    }

    /// Whether some are of the same samples.
    pub(super) fn are_in(&self, other: &Self) -> bool {
        !self.0.is_disjoint(&other.0)
    }
}

fn hash(values: impl Iterator<Item = u64>) -> u64 {
    let mut hasher = DefaultHasher::new();
    values.for_each(|value| value.hash(&mut hasher));
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(phase: f64, ticks: std::ops::Range<usize>) -> RegularRecording {
        let signal = |amplitude: f64| ticks.clone().map(|k| amplitude * (0.011 * k as f64 + phase).sin()).collect();
        RegularRecording {
            period: 0.01,
            present: vec![true; ticks.len()],
            q: vec![signal(1.0), signal(0.7)],
            tau: vec![signal(3.0), signal(2.0)],
            ..RegularRecording::default()
        }
    }

    #[test]
    fn a_part_is_found_in_the_whole_and_another_motion_is_not() {
        let whole = Stretches::of(&recording(0.0, 0..5000));
        let part = Stretches::of(&recording(0.0, 1234..2000));
        let other = Stretches::of(&recording(0.3, 0..5000));
        assert!(part.are_in(&whole) && !part.are_all_of(&whole));
        assert!(whole.are_all_of(&Stretches::of(&recording(0.0, 0..5000))));
        assert!(!other.are_in(&whole));
    }

    #[test]
    fn an_arm_at_rest_has_no_stretches() {
        let mut resting = recording(0.0, 0..500);
        resting.q.iter_mut().for_each(|q| q.fill(0.2));
        let none = Stretches::of(&resting);
        assert!(!none.are_all_of(&none.clone()));
    }
}
