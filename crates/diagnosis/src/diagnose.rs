//! The diagnosis from beginning to end: one phase after the other.

use arm::Arm;

use crate::data::input::Input;
use crate::diagnosis::Diagnosis;
use crate::error::DiagnosisError;
use crate::look::Look;
use crate::next;
use crate::options::{Options, Step};
use crate::thresholds::{CUTOFF, LARGEST_CUTOFF, LEAST_WIDTHS};

/// Diagnoses where and why `inputs` differ from `arm`. `progress` receives each step as it begins.
///
/// The result depends on the inputs and options only, not on the number of threads.
///
/// # Errors
/// [`DiagnosisError`], if there is nothing to fit or a recording does not fit the arm.
pub fn diagnose(
    arm: &Arm,
    inputs: &[Input<'_>],
    options: &Options,
    progress: &dyn Fn(Step<'_>),
) -> Result<Diagnosis, DiagnosisError> {
    check(arm, inputs, options.cutoff.unwrap_or(CUTOFF))?;
    let first = Look::new(arm, inputs, options, progress)?;
    let Look { last, conclusion } = first.or_slower(arm, inputs, options, progress)?;
    let next = if options.next && conclusion.not_enough_data.is_empty() {
        progress(Step::new(0.8, "next experiment"));
        Some(next::propose(&last, &conclusion, arm, &options.known)?)
    } else {
        None
    };
    let mut diagnosis = conclusion.diagnosis(arm, last);
    if let Some(next) = next {
        diagnosis.report.next_experiment = Some(next.report);
        diagnosis.next = next.motion;
    }
    Ok(diagnosis)
}

/// Whether `inputs` can be diagnosed with `arm` at all.
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
