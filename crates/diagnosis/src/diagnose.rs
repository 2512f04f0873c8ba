//! The diagnosis from beginning to end: one phase after the other.

use arm::Arm;

use crate::data::input::{Input, check};
use crate::diagnosis::Diagnosis;
use crate::error::DiagnosisError;
use crate::look::Look;
use crate::next;
use crate::options::{Options, Step};
use crate::thresholds::CUTOFF;

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
