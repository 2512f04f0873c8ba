//! The decisions of a diagnosis as CSV: one row per decision, in order.

use std::path::Path;

use anyhow::Context;
use diagnosis::Decision;

use crate::output;

/// Writes `decisions` to `path`, completely or not at all. `nats` is the gain of the whole step, on each of its rows.
///
/// # Errors
/// If it cannot be written.
pub fn write(path: &Path, decisions: &[Decision]) -> anyhow::Result<()> {
    let mut rows = csv::Writer::from_writer(Vec::new());
    rows.write_record(["step", "action", "effect", "joint", "rule", "nats"])?;
    for decision in decisions {
        rows.write_record([
            &decision.step.to_string(),
            &decision.action.to_string(),
            &decision.effect,
            decision.joint.as_deref().unwrap_or_default(),
            decision.rule,
            &format!("{:.2}", decision.nats),
        ])?;
    }
    let text = rows.into_inner().context("writing the trace")?;
    output::write_text(path, &String::from_utf8(text)?)
}
