//! A diagnosis in a process of its own, in a folder that has the recordings and the URDF and nothing else.

use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context, bail};

use super::cases::Files;
use crate::interrupt;

/// What a child did.
pub enum Ended {
    /// The diagnosis it wrote, and the named effects as `diagnose --known` takes them (not where effects were given).
    Answer { json: String, model: Option<String> },
    /// The last line it wrote instead.
    Failed(String),
}

/// Diagnoses the files of `folder`: `program diagnose --robot … --train … --held-out … --json out.json --jobs 1`, with `--model
/// model.toml`, or else with what is to be fitted alone in `only`. The process gets no environment, and starts in a new folder with
/// copies of the files.
///
/// # Errors
/// If it cannot be started, or the user interrupts.
pub fn diagnose(program: &Path, folder: &Path, files: &Files, only: Option<&str>) -> anyhow::Result<Ended> {
    let room = tempfile::Builder::new().prefix("case-").tempdir()?;
    for name in files.all() {
        let from = folder.join(name);
        std::fs::copy(&from, room.path().join(name)).with_context(|| from.display().to_string())?;
    }
    let mut errors = tempfile::tempfile()?;
    let mut command = Command::new(program);
    command.current_dir(room.path()).env_clear();
    command
        .args(["diagnose", "--robot", &files.robot, "--train"])
        .args(&files.train);
    command.arg("--held-out").args(&files.held_out);
    command.args(["--json", "out.json", "--jobs", "1"]);
    match only {
        Some(only) => command.args(["--only", only]),
        None => command.args(["--model", "model.toml"]),
    };
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
        let model = only.is_none().then(|| read("model.toml")).transpose()?;
        let json = read("out.json")?;
        return Ok(Ended::Answer { json, model });
    }
    errors.seek(SeekFrom::Start(0))?;
    let mut text = Vec::new();
    errors.read_to_end(&mut text)?;
    let text = String::from_utf8_lossy(&text);
    let last = text.lines().rev().find(|line| !line.trim().is_empty());
    Ok(Ended::Failed(last.map_or_else(|| status.to_string(), str::to_owned)))
}
