//! A diagnosis in a process of its own, in a folder that has the recordings and the URDF and nothing else.

use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context, bail};

use super::cases::Files;
use crate::interrupt;

/// What a proposed motion's recording is called.
pub const MORE: &str = "train_next.csv";
/// What a proposed motion's scenario is called.
pub const NEXT: &str = "next.toml";

/// What a child did.
pub enum Ended {
    /// What it wrote.
    Answer {
        /// The diagnosis.
        json: String,
        /// The named effects as `diagnose --known` takes them (not where effects were given).
        model: Option<String>,
        /// The motion it proposed, as a scenario.
        next: Option<String>,
    },
    /// The last line it wrote instead.
    Failed(String),
}

/// What is asked of a child.
#[derive(Clone, Copy, Debug, Default)]
pub struct Task<'a> {
    /// What is to be fitted alone; all is searched if `None`.
    pub only: Option<&'a str>,
    /// Whether it is to propose the next experiment.
    pub next: bool,
    /// One recording to fit more.
    pub more: Option<&'a Path>,
}

/// Diagnoses the files of `folder`: `program diagnose --robot … --train … --held-out … --json out.json --jobs 1`, with `--model
/// model.toml` or what is to be fitted alone in `--only`, and what else `task` adds. The process gets no environment, and starts in a new
/// folder with copies of the files.
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
    command
        .args(["diagnose", "--robot", &files.robot, "--train"])
        .args(&files.train)
        .args(task.more.map(|_| MORE));
    command.arg("--held-out").args(&files.held_out);
    command.args(["--json", "out.json", "--jobs", "1"]);
    match task.only {
        // Of a hypothesis nothing is scored but the torques.
        Some(only) => command.args(["--only", only, "--torques-only"]),
        None => command.args(["--model", "model.toml"]),
    };
    if task.next {
        command.args(["--next", NEXT]);
    }
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(errors.try_clone()?);
    let mut child = command.spawn().with_context(|| program.display().to_string())?;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if interrupt::requested() {
            // It may be gone already: Ctrl-C reaches it, too.
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
