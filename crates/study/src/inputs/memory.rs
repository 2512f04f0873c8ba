//! Limits the memory that long recordings take.

use diagnosis::worth_using;
use recording::RegularRecording;

use super::Prepared;

/// The recording without signals that no diagnosis uses.
pub(super) fn without_unused(mut recording: RegularRecording) -> RegularRecording {
    recording.qd = None;
    recording.qdd = None;
    recording.temperature = Vec::new();
    recording.others = Vec::new();
    recording
}

/// The largest part of a recording that is held, as a multiple of the part that is used. More than one leaves a choice of
/// windows.
const HELD: f64 = 2.0;

/// Reduces the recordings of each role to windows if they are longer than a diagnosis uses.
pub(super) fn bound(list: &mut [Prepared]) {
    for is_fitted in [true, false] {
        let recordings = list
            .iter_mut()
            .filter(|prepared| prepared.role.is_fitted() == is_fitted)
            .map(|prepared| &mut prepared.regular);
        bound_together(recordings.collect());
    }
}

/// Thins each of the `recordings` of one role until at most [`HELD`] times its used part is held, or until it cannot be
/// thinned further.
fn bound_together(recordings: Vec<&mut RegularRecording>) {
    let recorded: Vec<f64> = recordings.iter().map(|recording| recording.recorded()).collect();
    for (recording, worth) in recordings.into_iter().zip(worth_using(&recorded)) {
        while recording.held() > HELD * worth && recording.thin() {}
    }
}

#[cfg(test)]
mod tests {
    use recording::Segment;

    use super::*;

    fn recording(seconds: usize) -> RegularRecording {
        let ticks = 100 * seconds;
        RegularRecording {
            period: 0.01,
            segments: vec![Segment { ticks: 0..ticks, start: 0.0 }],
            present: vec![true; ticks],
            ..RegularRecording::default()
        }
    }

    fn held(seconds: &[usize]) -> Vec<f64> {
        let mut recordings: Vec<RegularRecording> = seconds.iter().map(|&seconds| recording(seconds)).collect();
        bound_together(recordings.iter_mut().collect());
        recordings.iter().map(RegularRecording::held).collect()
    }

    #[test]
    fn recordings_that_are_short_together_are_held_whole() {
        assert_eq!(held(&[500, 300]), [500.0, 300.0]);
    }

    #[test]
    fn long_recordings_are_held_in_equal_parts() {
        let held = held(&[3600, 3600, 1000]);
        assert!(held.iter().all(|held| (80.0..=160.0).contains(held)), "{held:?}");
    }

    /// The order in which the recordings are read does not matter.
    #[test]
    fn a_short_recording_beside_a_long_one_is_held_whole() {
        for others in [vec![86_400], vec![3600, 3600]] {
            for at in 0..=others.len() {
                let mut seconds = others.clone();
                seconds.insert(at, 10);
                let held = held(&seconds);
                assert_eq!(held[at], 10.0, "{seconds:?}");
                assert!(held.iter().sum::<f64>() <= 490.0, "{held:?}");
            }
        }
    }

    #[test]
    fn many_short_recordings_remain_long_enough_to_be_filtered() {
        assert!(held(&[15; 100]).iter().all(|seconds| *seconds > 4.0));
    }
}
