//! Progress on standard error with the time left: a line that changes on a terminal, plain lines elsewhere.

use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

/// Tasks that end sooner have no time left and no plain lines.
const SHORT: Duration = Duration::from_secs(2);
/// The least pause between plain lines, as a part of the time so far, so that hours do not fill a log.
const SPARSE: f64 = 0.1;

/// The progress of one task.
pub struct Progress {
    bar: ProgressBar,
    clock: Arc<Mutex<Clock>>,
    is_plain: bool,
}

/// The progress of a task in time.
struct Clock {
    started: Instant,
    /// The part that is done, and the time at which it was reached.
    done: f64,
    at: Instant,
    /// The time of the last plain line.
    said: Option<Instant>,
}

impl Clock {
    /// The remaining time if the rest is as fast as the part that is done; `None` at the beginning, when the estimate is
    /// too uncertain.
    fn left(&self, now: Instant) -> Option<Duration> {
        if self.done < 0.02 || now - self.started < SHORT {
            return None;
        }
        let whole = (self.at - self.started).mul_f64(1.0 / self.done);
        Some(whole.saturating_sub(now - self.started))
    }
}

impl Progress {
    /// Progress that begins with `message`.
    pub fn new(message: impl Into<String>) -> Self {
        let now = Instant::now();
        let clock = Arc::new(Mutex::new(Clock { started: now, done: 0.0, at: now, said: None }));
        let bar = ProgressBar::new_spinner();
        let shown = Arc::clone(&clock);
        let left = move |_: &ProgressState, text: &mut dyn Write| {
            if let Some(left) = shown.lock().ok().and_then(|clock| clock.left(Instant::now())) {
                let _ = write!(text, ", about {} left", words(left));
            }
        };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} ({elapsed}{left})") {
            bar.set_style(style.with_key("left", left));
        }
        bar.set_message(message.into());
        bar.enable_steady_tick(Duration::from_millis(100));
        Self { bar, clock, is_plain: !std::io::stderr().is_terminal() }
    }

    /// Hidden progress.
    pub fn hidden() -> Self {
        let mut progress = Self::new("");
        progress.bar = ProgressBar::hidden();
        progress.is_plain = false;
        progress
    }

    /// Shows a message; the part that is done does not change.
    pub fn doing(&self, message: impl Into<String>) {
        self.done(0.0, message);
    }

    /// Shows a message after the part `done` of the task, which never decreases.
    pub fn done(&self, done: f64, message: impl Into<String>) {
        let message = crate::output::message(&message.into());
        self.bar.set_message(message.clone());
        let Ok(mut clock) = self.clock.lock() else { return };
        let now = Instant::now();
        if done > clock.done {
            (clock.done, clock.at) = (done, now);
        }
        if !self.is_plain {
            return;
        }
        let passed = now - clock.started;
        let pause = SHORT.max(passed.mul_f64(SPARSE));
        if passed >= SHORT && clock.said.is_none_or(|said| now - said >= pause) {
            clock.said = Some(now);
            let left = clock.left(now).map(|left| format!(", about {} left", words(left)));
            crate::output::say(format_args!("{message} ({}{})", words(passed), left.unwrap_or_default()));
        }
    }

    /// Prints to standard error beside the line that changes.
    pub fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Removes the line that changes.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Equal pieces of work, which are counted when they are done, on any thread.
pub struct Pieces<'a> {
    progress: &'a Progress,
    what: String,
    count: usize,
    /// The part of the task that all pieces make up.
    share: f64,
    done: AtomicUsize,
}

impl<'a> Pieces<'a> {
    /// `count` pieces of `what`, with which the part `share` of the task is done.
    pub fn new(progress: &'a Progress, what: impl Into<String>, count: usize, share: f64) -> Self {
        let (what, done) = (what.into(), AtomicUsize::new(0));
        progress.doing(what.clone());
        Self { progress, what, count, share, done }
    }

    /// Counts one more piece as done.
    pub fn next(&self) {
        let done = 1 + self.done.fetch_add(1, Ordering::Relaxed);
        let part = self.share * done as f64 / self.count.max(1) as f64;
        let (what, count) = (&self.what, self.count);
        self.progress.done(part, format!("{what}: {done} of {count}"));
    }
}

/// `45 s`, `3 min`, `2 h 10 min`.
fn words(time: Duration) -> String {
    let seconds = time.as_secs_f64().round() as u64;
    match (seconds, (seconds + 30) / 60) {
        (0..100, _) => format!("{seconds} s"),
        (_, minutes @ 0..100) => format!("{minutes} min"),
        (_, minutes) => format!("{} h {} min", minutes / 60, minutes % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remaining_time_is_in_proportion_to_the_remaining_part() {
        let now = Instant::now();
        let clock = |done: f64| Clock { started: now, done, at: now + Duration::from_secs(10), said: None };
        let later = now + Duration::from_secs(15);
        assert_eq!(clock(0.25).left(later), Some(Duration::from_secs(25)));
        assert_eq!(clock(0.9).left(later), Some(Duration::ZERO));
        assert_eq!(clock(0.0).left(later), None);
        assert_eq!(clock(0.5).left(now + Duration::from_secs(1)), None);
    }

    #[test]
    fn pieces_are_counted_on_any_thread() {
        let progress = Progress::hidden();
        let pieces = Pieces::new(&progress, "training", 8, 0.8);
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| (0..2).for_each(|_| pieces.next()));
            }
        });
        let done = progress.clock.lock().expect("no thread panicked").done;
        assert!((done - 0.4).abs() < 1e-12, "{done}");
        assert_eq!(pieces.done.load(Ordering::Relaxed), 4);
    }

    #[test]
    fn times_are_words() {
        let said = [0, 99, 100, 3600, 6000, 7800].map(|seconds| words(Duration::from_secs(seconds)));
        assert_eq!(said, ["0 s", "99 s", "2 min", "60 min", "1 h 40 min", "2 h 10 min"]);
    }
}
