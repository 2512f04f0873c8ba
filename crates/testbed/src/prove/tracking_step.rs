//! Tracking as a step of the protocol, with one complete file per case. Finished files are not made again.

use std::path::PathBuf;

use anyhow::Context;
use faults::{SealedCase, sha256, sha256_of};
use serde::{Deserialize, Serialize};

use super::case_paths::CasePaths;
use super::cases::Cases;
use super::rows;
use super::tracking::Case;
use super::vault::{Vault, made_of};
use crate::output;

/// Tracks the task on the machine of a case whose truth is `truth`, into `tracking/CASE.json` (and `CASE.rrd`, with the viewer), unless
/// that is done.
///
/// # Errors
/// If the seal is broken, or the case cannot be tracked.
pub fn track(source: &Cases, vault: &Vault, place: &CasePaths, sealed: &SealedCase, truth: &str) -> anyhow::Result<()> {
    let model = vault.model(&format!("diagnoses/{}", place.name))?;
    let named = sha256(model.as_deref().unwrap_or_default().as_bytes());
    let made_of = made_of([&vault.program.sha256, &sealed.inputs(), &sealed.truth, &named]);
    let (path, timeline) = (file(vault, place, "json"), file(vault, place, "rrd"));
    let done = file(vault, place, "done.json");
    let timeline = cfg!(feature = "viewer").then_some(timeline);
    // A result whose inputs have changed is made again.
    let is_done = || -> Option<bool> {
        let there: Done = serde_json::from_str(&std::fs::read_to_string(&done).ok()?).ok()?;
        let as_it_was = there.sha256 == sha256(&std::fs::read(&path).ok()?);
        let is_drawn = timeline.as_ref().is_none_or(|timeline| timeline.is_file());
        Some(there.made_of == made_of && as_it_was && is_drawn)
    };
    if is_done() == Some(true) {
        return Ok(());
    }
    sealed.check_files(&place.folder)?;
    let truth = rows::truth(&place.name, truth)?;
    let case = Case {
        robot: source.robot(place).with_context(|| format!("{}: was not drawn", place.name))?,
        folder: &place.folder,
        truth: &truth,
        named: model.as_deref(),
    };
    // One thread per case, because cases already run in parallel.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().context("starting a thread")?;
    let tracking = pool.install(|| case.track(made_of.clone(), timeline.as_deref()))?;
    output::write_json(&path, &tracking)?;
    let sha256 = sha256_of(&path)?;
    output::write_json(&done, &Done { made_of, sha256 })
}

/// The record of a finished step.
#[derive(Deserialize, Serialize)]
struct Done {
    /// SHA-256 of its inputs.
    made_of: String,
    /// SHA-256 of the file.
    sha256: String,
}

/// The result of a finished step.
///
/// # Errors
/// If it cannot be read.
pub fn text(vault: &Vault, place: &CasePaths) -> anyhow::Result<String> {
    let path = file(vault, place, "json");
    std::fs::read_to_string(&path).with_context(|| path.display().to_string())
}

fn file(vault: &Vault, place: &CasePaths, extension: &str) -> PathBuf {
    vault.out.join("tracking").join(format!("{}.{extension}", place.name))
}
