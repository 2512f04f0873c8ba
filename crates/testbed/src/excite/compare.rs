//! The quality of recorded motions, for comparison with the proposed one.

use std::path::PathBuf;

use anyhow::{Context, ensure};
use arm::Arm;
use diagnosis::{Excitation, Input, MotionLimits, Quality};
use recording::{RegularRecording, Signal};

use study::named;

/// The recordings at `paths` with their names, joints in the order of `arm`.
///
/// # Errors
/// If one cannot be read, or lacks a joint of the arm.
pub fn read(paths: &[PathBuf], arm: &Arm) -> anyhow::Result<Vec<(String, RegularRecording)>> {
    let read = |path: &PathBuf| {
        let name = path.display().to_string();
        let recording = named::read(path, None, Some(arm))?;
        let (regular, _) = recording.regular().with_context(|| name.clone())?;
        let place = |joint: &arm::Joint| regular.joints.iter().position(|known| *known == joint.name);
        let lacking = arm.joints().iter().find(|joint| place(joint).is_none());
        ensure!(
            lacking.is_none(),
            "{name}: has no column q_{0} for joint \"{0}\"; give a recording of this robot",
            lacking.map_or("", |joint| joint.name.as_str())
        );
        let order: Vec<usize> = arm.joints().iter().filter_map(place).collect();
        let pick = |signal: &Signal| order.iter().map(|&joint| signal[joint].clone()).collect::<Signal>();
        let ordered = RegularRecording {
            joints: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
            q: pick(&regular.q),
            tau: pick(&regular.tau),
            ..regular
        };
        Ok((name, ordered))
    };
    paths.iter().map(read).collect()
}

/// The quality of each recording's motion for the parameters that the `proposed` motion determines.
///
/// # Errors
/// If a recording is too short.
pub fn qualities(
    recordings: &[(String, RegularRecording)],
    arm: &Arm,
    limits: &[MotionLimits],
    proposed: &Excitation,
) -> anyhow::Result<Vec<(String, Quality)>> {
    let of = |(name, recording): &(String, RegularRecording)| {
        let input = Input { name, recording, held_out: false, before: false };
        let quality = diagnosis::quality_of(arm, limits, proposed, &[input])?;
        Ok((name.clone(), quality))
    };
    recordings.iter().map(of).collect()
}
