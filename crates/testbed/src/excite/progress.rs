//! The progress of the search: a bar with the remaining time, or plain lines without a terminal.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// The duration below which no progress is shown, and the interval between lines without a terminal.
const QUIET: Duration = Duration::from_secs(2);
const PAUSE: Duration = Duration::from_secs(10);
/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// The progress of one piece of work.
pub struct Progress {
    what: &'static str,
    begun: Instant,
    /// The time of the next line, without a terminal.
    next: Option<Mutex<Instant>>,
    bar: ProgressBar,
}

impl Progress {
    /// Begins the progress of `what`.
    pub fn new(what: &'static str) -> Self {
        let bar = ProgressBar::new(STEPS as u64);
        if let Ok(style) = ProgressStyle::with_template("{msg} {bar:40} {percent} %  ({eta} left)") {
            bar.set_style(style);
        }
        bar.set_message(what);
        let begun = Instant::now();
        let next = (!std::io::stderr().is_terminal()).then(|| Mutex::new(begun + QUIET));
        Self { what, begun, next, bar }
    }

    /// The part that is done, from 0 to 1.
    pub fn set(&self, part: f64) {
        self.bar.set_position((STEPS * part) as u64);
        let Some(next) = &self.next else { return };
        let mut next = next.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let now = Instant::now();
        if now >= *next && part > 0.0 && part < 1.0 {
            *next = now + PAUSE;
            let left = now.duration_since(self.begun).as_secs_f64() * (1.0 - part) / part;
            eprintln!("{}: {:.0} %, about {left:.0} s left", self.what, 100.0 * part);
        }
    }

    /// Ends it.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
