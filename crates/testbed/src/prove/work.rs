//! Work on several threads, with progress, until it is done or the user interrupts.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::interrupt;
use crate::progress::Progress;
use anyhow::bail;

/// Does `work` on all `items` in their order, `jobs` at a time, and shows progress of `what`. The first error ends it.
///
/// # Errors
/// The first error, or that the user interrupted.
pub fn all<T: Sync>(
    what: &'static str,
    items: &[T],
    jobs: usize,
    work: impl Fn(&T) -> anyhow::Result<()> + Sync,
) -> anyhow::Result<()> {
    let progress = Progress::new(what);
    let (next, finished, failed) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicBool::new(false));
    let error = Mutex::new(None);
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, items.len().max(1)) {
            scope.spawn(|| {
                while !interrupt::requested() && !failed.load(Ordering::SeqCst) {
                    let Some(item) = items.get(next.fetch_add(1, Ordering::SeqCst)) else {
                        break;
                    };
                    match work(item) {
                        Ok(()) => {
                            let done = 1 + finished.fetch_add(1, Ordering::SeqCst);
                            let share = done as f64 / items.len() as f64;
                            progress.done(share, format!("{what}: {done} of {}", items.len()));
                        }
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
    progress.finish();
    if interrupt::requested() {
        bail!("interrupted; the same command goes on where it stopped");
    }
    match error.into_inner() {
        Ok(Some(reason)) => Err(reason),
        _ => Ok(()),
    }
}
