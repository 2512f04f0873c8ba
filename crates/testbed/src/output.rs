//! The outputs of the program: printed text, written files, and the checks before.

use std::io::Write;
use std::path::Path;

use anyhow::bail;
use serde::Serialize;

use crate::models::ModelKind;
use crate::simulation::Outcome;

/// The tracking error of one model, as JSON has it.
#[derive(Serialize)]
pub struct Tracking {
    /// The model.
    pub model: ModelKind,
    /// Root mean square, one per joint (rad, or m).
    pub rms_error_rad: Vec<f64>,
    /// Largest, one per joint (rad, or m).
    pub max_error_rad: Vec<f64>,
}

impl Tracking {
    /// The tracking error of a run under `model`.
    pub fn new(model: ModelKind, outcome: &Outcome) -> Self {
        Self {
            model,
            rms_error_rad: outcome.rms_error.clone(),
            max_error_rad: outcome.max_error.clone(),
        }
    }
}

/// Prints `text` on standard output. A reader that stops (`| head`) is no error.
///
/// # Errors
/// If it cannot be written for another reason.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(anyhow::Error::new(error).context("printing the result"))
        }
        _ => Ok(()),
    }
}

/// Writes `value` as JSON to `path`, completely or not at all.
///
/// # Errors
/// If the file cannot be written.
pub fn write_json(path: &Path, value: &impl Serialize) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(value)?;
    recording::write_whole(path, |file| writeln!(file, "{text}"))?;
    Ok(())
}

/// Writes `text` to `path`, completely or not at all.
///
/// # Errors
/// If the file cannot be written.
pub fn write_text(path: &Path, text: &str) -> anyhow::Result<()> {
    recording::write_whole(path, |file| file.write_all(text.as_bytes()))?;
    Ok(())
}

/// Refuses a file that could not be written, before any work is done for it.
///
/// # Errors
/// If its folder does not exist or cannot be written to, or the path is a folder.
pub fn check_writable(path: &Path) -> anyhow::Result<()> {
    if path.is_dir() {
        bail!("{}: is a folder; give the name of a file", path.display());
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if let Err(error) = tempfile::tempfile_in(folder) {
        bail!(
            "{}: cannot be written: {error}; {}",
            path.display(),
            recording::write_remedy(&error)
        );
    }
    Ok(())
}

/// Refuses an output that is one of the `inputs`: what the user had would be lost.
///
/// # Errors
/// If it is.
pub fn check_is_no_input<'a>(path: &Path, inputs: impl Iterator<Item = &'a Path>) -> anyhow::Result<()> {
    for input in inputs {
        if study::is_same(path, input) {
            bail!(
                "{}: is read as {}; write to another file",
                path.display(),
                input.display()
            );
        }
    }
    Ok(())
}
