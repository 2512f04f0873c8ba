//! A diagnosis in its own process, in a folder that contains only the recordings and the URDF.

use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context, bail};

use super::case_paths::Files;
use crate::interrupt;

/// The file name of the recording of a proposed motion.
pub const MORE: &str = "train_next.csv";
/// The file name of the scenario of a proposed motion.
pub const NEXT: &str = "next.toml";

/// The outcome of the process.
pub enum Ended {
    /// It wrote a diagnosis.
    Answer {
        /// The diagnosis.
        json: String,
        /// The named effects in the format of `diagnose --known`; `None` if effects were given.
        model: Option<String>,
        /// The proposed motion as a scenario.
        next: Option<String>,
    },
    /// It failed; this is the last line of its messages.
    Failed(String),
}

/// The task of the process.
#[derive(Clone, Copy, Debug, Default)]
pub struct Task<'a> {
    /// The effects to fit without a search; `None` searches all effects.
    pub only: Option<&'a str>,
    /// Whether it is to propose the next experiment.
    pub next: bool,
    /// An additional training recording.
    pub more: Option<&'a Path>,
}

/// Effects in the format of `--only`.
pub fn list(terms: &[scoring::Name]) -> String {
    let words = terms.iter().map(|(effect, joint)| match joint {
        Some(joint) => format!("{effect}:{joint}"),
        None => effect.clone(),
    });
    words.collect::<Vec<_>>().join(",")
}

/// Diagnoses the files of `folder`: `program diagnose --robot … --train … --held-out … --json out.json --jobs 1`, with
/// `--model model.toml` or the effects to fit in `--only`, and the other options of `task`. The process has no environment
/// variables, and starts in a new folder with copies of the files.
///
/// # Errors
/// If it cannot be started, or the user interrupts.
pub fn diagnose(program: &Path, folder: &Path, files: &Files, task: Task<'_>) -> anyhow::Result<Ended> {
    let room = tempfile::Builder::new().prefix("case-").tempdir()?;
    for name in files.all() {
        let from = folder.join(name);
        std::fs::copy(&from, room.path().join(name)).with_context(|| from.display().to_string())?;
    }
    if let Some(more) = task.more {
        std::fs::copy(more, room.path().join(MORE)).with_context(|| more.display().to_string())?;
    }
    let mut errors = tempfile::tempfile()?;
    let mut command = Command::new(program);
    command.current_dir(room.path()).env_clear();
    command.args(["diagnose", "--robot", &files.robot, "--train"]).args(&files.train).args(task.more.map(|_| MORE));
    command.arg("--held-out").args(&files.held_out);
    command.args(["--json", "out.json", "--jobs", "1"]);
    match task.only {
        // Of a hypothesis, only the torques are scored.
        Some(only) => command.args(["--only", only, "--torques-only"]),
        None => command.args(["--model", "model.toml"]),
    };
    if task.next {
        command.args(["--next", NEXT]);
    }
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(errors.try_clone()?);
    let mut child = command.spawn().with_context(|| program.display().to_string())?;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if interrupt::requested() {
            // The process may have ended already, because Ctrl-C also reaches it.
            let _ = child.kill();
            child.wait()?;
            bail!("interrupted");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    if interrupt::requested() {
        bail!("interrupted");
    }
    if status.success() {
        let read = |name: &str| std::fs::read_to_string(room.path().join(name)).context(name.to_owned());
        let is_there = room.path().join(NEXT).is_file();
        return Ok(Ended::Answer {
            json: read("out.json")?,
            model: task.only.is_none().then(|| read("model.toml")).transpose()?,
            next: is_there.then(|| read(NEXT)).transpose()?,
        });
    }
    errors.seek(SeekFrom::Start(0))?;
    let mut text = Vec::new();
    errors.read_to_end(&mut text)?;
    let text = String::from_utf8_lossy(&text);
    let last = text.lines().rev().find(|line| !line.trim().is_empty());
    Ok(Ended::Failed(last.map_or_else(|| status.to_string(), str::to_owned)))
}
