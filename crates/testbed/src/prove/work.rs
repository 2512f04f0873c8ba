//! Work shared out to a few threads, with progress, until it is done or the user interrupts.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use anyhow::bail;
use indicatif::{ProgressBar, ProgressStyle};

use crate::interrupt;

/// Does `work` on all of `items`, `jobs` at once, in their order; says `what` is being done. The first error ends it.
///
/// # Errors
/// The first error, or that the user interrupted.
pub fn all<T: Sync>(
    what: &'static str,
    items: &[T],
    jobs: usize,
    work: impl Fn(&T) -> anyhow::Result<()> + Sync,
) -> anyhow::Result<()> {
    let progress = bar(what, items.len());
    let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let error = Mutex::new(None);
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, items.len().max(1)) {
            scope.spawn(|| {
                while !interrupt::requested() && !failed.load(Ordering::SeqCst) {
                    let Some(item) = items.get(next.fetch_add(1, Ordering::SeqCst)) else {
                        break;
                    };
                    match work(item) {
                        Ok(()) => progress.inc(1),
                        Err(reason) => {
                            failed.store(true, Ordering::SeqCst);
                            if let Ok(mut error) = error.lock() {
                                error.get_or_insert(reason);
                            }
                        }
                    }
                }
            });
        }
    });
    progress.finish_and_clear();
    if interrupt::requested() {
        bail!("interrupted; the same command goes on where it stopped");
    }
    match error.into_inner() {
        Ok(Some(reason)) => Err(reason),
        _ => Ok(()),
    }
}

/// A progress bar on standard error, hidden where that is no terminal.
fn bar(what: &'static str, count: usize) -> ProgressBar {
    let progress = ProgressBar::new(count as u64);
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos} of {len} ({elapsed}, {eta} left)") {
        progress.set_style(style);
    }
    progress.set_message(what);
    progress.enable_steady_tick(Duration::from_millis(200));
    progress
}
