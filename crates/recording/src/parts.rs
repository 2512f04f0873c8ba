//! A part of a regular recording that stands for the whole: windows spread evenly over it.

use std::ops::Range;

use crate::windows::is_taken;
use crate::{RegularRecording, Segment};

/// The length of a window (s).
const WINDOW: f64 = 20.0;
/// What is not longer is not cut (s).
const SHORTEST: f64 = 10.0;

impl RegularRecording {
    /// The time that is held (s).
    pub fn held(&self) -> f64 {
        self.len() as f64 * self.period
    }

    /// The time that was recorded (s).
    pub fn recorded(&self) -> f64 {
        self.held() + self.left_out
    }

    /// Removes about half of the recording. It keeps windows of at most 20 s that are spread evenly, or the middle of a single window.
    /// Returns whether anything was removed: less than 10 s are kept as they are.
    pub fn thin(&mut self) -> bool {
        if self.held() < SHORTEST {
            return false;
        }
        let before = self.len();
        let kept = self.windows();
        let start_of = |window: &Range<usize>| self.time(window.start);
        let mut ticks = 0;
        let segments: Vec<Segment> = kept
            .iter()
            .map(|window| {
                let from = ticks;
                ticks += window.len();
                Segment { ticks: from..ticks, start: start_of(window) }
            })
            .collect();
        keep(&mut self.present, &kept);
        self.channels_mut().for_each(|(_, values)| keep(values, &kept));
        self.segments = segments;
        self.left_out += (before - self.len()) as f64 * self.period;
        self.len() < before
    }

    /// The windows to be kept, in order.
    fn windows(&self) -> Vec<Range<usize>> {
        let most = ((WINDOW / self.period).ceil() as usize).max(1);
        let windows: Vec<Range<usize>> = self
            .segments
            .iter()
            .flat_map(|segment| {
                let ticks = segment.ticks.clone();
                let length = ticks.len().div_ceil(ticks.len().div_ceil(most).max(1)).max(1);
                let starts = ticks.clone().step_by(length);
                starts.map(move |start| start..(start + length).min(ticks.end))
            })
            .collect();
        match &windows[..] {
            [one] => {
                let quarter = one.len() / 4;
                std::iter::once(one.start + quarter..one.end - quarter).collect()
            }
            _ => {
                let taken = |(number, _): &(usize, &Range<usize>)| is_taken(*number as f64, 1);
                let kept = windows.iter().enumerate().filter(taken);
                kept.map(|(_, window)| window.clone()).collect()
            }
        }
    }
}

/// Keeps only the ranges `kept` of `values`, which are in order.
fn keep<T: Copy>(values: &mut Vec<T>, kept: &[Range<usize>]) {
    let mut to = 0;
    for window in kept {
        values.copy_within(window.clone(), to);
        to += window.len();
    }
    values.truncate(to);
    values.shrink_to_fit();
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time as the position, at 10 Hz, with a gap.
    fn regular() -> RegularRecording {
        let ticks = 5000;
        let time: Vec<f64> = (0..ticks).map(|tick| tick as f64 * 0.1 + if tick < 3000 { 0.0 } else { 50.0 }).collect();
        RegularRecording {
            joints: vec!["a".into()],
            period: 0.1,
            segments: vec![Segment { ticks: 0..3000, start: 0.0 }, Segment { ticks: 3000..ticks, start: 350.0 }],
            present: vec![true; ticks],
            q: vec![time.clone()],
            tau: vec![time.clone()],
            tau_current: vec![Some(time)],
            ..RegularRecording::default()
        }
    }

    #[test]
    fn what_is_left_keeps_its_time() {
        let mut recording = regular();
        while recording.thin() {
            assert!((recording.recorded() - 500.0).abs() < 1e-9);
            assert_eq!(recording.q[0].len(), recording.len());
            for (time, q) in recording.times().zip(&recording.q[0]) {
                assert!((time - q).abs() < 1e-6, "{time} {q}");
            }
            assert_eq!(recording.q[0], recording.tau[0]);
            assert_eq!(Some(&recording.q[0]), recording.tau_current[0].as_ref());
            assert!(recording.segments.iter().all(|segment| segment.ticks.len() <= 200));
        }
        assert!((4.0..10.0).contains(&recording.held()), "{}", recording.held());
    }

    #[test]
    fn half_is_left_from_beginning_to_end() {
        let mut recording = regular();
        assert!(recording.thin());
        assert!((200.0..300.0).contains(&recording.held()), "{}", recording.held());
        assert!(recording.q[0].iter().any(|q| *q < 20.0) && recording.q[0].iter().any(|q| *q > 480.0));
    }
}
