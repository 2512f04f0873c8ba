//! Tracking as a step of the protocol: a file a case, whole, that is not made again.

use std::path::PathBuf;

use anyhow::Context;
use proof::{SealedCase, sha256};

use super::{Case, CaseTracking, made_of};
use crate::output;
use crate::prove::cases::{Place, Source};
use crate::prove::rows;
use crate::prove::vault::Vault;

/// Tracks the task on the machine of a case whose truth is `truth`, into `tracking/CASE.json` (and `CASE.rrd`, with the viewer), unless
/// that is done.
///
/// # Errors
/// If the seal is broken, or the case cannot be tracked.
pub fn track(source: &Source, vault: &Vault, place: &Place, sealed: &SealedCase, truth: &str) -> anyhow::Result<()> {
    let model = vault.model(&format!("diagnoses/{}", place.name))?;
    let named = sha256(model.as_deref().unwrap_or_default().as_bytes());
    let made_of = made_of([&vault.program.sha256, &sealed.inputs(), &sealed.truth, &named]);
    let (path, timeline) = (file(vault, place, "json"), file(vault, place, "rrd"));
    let timeline = cfg!(feature = "viewer").then_some(timeline);
    let is_done = || {
        let text = std::fs::read_to_string(&path).ok()?;
        let there: CaseTracking = serde_json::from_str(&text).ok()?;
        Some(there.made_of == made_of && timeline.as_ref().is_none_or(|timeline| timeline.is_file()))
    };
    if is_done() == Some(true) {
        return Ok(());
    }
    sealed.check_files(&place.folder)?;
    let truth = rows::truth(&place.name, truth)?;
    let case = Case {
        robot: source
            .robot(place)
            .with_context(|| format!("{}: was not drawn", place.name))?,
        folder: &place.folder,
        truth: &truth,
        named: model.as_deref(),
    };
    // Cases are shared out to threads already.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .context("starting a thread")?;
    let tracking = pool.install(|| case.track(made_of, timeline.as_deref()))?;
    output::write_json(&path, &tracking)
}

/// What a finished step left.
///
/// # Errors
/// If it cannot be read.
pub fn text(vault: &Vault, place: &Place) -> anyhow::Result<String> {
    let path = file(vault, place, "json");
    std::fs::read_to_string(&path).with_context(|| path.display().to_string())
}

fn file(vault: &Vault, place: &Place, extension: &str) -> PathBuf {
    vault.out.join("tracking").join(format!("{}.{extension}", place.name))
}
