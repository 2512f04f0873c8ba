//! An `.rrd` file that is whole or absent: written beside its name, then renamed.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use anyhow::Context as _;
use rerun::external::re_build_info::CrateVersion;
use rerun::external::re_log_encoding::{Encoder, EncodingOptions};
use rerun::log::LogMsg;
use rerun::sink::{LogSink, SinkFlushError};

/// The file that is being written. As a sink, it is cloned into the recording; [`Self::finish`] returns its errors.
#[derive(Clone)]
pub struct RrdFile {
    path: PathBuf,
    partial: PathBuf,
    state: Arc<Mutex<State>>,
}

struct State {
    encoder: Option<Encoder<BufWriter<File>>>,
    error: Option<String>,
}

impl RrdFile {
    /// Creates `.<name>.partial` beside `path`, and the folder if it does not exist.
    pub fn create(path: &Path) -> anyhow::Result<Self> {
        let name = path.file_name().with_context(|| format!("{} names no file", path.display()))?;
        let partial = path.with_file_name(format!(".{}.partial", name.to_string_lossy()));
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).with_context(|| format!("creating {}", folder.display()))?;
        }
        let file = File::create(&partial).with_context(|| format!("creating {}", partial.display()))?;
        let options = EncodingOptions::PROTOBUF_COMPRESSED;
        let encoder = Encoder::new_eager(CrateVersion::LOCAL, options, BufWriter::new(file))
            .with_context(|| format!("writing {}", partial.display()))?;
        Ok(Self {
            path: path.to_owned(),
            partial,
            state: Arc::new(Mutex::new(State { encoder: Some(encoder), error: None })),
        })
    }

    /// The final path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the first error so far.
    pub fn check(&self) -> anyhow::Result<()> {
        match &self.lock().error {
            Some(error) => anyhow::bail!("writing {}: {error}", self.path.display()),
            None => Ok(()),
        }
    }

    /// Ends the file and gives it its name.
    pub fn finish(&self) -> anyhow::Result<()> {
        self.check()?;
        let mut encoder = self.lock().encoder.take().context("the file is closed already")?;
        let context = || format!("writing {}", self.path.display());
        encoder.finish().with_context(context)?;
        let writer = encoder.into_inner().with_context(context)?;
        let file = writer.into_inner().with_context(context)?;
        file.sync_all().with_context(context)?;
        std::fs::rename(&self.partial, &self.path).with_context(context)
    }

    /// Removes the unfinished file; a finished one remains.
    pub fn abandon(&self) {
        self.lock().encoder = None;
        // After `finish`, the partial file no longer exists. An error of the removal cannot be handled, and the file
        // remains.
        let _ = std::fs::remove_file(&self.partial);
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl LogSink for RrdFile {
    fn send(&self, message: LogMsg) {
        let mut state = self.lock();
        if state.error.is_some() {
            return;
        }
        let result = state.encoder.as_mut().map(|encoder| encoder.append(&message));
        if let Some(Err(error)) = result {
            state.error = Some(error.to_string());
        }
    }

    fn flush_blocking(&self, _timeout: Duration) -> Result<(), SinkFlushError> {
        Ok(())
    }
}
