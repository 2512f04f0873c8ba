//! Handles Ctrl-C: a run in its loop ends cleanly, any other work ends at once.

use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);
static IN_LOOP: AtomicBool = AtomicBool::new(false);

/// The exit code of an interrupted program, as shells have it.
pub const EXIT_CODE: u8 = 130;

/// Listens for Ctrl-C and SIGTERM from here on.
///
/// # Errors
/// If the system does not let it.
pub fn listen() -> anyhow::Result<()> {
    ctrlc::set_handler(|| {
        let again = REQUESTED.swap(true, Ordering::SeqCst);
        // Outside the loop, nothing has been written yet. A second Ctrl-C ends the program without waiting.
        if again || !IN_LOOP.load(Ordering::SeqCst) {
            eprintln!(
                "{}",
                if again {
                    "interrupted at once: what was being written stays as it was before, what is listed as written is complete"
                } else {
                    "interrupted; nothing was written, and what was there before is as it was"
                }
            );
            std::process::exit(i32::from(EXIT_CODE));
        }
    })?;
    Ok(())
}

/// While it exists, Ctrl-C only sets [`requested`].
pub struct Deferred(());

impl Deferred {
    /// Starts to defer.
    pub fn start() -> Self {
        IN_LOOP.store(true, Ordering::SeqCst);
        Self(())
    }
}

impl Drop for Deferred {
    fn drop(&mut self) {
        IN_LOOP.store(false, Ordering::SeqCst);
    }
}

/// Whether the user asked to stop.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
