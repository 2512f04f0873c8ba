//! The quality of a recording, before anything is fitted to it.

mod findings;
mod joint;
mod measures;
mod slopes;
mod velocity;

use serde::Serialize;

use crate::{Recording, RegularRecording};

pub use findings::{Finding, FindingKind};
pub use joint::JointQuality;

/// The quality of one recording: its clock, its joints, and doubtful properties.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quality {
    /// Rows that were read.
    pub rows: usize,
    /// The time from the first stamp to the last (s).
    pub duration: f64,
    /// The number of ticks per second (Hz).
    pub rate: f64,
    /// Whether the stamps have a regular clock.
    pub has_clock: bool,
    /// Distance of the stamps from the clock, root mean square (s).
    pub jitter_rms: f64,
    /// Distance of the stamps from the clock, largest (s).
    pub jitter_max: f64,
    /// The number of missing rows in short gaps, which are interpolated.
    pub lost_rows: usize,
    /// The number of pieces between long gaps.
    pub segments: usize,
    /// The longest gap (s); 0 if there is none.
    pub longest_gap: f64,
    /// Each joint.
    pub joints: Vec<JointQuality>,
    /// Doubtful properties, the most serious first.
    pub findings: Vec<Finding>,
}

impl Quality {
    /// The quality of `recording`, where `regular` is the same recording on its clock.
    pub fn of(recording: &Recording, regular: &RegularRecording) -> Self {
        let motions: Vec<slopes::Slopes> =
            regular.q.iter().map(|q| slopes::Slopes::of(q, &regular.segments, regular.period)).collect();
        let mut joints: Vec<JointQuality> = (0..regular.joints.len())
            .map(|joint| JointQuality::of(recording, regular, joint, &motions[joint]))
            .collect();
        let swapped = velocity::compare(regular, &motions, &mut joints);
        let findings = findings::of(regular, &joints, &swapped);
        let gaps = regular.segments.windows(2).map(|pair| {
            let end = pair[0].start + pair[0].ticks.len() as f64 * regular.period;
            pair[1].start - end
        });
        Self {
            rows: recording.len(),
            duration: recording.duration(),
            rate: 1.0 / regular.period,
            has_clock: regular.has_clock,
            jitter_rms: regular.jitter_rms,
            jitter_max: regular.jitter_max,
            lost_rows: regular.present.iter().filter(|present| !**present).count(),
            segments: regular.segments.len(),
            longest_gap: gaps.fold(0.0, f64::max),
            joints,
            findings,
        }
    }
}

#[cfg(test)]
mod tests;
