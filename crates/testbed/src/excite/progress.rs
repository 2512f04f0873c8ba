//! How far the search is: a bar with the time left, or plain lines where there is no terminal.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Nothing is said of what takes no longer than this; then a line as often, where there is no terminal.
const QUIET: Duration = Duration::from_secs(2);
const PAUSE: Duration = Duration::from_secs(10);
/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// The progress of one piece of work.
pub struct Progress {
    what: &'static str,
    begun: Instant,
    /// When the next line is due, where there is no terminal.
    next: Option<Mutex<Instant>>,
    bar: ProgressBar,
}

impl Progress {
    /// Begins `what`.
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
