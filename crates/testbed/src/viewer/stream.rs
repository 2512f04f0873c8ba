//! The thread between the run and Rerun, so that a slow, ended or absent viewer cannot delay the run.

use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use arm::Arm;

use super::Sink;
use super::batch::Batch;
use super::end::End;
use super::worker::{Job, Worker};

/// The capacity of the queue of batches; further rows wait in the sender.
const QUEUE: usize = 4;
/// The largest number of rows that wait for a live viewer that is too slow.
const MOST_WAITING_ROWS: usize = 100_000;
/// The time that a viewer that has answered before has for the end of the run.
const FAREWELL: Duration = Duration::from_secs(3);

/// The outcome of sending a batch.
pub enum Sent {
    /// The batch is in the queue, or the viewer is lost.
    Done,
    /// The queue is full; the batch is returned.
    Busy(Batch),
}

/// The sending end of a thread that owns the recording, and the result of that thread.
pub struct Stream {
    jobs: Option<SyncSender<Job>>,
    verdict: Receiver<anyhow::Result<()>>,
    failure: Option<anyhow::Error>,
    /// The time until which to wait for a viewer that has never answered; `None` for a file.
    patience: Option<Instant>,
}

impl Stream {
    /// Opens the sink and starts the thread, which begins with the scene.
    pub fn open(sink: &Sink, title: &str, arm: &Arm, urdf_path: &Path) -> anyhow::Result<Self> {
        let (end, patience) = End::open(sink)?;
        let worker = Worker {
            recording: end.record(title, arm)?,
            end,
            title: title.to_owned(),
            arm: arm.clone(),
            urdf_path: urdf_path.to_owned(),
            patience,
        };
        let (jobs, inbox) = sync_channel(QUEUE);
        let (report, verdict) = channel();
        thread::Builder::new()
            .name("viewer".to_owned())
            .spawn(move || {
                // The receiver no longer exists if the viewer was given up.
                let _ = report.send(worker.run(&inbox));
            })
            .context("starting the viewer's thread")?;
        Ok(Self { jobs: Some(jobs), verdict, failure: None, patience })
    }

    /// Whether it still takes batches.
    pub fn is_alive(&self) -> bool {
        self.jobs.is_some()
    }

    /// Whether the destination is a live viewer.
    pub fn is_live(&self) -> bool {
        self.patience.is_some()
    }

    /// Passes a batch to the thread; waits for a file, but never for a viewer.
    pub fn send(&mut self, batch: Batch) -> Sent {
        let Some(jobs) = &self.jobs else {
            return Sent::Done;
        };
        if !self.is_live() {
            if jobs.send(Job::Batch(batch)).is_err() {
                self.lose();
            }
            return Sent::Done;
        }
        match jobs.try_send(Job::Batch(batch)) {
            Ok(()) => Sent::Done,
            Err(TrySendError::Full(Job::Batch(batch) | Job::Last(batch))) => {
                if batch.scalars.len() < MOST_WAITING_ROWS {
                    return Sent::Busy(batch);
                }
                self.jobs = None;
                warn("the viewer does not keep up: the rest of the run is not shown");
                Sent::Done
            }
            Err(TrySendError::Disconnected(_)) => {
                self.lose();
                Sent::Done
            }
        }
    }

    /// Passes the last batch to the thread and waits for the end: without limit for a file, for a limited time for a
    /// viewer.
    pub fn finish(mut self, rest: Batch) -> anyhow::Result<()> {
        let Some(jobs) = self.jobs.take() else {
            return self.failure.take().map_or(Ok(()), Err);
        };
        let Some(patience) = self.patience else {
            // A thread that has ended has left its result.
            let _ = jobs.send(Job::Last(rest));
            return self.verdict.recv().unwrap_or_else(|_| bail_lost());
        };
        // One second more than the thread's own limit, so that the thread can report the reason.
        let deadline = (patience + Duration::from_secs(1)).max(Instant::now() + FAREWELL);
        let mut job = Job::Last(rest);
        while let Err(TrySendError::Full(back)) = jobs.try_send(job) {
            if Instant::now() > deadline {
                warn("the viewer does not keep up: the rest of the run is not shown");
                return Ok(());
            }
            job = back;
            thread::sleep(Duration::from_millis(5));
        }
        match self.verdict.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            Ok(Ok(())) => {}
            Ok(Err(error)) => warn(&format!("{error:#}")),
            Err(RecvTimeoutError::Timeout) => warn("the viewer did not take the end of the run in time"),
            Err(RecvTimeoutError::Disconnected) => warn("the viewer's thread is gone"),
        }
        Ok(())
    }

    /// The thread has ended early: this is a warning for a viewer, and the error of [`Self::finish`] for a file.
    fn lose(&mut self) {
        self.jobs = None;
        let verdict = match self.verdict.recv_timeout(Duration::from_secs(1)) {
            Ok(verdict) => verdict,
            Err(_) => bail_lost(),
        };
        let Err(error) = verdict else { return };
        if self.is_live() {
            warn(&format!("{error:#}"));
        } else {
            self.failure = Some(error);
        }
    }
}

impl Drop for Stream {
    /// If [`Stream::finish`] was not called, gives the thread a moment to remove an unfinished file.
    fn drop(&mut self) {
        let was_open = self.jobs.take().is_some();
        if was_open && !self.is_live() {
            // Whether the thread has ended or is late, nothing more can be done.
            let _ = self.verdict.recv_timeout(FAREWELL);
        }
    }
}

fn bail_lost() -> anyhow::Result<()> {
    bail!("the viewer's thread is gone")
}

fn warn(what: &str) {
    crate::output::say(format_args!("warning: {what}"));
}
