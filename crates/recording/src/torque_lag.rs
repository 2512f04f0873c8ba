//! Torques that were recorded later, or earlier, than the positions of the same rows.

use std::ops::Range;

use crate::interpolate::lagrange;
use crate::{Quantity, RegularRecording, Segment};

/// Samples on either side of an interpolated one.
const SIDE: usize = 2;

impl RegularRecording {
    /// The recording with the torque of each tick replaced by the one that was recorded `lag` (s) later; a negative lag is for torques
    /// that were recorded too early. Only [`tau`](Self::tau) is moved. Ticks at the ends of segments that have no torque then are left out.
    pub fn without_torque_lag(&self, lag: f64) -> Self {
        let late = lag / self.period;
        let whole = late.floor();
        let part = late - whole;
        let kept: Vec<Segment> = self.segments.iter().filter_map(|one| self.kept(one, whole as i64)).collect();
        let ranges: Vec<Range<usize>> = kept.iter().map(|segment| segment.ticks.clone()).collect();
        let moved = |signal: &[f64]| -> Vec<f64> {
            let at = |tick: usize| {
                let first = (tick as i64 + whole as i64) as usize + 1 - SIDE;
                let nodes = std::array::from_fn::<_, { 2 * SIDE }, _>(|k| (k as f64, signal[first + k]));
                lagrange(&nodes, (SIDE - 1) as f64 + part)
            };
            ranges.iter().cloned().flatten().map(at).collect()
        };
        let mut first = 0;
        let segments = kept.iter().map(|segment| {
            let ticks = first..first + segment.ticks.len();
            first = ticks.end;
            let start = segment.start;
            Segment { ticks, start }
        });
        let mut recording = self.clone();
        recording.segments = segments.collect();
        recording.start = recording.segments.first().map_or(self.start, |segment| segment.start);
        recording.present = of(&ranges, &self.present);
        for (meaning, values) in recording.channels_mut() {
            let is_torque = matches!(meaning, Some((Quantity::Torque, _)));
            *values = if is_torque { moved(values) } else { of(&ranges, values) };
        }
        recording
    }

    /// The ticks of a segment that have a torque `whole` ticks later, with those that interpolation needs; `None` if there are none.
    fn kept(&self, segment: &Segment, whole: i64) -> Option<Segment> {
        let Range { start, end } = segment.ticks;
        let first = start.max(usize::try_from(start as i64 - whole + SIDE as i64 - 1).unwrap_or(0));
        let last = end.min(usize::try_from(end as i64 - whole - SIDE as i64).unwrap_or(0));
        (first < last)
            .then(|| Segment { ticks: first..last, start: segment.start + (first - start) as f64 * self.period })
    }
}

/// The values at ticks in `ranges`.
fn of<T: Clone>(ranges: &[Range<usize>], values: &[T]) -> Vec<T> {
    ranges.iter().flat_map(|range| values[range.clone()].iter().cloned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two segments, with torques `lag` (s) behind the positions.
    fn recording(lag: f64) -> RegularRecording {
        let starts = [3.0, 9.0];
        let segments: Vec<Segment> =
            (0..).zip(starts).map(|(k, start)| Segment { ticks: 200 * k..200 * (k + 1), start }).collect();
        let mut recording = RegularRecording {
            joints: vec!["a".into()],
            start: 3.0,
            period: 0.01,
            segments,
            present: vec![true; 400],
            temperature: vec![None],
            ..RegularRecording::default()
        };
        let times: Vec<f64> = recording.times().collect();
        recording.q = vec![times.iter().map(|t| (2.0 * t).sin()).collect()];
        recording.tau = vec![times.iter().map(|t| (2.0 * (t - lag)).sin()).collect()];
        recording.others = vec![("mark".into(), times)];
        recording
    }

    #[test]
    fn torques_return_to_their_positions() {
        for lag in [0.0, 0.004, 0.02, 0.0337, -0.0146] {
            let mended = recording(lag).without_torque_lag(lag);
            let lost = 400 - mended.len();
            assert!(lost <= 2 * (2 + (lag.abs() / 0.01).ceil() as usize) + 2, "{lag}: {lost} lost");
            assert_eq!(mended.segments.len(), 2);
            assert!(mended.times().zip(&mended.others[0].1).all(|(tick, mark)| (tick - mark).abs() < 1e-9), "{lag}");
            let off = mended.q[0].iter().zip(&mended.tau[0]).map(|(q, tau)| (q - tau).abs());
            assert!(off.fold(0.0, f64::max) < 1e-6, "{lag}");
        }
    }

    #[test]
    fn a_segment_that_is_shorter_than_the_lag_is_left_out() {
        let mut recording = recording(0.5);
        recording.segments[0].ticks = 0..200;
        assert!(recording.without_torque_lag(5.0).is_empty());
        recording.segments = vec![Segment { ticks: 0..20, start: 3.0 }, Segment { ticks: 20..400, start: 9.0 }];
        let mended = recording.without_torque_lag(0.5);
        assert_eq!(mended.segments.len(), 1);
        assert_eq!(mended.start, mended.segments[0].start);
        assert!((mended.start - 9.0).abs() < 0.02);
    }
}
