//! The memory that recordings take, however long and many they are.

use diagnosis::worth_holding;
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

/// Leaves windows of the recordings of each role, if they are longer than a diagnosis uses; most is taken from those of which most
/// is held.
pub(super) fn bound(list: &mut [Prepared]) {
    for is_fitted in [true, false] {
        let mut recordings: Vec<&mut RegularRecording> = list
            .iter_mut()
            .filter(|prepared| prepared.role.is_fitted() == is_fitted)
            .map(|prepared| &mut prepared.regular)
            .collect();
        let recorded = recordings.iter().map(|recording| recording.recorded()).sum();
        bound_together(&mut recordings, worth_holding(recorded));
    }
}

/// Thins `recordings` until they hold `most` (s) together, or none can be thinned.
fn bound_together(recordings: &mut [&mut RegularRecording], most: f64) {
    let mut can_be: Vec<usize> = (0..recordings.len()).collect();
    while recordings.iter().map(|recording| recording.held()).sum::<f64>() > most {
        let share = |&at: &usize| recordings[at].held() / recordings[at].recorded();
        // Of equal ones, the first.
        let next = can_be
            .iter()
            .copied()
            .rev()
            .max_by(|a, b| share(a).total_cmp(&share(b)));
        let Some(next) = next else { return };
        if !recordings[next].thin() {
            can_be.retain(|&at| at != next);
        }
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
            segments: vec![Segment {
                ticks: 0..ticks,
                start: 0.0,
            }],
            present: vec![true; ticks],
            ..RegularRecording::default()
        }
    }

    fn held(seconds: &[usize], most: f64) -> Vec<f64> {
        let mut recordings: Vec<RegularRecording> = seconds.iter().map(|&seconds| recording(seconds)).collect();
        let mut all: Vec<&mut RegularRecording> = recordings.iter_mut().collect();
        bound_together(&mut all, most);
        recordings.iter().map(RegularRecording::held).collect()
    }

    #[test]
    fn what_is_short_together_stays() {
        assert_eq!(held(&[500, 300], 1000.0), [500.0, 300.0]);
    }

    #[test]
    fn long_recordings_share_what_is_held() {
        let held = held(&[3600, 3600, 900], 1000.0);
        let total: f64 = held.iter().sum();
        assert!((450.0..=1000.0).contains(&total), "{held:?}");
        let shares: Vec<f64> = held
            .iter()
            .zip([3600.0, 3600.0, 900.0])
            .map(|(held, all)| held / all)
            .collect();
        assert!(shares.iter().all(|share| (0.04..0.3).contains(share)), "{shares:?}");
    }

    #[test]
    fn many_short_ones_stay_long_enough_to_be_filtered() {
        assert!(held(&[15; 100], 100.0).iter().all(|seconds| *seconds > 4.0));
    }
}
