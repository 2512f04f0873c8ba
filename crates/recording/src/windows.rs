//! Windows spread evenly over the whole of a long recording, chosen while its rows come, so that no more is held in memory.
//!
//! Time is counted in windows. Once more than the wanted time is held, every other window is given up, and of those to come
//! every other one is taken, and so on: of a recording of any length, between half of the wanted time and all of it is held.

/// The length of a window (s).
const WINDOW: f64 = 20.0;
/// Rows that are further apart (s) have a pause between them, which does not count, unless the step before was about as long.
const LONGEST_STEP: f64 = 0.15;
/// Steps up to this multiple of the step before are no pauses: the rows are slow.
const ALIKE: f64 = 3.0;
/// A longer step is a pause, whatever the step before (s): a row alone between two pauses makes none of them time.
const SLOWEST_STEP: f64 = 10.0;
/// The golden ratio. The fractional parts of its multiples are spread evenly, so that the windows are not in step with a
/// motion that is repeated.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Which windows are held.
#[derive(Debug)]
pub struct Windows {
    /// The time to be held at most, beside the last window (s).
    most: f64,
    /// Of 2^level windows, one is taken.
    level: i32,
    /// The number of the window, its time so far and the time of its last row (s).
    number: u64,
    covered: f64,
    last: Option<f64>,
    /// The step to the last row (s).
    step: f64,
    /// The complete windows that are held, with their time (s).
    held: Vec<(u64, f64)>,
    /// The time of all complete windows (s).
    all: f64,
}

/// What the next row does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// It is in the same window as the row before.
    SameWindow,
    /// A window begins with it, which has this number.
    Begins(u64),
}

impl Windows {
    /// Windows of which `most` (s) are held: all of a recording that is not longer.
    pub fn new(most: f64) -> Self {
        Self { most, level: 0, number: 0, covered: 0.0, last: None, step: 0.0, held: Vec::new(), all: 0.0 }
    }

    /// Counts a row at `time` (s). If a window begins with it, call [`Self::is_full`] next. `is_large` ends a window before its time.
    pub fn next(&mut self, time: f64, is_large: bool) -> Next {
        let Some(last) = self.last else {
            self.last = Some(time);
            return Next::Begins(self.number);
        };
        let step = time - last;
        let before = std::mem::replace(&mut self.step, step);
        let is_pause = step >= LONGEST_STEP && (step > ALIKE * before || step > SLOWEST_STEP);
        self.covered += if is_pause { 0.0 } else { step.max(0.0) };
        self.last = Some(time.max(last));
        if self.covered < WINDOW && !is_large {
            return Next::SameWindow;
        }
        if self.takes_now() {
            self.held.push((self.number, self.covered));
        }
        self.all += self.covered;
        self.number += 1;
        self.covered = 0.0;
        Next::Begins(self.number)
    }

    /// Whether more than the wanted time is held: [`Self::thin`] then.
    pub fn is_full(&self) -> bool {
        self.time_held() > self.most
    }

    /// Gives up every other window; the caller does the same with those that are no longer taken.
    pub fn thin(&mut self) {
        self.level += 1;
        let level = self.level;
        self.held.retain(|(number, _)| is_taken(*number as f64, level));
    }

    fn time_held(&self) -> f64 {
        self.held.iter().map(|(_, seconds)| seconds).sum()
    }

    /// The time of what is not held (s).
    pub fn left_out(&self) -> f64 {
        let present = if self.takes_now() { 0.0 } else { self.covered };
        self.all - self.time_held() + present
    }

    /// Whether the window with this number is held.
    pub fn takes(&self, number: u64) -> bool {
        is_taken(number as f64, self.level)
    }

    /// Whether the present window is held.
    pub fn takes_now(&self) -> bool {
        self.takes(self.number)
    }
}

/// Whether the window with this whole number, which may be negative, is one of the 2^−`level` that are taken.
pub fn is_taken(number: f64, level: i32) -> bool {
    (GOLDEN * number).rem_euclid(1.0) < 0.5_f64.powi(level)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The windows that are held of `seconds` at 100 Hz.
    fn held(seconds: u64, most: f64) -> Vec<u64> {
        held_at(100, seconds, most).0
    }

    /// The windows that are held of `seconds` at `rate` (Hz), and the time of the rest (s).
    fn held_at(rate: u64, seconds: u64, most: f64) -> (Vec<u64>, f64) {
        let mut windows = Windows::new(most);
        let mut held = Vec::new();
        for row in 0..rate * seconds {
            if let Next::Begins(number) = windows.next(row as f64 / rate as f64, false) {
                while windows.is_full() {
                    windows.thin();
                    held.retain(|&number| windows.takes(number));
                }
                if windows.takes_now() {
                    held.push(number);
                }
            }
        }
        (held, windows.left_out())
    }

    /// A day at 1 to 8 Hz is read in windows as one at 100 Hz is.
    #[test]
    fn slow_rows_are_time() {
        for rate in [1, 2, 5, 6, 8] {
            let (held, left_out) = held_at(rate, 86_400, 1000.0);
            assert!((23..=53).contains(&held.len()), "{rate} Hz: {}", held.len());
            let all = 20.0 * held.len() as f64 + left_out;
            assert!((all - 86_400.0).abs() < 25.0, "{rate} Hz: {all}");
        }
    }

    #[test]
    fn a_short_recording_is_held_whole() {
        assert_eq!(held(990, 1000.0), (0..50).collect::<Vec<u64>>());
    }

    #[test]
    fn of_a_long_one_windows_are_held_from_beginning_to_end() {
        for seconds in [1100, 3600, 20_000, 86_400] {
            let held = held(seconds, 1000.0);
            let all = seconds / 20;
            let count = held.len() as u64;
            assert!((23..=53).contains(&count), "{seconds} s: {count}");
            // From one to the next is at most three times the mean, with the ends.
            let ends = [0].into_iter().chain(held.iter().copied()).chain([all]);
            let ends: Vec<u64> = ends.collect();
            let longest = ends.windows(2).map(|pair| pair[1] - pair[0]).max();
            assert!(longest.is_some_and(|longest| longest <= 3 * all / count + 1), "{seconds} s: {held:?}");
            assert_eq!(held[0], 0);
            // They are not in step with a motion of a few windows.
            for period in 2..6 {
                let most = (0..period).map(|phase| held.iter().filter(|&&number| number % period == phase).count());
                assert!(most.max().is_some_and(|most| (most as u64) * period < 2 * count + period), "{held:?}");
            }
        }
    }

    #[test]
    fn a_pause_is_no_time() {
        let mut windows = Windows::new(1000.0);
        windows.next(0.0, false);
        assert_eq!(windows.next(5000.0, false), Next::SameWindow);
        assert_eq!(windows.next(5000.01, false), Next::SameWindow);
        assert_eq!(windows.next(9000.0, false), Next::SameWindow);
        // A row alone between two pauses does not make the second one time.
        assert_eq!(windows.next(13_000.0, false), Next::SameWindow);
    }
}
