//! A recording that is given to the diagnosis, and whether it can be diagnosed.

use arm::Arm;
use recording::RegularRecording;

use crate::error::DiagnosisError;
use crate::thresholds::{LARGEST_CUTOFF, LEAST_WIDTHS};

/// A recording to be diagnosed, with its name and role.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The name that the user gave.
    pub name: &'a str,
    /// The recording on its regular clock, with the joints in the arm's order.
    pub recording: &'a RegularRecording,
    /// Whether it is held out: not to be fitted.
    pub held_out: bool,
    /// Whether it was made before a change of the robot (`--before`). Such recordings come first.
    pub before: bool,
}

/// Whether `inputs` can be diagnosed with `arm` at all, with a filter at `cutoff` (Hz).
///
/// # Errors
/// [`DiagnosisError`], if there is nothing to fit, or a recording does not fit the arm or is too short.
pub(crate) fn check(arm: &Arm, inputs: &[Input<'_>], cutoff: f64) -> Result<(), DiagnosisError> {
    if inputs.iter().all(|input| input.held_out) {
        return Err(DiagnosisError::NoTraining);
    }
    let expected: Vec<String> = arm.joints().iter().map(|joint| joint.name.clone()).collect();
    for input in inputs {
        let recording = input.recording;
        if recording.joints != expected {
            return Err(DiagnosisError::Joints {
                recording: input.name.to_owned(),
                found: recording.joints.clone(),
                expected,
            });
        }
        let needed = LEAST_WIDTHS * LARGEST_CUTOFF / cutoff.min(LARGEST_CUTOFF / recording.period);
        let longest = recording.segments.iter().map(|s| s.ticks.len()).max().unwrap_or(0) as f64 * recording.period;
        if longest < needed {
            return Err(DiagnosisError::TooShort {
                recording: input.name.to_owned(),
                seconds: longest,
                cutoff,
                needed,
            });
        }
    }
    Ok(())
}
