//! The windows of a bag, whose messages come from several topics and not quite in order.

use std::ops::Range;

use crate::windows::{Next, Windows};

/// Which messages are kept.
#[derive(Debug)]
pub struct BagWindows {
    windows: Windows,
    /// The number and the beginning (ns) of each window that is kept.
    begun: Vec<(u64, i64)>,
    /// The time that seconds are counted from (ns).
    origin: Option<i64>,
}

impl BagWindows {
    /// Windows of `seconds` (s) in all.
    pub fn new(seconds: f64) -> Self {
        Self {
            windows: Windows::new(seconds),
            begun: Vec::new(),
            origin: None,
        }
    }

    /// Counts a message at `time` (ns); whether it is kept. If windows are given up, `keep` receives the times that stay.
    pub fn wants(&mut self, time: i64, mut keep: impl FnMut(&[Range<i64>])) -> bool {
        let origin = *self.origin.get_or_insert(time);
        let seconds = time.saturating_sub(origin) as f64 * 1e-9;
        if let Next::Begins(number) = self.windows.next(seconds, false) {
            while self.windows.is_full() {
                self.windows.thin();
                let ends = self.begun.iter().skip(1).map(|(_, begins)| *begins).chain([time]);
                let spans = self
                    .begun
                    .iter()
                    .zip(ends)
                    .map(|(&(number, begins), end)| (number, begins..end));
                let spans: Vec<Range<i64>> = spans
                    .filter(|(number, _)| self.windows.takes(*number))
                    .map(|(_, span)| span)
                    .collect();
                keep(&spans);
                self.begun.retain(|(number, _)| self.windows.takes(*number));
            }
            if self.windows.takes(number) {
                self.begun.push((number, time));
            }
        }
        self.windows.takes_now()
    }

    /// The time of what is not kept (s).
    pub fn left_out(&self) -> f64 {
        self.windows.left_out()
    }
}

/// Whether one of `spans`, which are in order, holds `time`.
pub fn is_in(spans: &[Range<i64>], time: i64) -> bool {
    let next = spans.partition_point(|span| span.end <= time);
    spans.get(next).is_some_and(|span| span.contains(&time))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_of_a_long_bag_is_spread_over_it() {
        let mut windows = BagWindows::new(100.0);
        let mut kept: Vec<i64> = Vec::new();
        let begins = 1_700_000_000_000_000_000_i64;
        for message in 0..100_000 {
            let time = begins + message * 10_000_000;
            if windows.wants(time, |spans| kept.retain(|&time| is_in(spans, time))) {
                kept.push(time);
            }
        }
        let held = kept.len() as f64 * 0.01;
        assert!((45.0..125.0).contains(&held), "{held}");
        assert!((held + windows.left_out() - 1000.0).abs() < 1.0);
        assert!(kept[0] == begins && kept[kept.len() - 1] > begins + 700_000_000_000);
    }
}
