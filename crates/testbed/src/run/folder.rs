//! The folder of a run: checked before any work, made after the training, removed if the run has no results.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};

use crate::alone::Alone;
use crate::output;

/// The folder of a run, removed again if the run fails and nothing else is in it.
pub struct RunFolder {
    /// Its path.
    pub path: PathBuf,
    created: bool,
    _alone: Option<Alone>,
}

impl RunFolder {
    /// Checks that `out` (or `runs/` without it) is a writable folder or can be made.
    ///
    /// # Errors
    /// If it cannot.
    pub fn check(out: Option<&Path>) -> anyhow::Result<()> {
        let folder = out.unwrap_or(Path::new("runs"));
        let remedy = || format!("{}: the run's folder cannot be made; give another with --out DIR", folder.display());
        let mut existing = folder;
        while !existing.exists() {
            existing = match existing.parent() {
                Some(parent) if !parent.as_os_str().is_empty() => parent,
                _ => Path::new("."),
            };
        }
        ensure!(existing.is_dir(), "{} ({} is a file)", remedy(), existing.display());
        tempfile::tempfile_in(existing).with_context(remedy)?;
        let [recording, summary] = ["recording.csv", "summary.json"].map(|name| folder.join(name));
        let is_earlier = summary.is_file() && output::has_mark(&summary, "\"schema\": \"testbed.run/")?;
        for own in [&recording, &summary] {
            ensure!(
                is_earlier || out.is_none() || !own.exists(),
                "{}: exists and is not of an earlier run; give another folder with --out DIR",
                own.display()
            );
        }
        Ok(())
    }

    /// Makes `out`, or a new `runs/<number>-<name>`, with a number one above the largest existing one.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn create(out: Option<&Path>, name: &str) -> anyhow::Result<Self> {
        let remedy =
            |path: &Path| format!("{}: the run's folder cannot be made; give another with --out DIR", path.display());
        if let Some(out) = out {
            let created = !out.exists();
            std::fs::create_dir_all(out).with_context(|| remedy(out))?;
            return Ok(Self { _alone: Some(Alone::in_folder(out)?), path: out.to_owned(), created });
        }
        let runs = Path::new("runs");
        std::fs::create_dir_all(runs).with_context(|| remedy(runs))?;
        for number in last_number(runs) + 1.. {
            let path = runs.join(format!("{number:03}-{name}"));
            match std::fs::create_dir(&path) {
                Ok(()) => {
                    return Ok(Self { path, created: true, _alone: None });
                }
                // Another run has taken this number.
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error).with_context(|| remedy(&path)),
            }
        }
        bail!("runs/ is full: all run numbers are in use; give a folder with --out DIR")
    }
}

impl Drop for RunFolder {
    fn drop(&mut self) {
        if self.created {
            // Only an empty folder is removed; a folder with results remains.
            let _ = std::fs::remove_dir(&self.path);
        }
    }
}

fn last_number(runs: &Path) -> u32 {
    let entries = std::fs::read_dir(runs).into_iter().flatten().flatten();
    let number_of = |name: &str| name.split('-').next().and_then(|number| number.parse::<u32>().ok());
    let numbers = entries.filter_map(|entry| number_of(&entry.file_name().to_string_lossy()));
    numbers.max().unwrap_or(0)
}

/// Refuses outputs that are the same file, or that would replace an input.
///
/// # Errors
/// If two coincide, with both uses.
pub fn check_distinct(outputs: &[(&str, PathBuf)], inputs: &[(&str, PathBuf)]) -> anyhow::Result<()> {
    let same = |a: &Path, b: &Path| std::path::absolute(a).ok() == std::path::absolute(b).ok();
    for (k, (what, path)) in outputs.iter().enumerate() {
        let others = outputs[k + 1..].iter().chain(inputs);
        for (other, other_path) in others {
            ensure!(
                !same(path, other_path),
                "{}: is both {what} and {other}; give one of them another name",
                path.display()
            );
        }
    }
    Ok(())
}

/// Refuses a `--json` file that could not be written; it may lie in the run's folder, which is made later.
///
/// # Errors
/// If its folder does not exist or cannot be written to.
pub fn check_json(json: &Path, out: Option<&Path>) -> anyhow::Result<()> {
    if out.is_some_and(|out| json.parent() == Some(out) && !out.exists()) {
        return Ok(());
    }
    output::check_writable(json)
}
