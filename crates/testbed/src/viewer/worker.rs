//! The viewer's thread: everything that communicates with Rerun and may have to wait for it.

use std::path::PathBuf;
use std::sync::mpsc::Receiver;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use arm::Arm;
use rerun::RecordingStream;
use rerun::external::re_sdk_types::blueprint::components::PlayState;
use rerun::external::re_uri::ProxyUri;
use rerun::sink::SinkFlushError;

use super::batch::{ARMS, Batch};
use super::end::End;
use super::{blueprint, shapes};

/// The time that a viewer that has answered before has for a batch.
const ANSWER: Duration = Duration::from_secs(10);

/// A job of the thread.
pub enum Job {
    /// Send these rows.
    Batch(Batch),
    /// Send these rows and close.
    Last(Batch),
}

/// The data that the thread owns.
pub struct Worker {
    pub recording: RecordingStream,
    pub end: End,
    pub title: String,
    pub arm: Arm,
    pub urdf_path: PathBuf,
    pub patience: Option<Instant>,
}

impl Worker {
    /// Logs the scene, then all batches; the result is that of the whole recording.
    pub fn run(self, inbox: &Receiver<Job>) -> anyhow::Result<()> {
        let result = self.pass_on(inbox);
        let Self { recording, end, .. } = self;
        match end {
            End::File(file) => {
                drop(recording);
                let result = result.and_then(|()| file.finish());
                file.abandon();
                result
            }
            End::Remote(_) => {
                if result.is_ok() {
                    drop(recording);
                } else {
                    // Dropping it would wait for the viewer.
                    std::mem::forget(recording);
                }
                result
            }
        }
    }

    fn pass_on(&self, inbox: &Receiver<Job>) -> anyhow::Result<()> {
        let recording = &self.recording;
        recording.send_recording_name(self.title.as_str())?;
        shapes::log_scene(recording, &self.arm, &self.urdf_path, &ARMS)?;
        blueprint::log_styles(recording, &self.arm, &self.title)?;
        let mut is_first = true;
        let mut has_answered = false;
        loop {
            let job = inbox.recv().context("the run ended early")?;
            let (Job::Batch(batch) | Job::Last(batch)) = &job;
            if is_first {
                let (has_variance, play) = (batch.variance.len() > 0, self.play_state());
                blueprint::send(recording, &self.arm, has_variance, play)?;
                is_first = false;
            }
            batch.send(recording, &self.arm)?;
            match (&self.end, self.patience) {
                (End::Remote(uri), Some(patience)) => self.await_viewer(uri, patience, &mut has_answered)?,
                (End::File(file), _) => {
                    recording.flush_blocking().context("writing the recording")?;
                    file.check()?;
                }
                _ => {}
            }
            if matches!(job, Job::Last(_)) {
                return Ok(());
            }
        }
    }

    fn play_state(&self) -> PlayState {
        match self.end {
            End::File(_) => PlayState::Playing,
            End::Remote(_) => PlayState::Following,
        }
    }

    /// Waits until the viewer has taken everything so far.
    fn await_viewer(&self, uri: &ProxyUri, patience: Instant, has_answered: &mut bool) -> anyhow::Result<()> {
        let asked = Instant::now();
        loop {
            match self.recording.flush_with_timeout(Duration::from_millis(500)) {
                Ok(()) => {
                    *has_answered = true;
                    return Ok(());
                }
                Err(SinkFlushError::Failed { .. }) if *has_answered => {
                    bail!("the viewer at {uri} is gone: the rest of the run is not shown")
                }
                Err(SinkFlushError::Timeout) if *has_answered && asked.elapsed() > ANSWER => {
                    bail!("the viewer at {uri} does not answer any more: the rest of the run is not shown")
                }
                Err(_) if !*has_answered && Instant::now() > patience => {
                    bail!("no viewer answers at {uri}: the run is not shown")
                }
                Err(_) => thread::sleep(Duration::from_millis(20)),
            }
        }
    }
}
