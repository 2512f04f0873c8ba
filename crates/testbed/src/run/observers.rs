//! The observers of a run: its progress and the viewer.

use std::path::{Path, PathBuf};

use crate::cli::{Rerun, RunArgs};
use crate::models::ModelKind;
use crate::progress::Progress;
use crate::scenario::Scenario;
use crate::simulation::Observer;
use crate::telemetry::Sample;

/// The progress of a run in simulated time.
pub struct Simulating {
    progress: Progress,
    duration: f64,
    tenths: u64,
}

impl Simulating {
    /// The progress of a run of `duration` (s).
    pub fn new(duration: f64) -> Self {
        Self { progress: Progress::new("simulating"), duration, tenths: 0 }
    }

    /// Ends it.
    pub fn finish(&self) {
        self.progress.finish();
    }
}

impl Observer for Simulating {
    fn sample(&mut self, sample: &Sample<'_>) {
        let tenths = (sample.time * 10.0) as u64;
        if tenths > self.tenths {
            self.tenths = tenths;
            let share = sample.time / self.duration;
            self.progress.done(share, format!("simulating {:.0} %", 100.0 * share));
        }
    }
}

/// The file that Rerun saves to according to `args`; `None` if it saves none.
pub fn rerun_file(args: &RunArgs, folder: &Path) -> Option<PathBuf> {
    match &args.rerun {
        None | Some(Rerun::Save(None)) if cfg!(feature = "viewer") => Some(folder.join("run.rrd")),
        Some(Rerun::Save(Some(file))) => Some(file.clone()),
        _ => None,
    }
}

/// Refuses a request that Rerun could not fulfil.
///
/// # Errors
/// If the program was built without it, or the file to save to is a folder.
pub fn check_rerun(args: &RunArgs) -> anyhow::Result<()> {
    match &args.rerun {
        Some(Rerun::Save(_) | Rerun::Spawn | Rerun::Connect(_)) if cfg!(not(feature = "viewer")) => {
            anyhow::bail!("--rerun needs a program built with the feature \"viewer\", which this one lacks")
        }
        Some(Rerun::Save(Some(file))) if file.is_dir() => {
            anyhow::bail!("--rerun save={}: is a folder; give the name of a file", file.display())
        }
        _ => Ok(()),
    }
}

/// The viewer of a run, or none.
#[cfg(feature = "viewer")]
pub struct View(Option<crate::viewer::Viewer>);

#[cfg(feature = "viewer")]
impl View {
    /// Opens the viewer that `args` request.
    ///
    /// # Errors
    /// If the file cannot be created, or no viewer can be started.
    pub fn open(args: &RunArgs, kind: ModelKind, scenario: &Scenario, file: Option<&Path>) -> anyhow::Result<Self> {
        use crate::viewer::{Sink, Viewer};
        use anyhow::Context;
        let sink = match (&args.rerun, file) {
            (Some(Rerun::Spawn), _) => Sink::Spawn,
            (Some(Rerun::Connect(url)), _) => Sink::Connect(url.clone()),
            (_, Some(file)) => Sink::Save(file.to_owned()),
            (_, None) => return Ok(Self(None)),
        };
        let title = format!("{}, {}, seed {}", scenario.title, kind.title(), args.seed);
        let viewer = Viewer::open(&sink, &title, &scenario.arm, &scenario.urdf).context("opening Rerun")?;
        Ok(Self(Some(viewer)))
    }

    /// Ends the recording, and returns whether a file was saved. An error of the viewer does not end the run; it is a
    /// warning.
    pub fn finish(self) -> bool {
        match self.0.map(crate::viewer::Viewer::finish) {
            Some(Err(error)) => {
                crate::output::say(format_args!("warning: {error:#}; the run goes on without it"));
                false
            }
            Some(Ok(())) => true,
            None => false,
        }
    }
}

#[cfg(feature = "viewer")]
impl Observer for View {
    fn wants_variance(&self) -> bool {
        self.0.is_some()
    }

    fn sample(&mut self, sample: &Sample<'_>) {
        if let Some(viewer) = &mut self.0 {
            viewer.log(sample);
        }
    }
}

/// This program was built without Rerun.
#[cfg(not(feature = "viewer"))]
pub struct View;

#[cfg(not(feature = "viewer"))]
impl View {
    /// Nothing to open.
    ///
    /// # Errors
    /// None.
    pub fn open(_: &RunArgs, _: ModelKind, _: &Scenario, _: Option<&Path>) -> anyhow::Result<Self> {
        Ok(Self)
    }

    /// Nothing was saved.
    pub fn finish(self) -> bool {
        false
    }
}

#[cfg(not(feature = "viewer"))]
impl Observer for View {
    fn sample(&mut self, _: &Sample<'_>) {}
}
