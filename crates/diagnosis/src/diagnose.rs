//! The diagnosis from beginning to end: one phase after the other.

use arm::Arm;
use effects::Effect;

use crate::data::Data;
use crate::data::input::Input;
use crate::diagnosis::Diagnosis;
use crate::error::DiagnosisError;
use crate::findings::conclusion::Conclusion;
use crate::findings::identified::identified;
use crate::next::{self, Next};
use crate::options::{Options, Step};
use crate::search::study::Study;
use crate::selection::FinalFit;
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
    progress(Step::new(0.08, "filtering, rigid-body torques"));
    let data = Data::new(arm, inputs, options)?;
    let mut study = Study::new(data, options).with_own_load(options);
    let identified = identified(&mut study);
    let last = FinalFit::new(&mut study, options, progress)?;
    progress(Step::new(0.78, "alternatives of the findings"));
    let conclusion = Conclusion::new(&study, &last, &identified, inputs, options);
    let next = next_experiment(&mut study, &last, &conclusion, (arm, options), progress)?;
    let mut diagnosis = conclusion.diagnosis(arm, study);
    if let Some(next) = next {
        diagnosis.report.next_experiment = Some(next.report);
        diagnosis.next = next.motion;
    }
    Ok(diagnosis)
}

/// The next experiment on `arm`, if `options` request one and there are enough data to propose it.
fn next_experiment(
    study: &mut Study,
    last: &FinalFit,
    conclusion: &Conclusion,
    (arm, options): (&Arm, &Options),
    progress: &dyn Fn(Step<'_>),
) -> Result<Option<Next>, DiagnosisError> {
    if !options.next {
        return Ok(None);
    }
    if !conclusion.not_enough_data.is_empty() {
        let remark = "no motion is proposed, because the recordings do not contain enough data";
        study.data.motions.remarks.push(remark.to_owned());
        return Ok(None);
    }
    progress(Step::new(0.8, "next experiment"));
    let effects: Vec<Effect> = options.known.iter().cloned().chain(conclusion.effects()).collect();
    let next = next::propose(
        study,
        &last.products,
        &last.judged.named,
        (arm, &effects),
        &conclusion.findings,
        &conclusion.not_observable,
        &conclusion.unexplained,
    )?;
    Ok(Some(next))
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
