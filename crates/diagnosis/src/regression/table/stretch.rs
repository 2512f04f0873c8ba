//! The rows over which inner products are formed: recordings, groups of several, and stretches of one.

use std::ops::Range;
use std::sync::Arc;

use super::gram::{Gram, SharedColumn};
use crate::thresholds::STRETCHES;

/// A recording, a group of several, or a stretch of one, in which one joint moves.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// The recording that it is of, or the first one of the group.
    pub recording: usize,
    /// Inner products over its moving rows.
    pub gram: Arc<Gram>,
}

/// Consecutive runs of `rows`, which ascend.
fn runs(rows: &[usize]) -> Vec<Range<usize>> {
    let follows = |a: &usize, b: &usize| a + 1 == *b;
    rows.chunk_by(follows).map(|run| run[0]..run[run.len() - 1] + 1).collect()
}

impl Stretch {
    /// The stretches of a joint that is `moving` on some rows: the `groups` of the recordings, whose rows are `recordings`. If only one
    /// training recording moves the joint, or only one of those on its side of a change (`before`: those from before it), it is divided.
    pub fn of(
        recordings: &[Range<usize>],
        groups: &[usize],
        held_out: &[bool],
        before: &[bool],
        moving: &[bool],
    ) -> Vec<Self> {
        let mut rows: Vec<Vec<usize>> = vec![Vec::new(); recordings.len()];
        for (range, &group) in recordings.iter().zip(groups) {
            rows[group].extend(range.clone().filter(|&row| moving[row]));
        }
        let is_fitted = |r: &usize| !held_out[*r] && !rows[*r].is_empty();
        let is_alone =
            |r: usize| (0..rows.len()).filter(is_fitted).filter(|&other| before[other] == before[r]).count() == 1;
        let mut stretches = Vec::with_capacity(rows.len() + STRETCHES - 1);
        for (recording, rows) in rows.iter().enumerate() {
            let pieces = if is_fitted(&recording) && is_alone(recording) { STRETCHES } else { 1 };
            let length = rows.len().div_ceil(pieces).max(1);
            stretches
                .extend(rows.chunks(length).map(|rows| Self { recording, gram: Arc::new(Gram::over(runs(rows))) }));
        }
        stretches
    }

    /// Takes the inner products of the columns at `places` of a stretch of another table with each other, if it has the same rows.
    pub fn take(&mut self, known: &Self, places: &[usize], is_of_background: &[bool]) {
        if self.recording == known.recording && self.gram.runs() == known.gram.runs() {
            self.gram = Arc::new(known.gram.taken(places, is_of_background));
        }
    }

    /// Inner products of the new ones among the columns `x` with y, and with the columns that are of the background.
    pub fn refresh(&mut self, x: &[SharedColumn], y: &[f64], is_of_background: &[bool]) {
        if !self.gram.has_all(x.len()) {
            Arc::make_mut(&mut self.gram).refresh(x, y, is_of_background);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A recording is divided if it is the only one that moves the joint on its side of a change: what changed then predicts parts to which it
    /// was not fitted.
    #[test]
    fn a_recording_alone_on_its_side_is_divided() {
        let recordings = [0..100, 100..200, 200..300];
        let pieces = |before: [bool; 3], held_out: [bool; 3]| -> [usize; 3] {
            let stretches = Stretch::of(&recordings, &[0, 1, 2], &held_out, &before, &[true; 300]);
            [0, 1, 2].map(|recording| stretches.iter().filter(|stretch| stretch.recording == recording).count())
        };
        let fitted = [false; 3];
        let grouped = Stretch::of(&recordings, &[0, 0, 2], &fitted, &fitted, &[true; 300]);
        let of: Vec<(usize, Range<usize>)> =
            grouped.iter().map(|stretch| (stretch.recording, stretch.gram.runs()[0].clone())).collect();
        assert_eq!(of, [(0, 0..200), (2, 200..300)]);
        assert_eq!(pieces([false; 3], fitted), [1, 1, 1]);
        assert_eq!(pieces([true, true, false], fitted), [1, 1, STRETCHES]);
        assert_eq!(pieces([true, false, false], fitted), [STRETCHES, 1, 1]);
        assert_eq!(pieces([true, false, false], [false, false, true]), [STRETCHES, STRETCHES, 1]);
    }
}
