//! The destination of a recording: a file, or a viewer that runs already, is started, or will be started later.

use std::str::FromStr as _;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use arm::Arm;
use rerun::external::re_uri::ProxyUri;
use rerun::log::ChunkBatcherConfig;
use rerun::sink::{GrpcSink, LogSink};
use rerun::{ApplicationId, RecordingStream, RecordingStreamBuilder, SpawnError, SpawnOptions};

use super::Sink;
use super::file::RrdFile;

/// The destination of the recording.
pub enum End {
    File(RrdFile),
    Remote(ProxyUri),
}

impl End {
    /// Opens the destination; for a viewer, also returns the time until which to wait for its first answer.
    pub fn open(sink: &Sink) -> anyhow::Result<(Self, Option<Instant>)> {
        let wait = |seconds| Some(Instant::now() + Duration::from_secs(seconds));
        match sink {
            Sink::Save(path) => Ok((Self::File(RrdFile::create(path)?), None)),
            Sink::Spawn => Ok((Self::Remote(spawn()?), wait(20))),
            Sink::Connect(address) => Ok((Self::Remote(parse(address.as_deref())?), wait(5))),
        }
    }

    /// Starts the recording. The identifier of a file follows from its title and path, so that it is reproducible and a
    /// viewer distinguishes two runs. A live recording has a new identifier each time.
    pub fn record(&self, title: &str, arm: &Arm) -> anyhow::Result<RecordingStream> {
        // A viewer stores one layout per application, so that each arm is an application.
        let application = ApplicationId::try_new(format!("testbed_{}", arm.name()))?;
        let mut builder = RecordingStreamBuilder::new(application).enabled(true);
        let sink: Box<dyn LogSink> = match self {
            Self::File(file) => {
                let id = format!("{title}, {}", file.path().display());
                // Batches depend on the data and not on the clock, so that the file is reproducible.
                let batching = ChunkBatcherConfig::NEVER;
                builder = builder.recording_id(id).send_properties(false).batcher_config(batching);
                Box::new(file.clone())
            }
            Self::Remote(uri) => Box::new(GrpcSink::new(uri.clone())),
        };
        let (_, info, properties, batching, hooks, _) = builder.into_args();
        let recording = RecordingStream::new(info, properties, batching, hooks, sink)?;
        recording.set_log_time_enabled(false);
        Ok(recording)
    }
}

fn parse(address: Option<&str>) -> anyhow::Result<ProxyUri> {
    let url = match address {
        None => rerun::DEFAULT_CONNECT_URL.to_owned(),
        Some(url) if url.contains("://") => url.to_owned(),
        Some(host) => format!("rerun+http://{host}/proxy"),
    };
    ProxyUri::from_str(&url)
        .with_context(|| format!("{url} is no address of a Rerun viewer (rerun+http://host:port/proxy)"))
}

fn spawn() -> anyhow::Result<ProxyUri> {
    let options = SpawnOptions {
        hide_welcome_screen: true,
        // By default, the viewer would accept recordings from the whole network.
        extra_args: vec!["--bind=127.0.0.1".to_owned()],
        extra_env: vec![("RUST_LOG".to_owned(), "error".to_owned())],
        ..SpawnOptions::default()
    };
    match rerun::spawn(&options) {
        Ok(info) => parse(Some(&format!("127.0.0.1:{}", info.port))),
        Err(SpawnError::ExecutableNotFoundInPath { .. } | SpawnError::ExecutableNotFound { .. }) => bail!(
            "there is no `rerun` in the PATH: install it with `pip install rerun-sdk==0.36.3` or \
             `cargo install rerun-cli --version 0.36.3 --locked`; `--rerun save=FILE` needs no viewer"
        ),
        Err(SpawnError::Io(error)) => Err(error).context("starting `rerun`"),
    }
}
