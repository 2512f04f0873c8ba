//! The windows of a bag, whose messages come from several topics and in any order.
//!
//! Each window is the same stretch of time, whatever messages come when: a message is kept if its time lies in a window that is
//! taken. So what is kept depends on the first message's time only, not on the order of the others, and is the same time of all topics.

use std::collections::BTreeMap;

use crate::windows::is_taken;

const SECOND: i64 = 1_000_000_000;
/// The length of a window, in whole seconds.
const WINDOW: i64 = 20;

/// Which messages are kept.
#[derive(Debug)]
pub struct BagWindows {
    /// The time to be held at most, beside a window (s).
    most: u64,
    /// Of 2^level windows, one is taken.
    level: i32,
    /// The time that windows are counted from (ns): that of the first message.
    origin: Option<i64>,
    /// The seconds of each window in which there are messages, one a bit.
    seen: BTreeMap<i64, u32>,
    /// The second of the last message.
    last: Option<i64>,
    /// The seconds with messages: of all windows, and of those that are taken.
    all: u64,
    held: u64,
}

impl BagWindows {
    /// Windows of `seconds` (s) in all.
    pub fn new(seconds: f64) -> Self {
        Self { most: seconds as u64, level: 0, origin: None, seen: BTreeMap::new(), last: None, all: 0, held: 0 }
    }

    /// Counts a message at `time` (ns); whether it is kept. If windows are given up, `give_up` is called: messages that
    /// [`Self::takes`] no longer takes are to be removed.
    pub fn wants(&mut self, time: i64, give_up: impl FnOnce(&Self)) -> bool {
        let second = self.second(time);
        if self.last != Some(second) {
            self.last = Some(second);
            self.count(second);
            if self.held > self.most + WINDOW.unsigned_abs() {
                while self.held > self.most {
                    self.thin();
                }
                give_up(self);
            }
        }
        self.takes(time)
    }

    fn second(&mut self, time: i64) -> i64 {
        let origin = *self.origin.get_or_insert(time);
        time.saturating_sub(origin).div_euclid(SECOND)
    }

    fn count(&mut self, second: i64) {
        let number = second.div_euclid(WINDOW);
        let seen = self.seen.entry(number).or_default();
        let bit = 1 << second.rem_euclid(WINDOW);
        if *seen & bit == 0 {
            *seen |= bit;
            self.all += 1;
            self.held += u64::from(is_taken(number as f64, self.level));
        }
    }

    fn thin(&mut self) {
        self.level += 1;
        let taken = self.seen.iter().filter(|(number, _)| is_taken(**number as f64, self.level));
        self.held = taken.map(|(_, seconds)| u64::from(seconds.count_ones())).sum();
    }

    /// Whether a message at `time` (ns) is kept.
    pub fn takes(&self, time: i64) -> bool {
        let second = time.saturating_sub(self.origin.unwrap_or(time)).div_euclid(SECOND);
        is_taken(second.div_euclid(WINDOW) as f64, self.level)
    }

    /// The time of what is not kept (s).
    pub fn left_out(&self) -> f64 {
        (self.all - self.held) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BEGINS: i64 = 1_700_000_000_000_000_000;

    /// The times that are kept of messages at `times` (s after the beginning), in order, and the time of the rest (s).
    fn kept(times: impl Iterator<Item = f64>) -> (Vec<i64>, f64) {
        let mut windows = BagWindows::new(100.0);
        let mut kept: Vec<i64> = Vec::new();
        for time in times {
            let time = BEGINS + (time * 1e9).round() as i64;
            if windows.wants(time, |windows| kept.retain(|&time| windows.takes(time))) {
                kept.push(time);
            }
        }
        kept.sort_unstable();
        (kept, windows.left_out())
    }

    #[test]
    fn what_is_kept_of_a_long_bag_is_spread_over_it() {
        let (kept, left_out) = kept((0..100_000).map(|message| f64::from(message) * 0.01));
        let held = kept.len() as f64 * 0.01;
        assert!((45.0..125.0).contains(&held), "{held}");
        assert!((held + left_out - 1000.0).abs() < 1.0);
        assert!(kept[0] == BEGINS && kept[kept.len() - 1] > BEGINS + 700 * SECOND);
    }

    #[test]
    fn what_is_kept_does_not_depend_on_the_order() {
        let time = |message: u32| f64::from(message) * 0.01;
        let all = 100_000;
        let in_order = kept((0..all).map(time));
        // Neighbours exchanged, and the first half after the second one (whose first message remains the first).
        let exchanged = (0..all)
            .map(|message| time(if message > 0 && message + 1 < all { ((message - 1) ^ 1) + 1 } else { message }));
        let (first, second) = (1..all / 2, all / 2..all);
        let halves = std::iter::once(0).chain(second).chain(first).map(time);
        assert_eq!(kept(exchanged), in_order);
        assert_eq!(kept(halves), in_order);
    }

    /// A second topic after the first, or beside it, is kept in the same windows, and is no more time.
    #[test]
    fn two_topics_have_the_same_windows() {
        let one: Vec<f64> = (0..100_000).map(|message| f64::from(message) * 0.01).collect();
        let (alone, left_out) = kept(one.iter().copied());
        let (both, left_out_of_both) = kept(one.iter().chain(&one).copied());
        assert_eq!((both.len(), left_out_of_both), (2 * alone.len(), left_out));
    }

    #[test]
    fn messages_before_the_first_are_thinned_too() {
        let back = (0..100_000).map(|message| -f64::from(message) * 0.01);
        let (kept, left_out) = kept(back);
        assert!((4500..12_500).contains(&kept.len()) && left_out > 800.0, "{}", kept.len());
    }

    /// Once a second, and with a pause.
    #[test]
    fn slow_messages_count_as_time_and_pauses_do_not() {
        let slow = (0..1000).map(|message| f64::from(message) + if message < 500 { 0.0 } else { 70_000.0 });
        let (kept, left_out) = kept(slow);
        assert!((45..125).contains(&kept.len()), "{}", kept.len());
        assert_eq!(kept.len() as f64 + left_out, 1000.0);
    }
}
