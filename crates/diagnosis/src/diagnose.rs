//! The diagnosis from beginning to end: one phase after the other.

use arm::Arm;

use crate::data::input::{Input, check};
use crate::diagnosis::Diagnosis;
use crate::error::DiagnosisError;
use crate::look::Look;
use crate::next;
use crate::options::{Options, Step};
use crate::thresholds::{CUTOFF, MOST_LAGS};
use crate::torque_lag::{TorqueLag, WithoutLag};

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
    let (first, lag, without_lag) = without_torque_lag(arm, inputs, options, progress)?;
    let inputs = &without_lag.of(inputs)[..];
    let Look { last, conclusion } = first.or_slower(arm, inputs, options, progress)?;
    let next = if options.next && conclusion.not_enough_data.is_empty() {
        progress(Step::new(0.8, "next experiment"));
        Some(next::propose(&last, &conclusion, arm, &options.known)?)
    } else {
        None
    };
    let mut diagnosis = conclusion.diagnosis(arm, last);
    diagnosis.report.torque_lag = lag;
    if let Some(next) = next {
        diagnosis.report.next_experiment = Some(next.report);
        diagnosis.next = next.motion;
    }
    Ok(diagnosis)
}

/// A look at the recordings without the lag of their torques, the lag (s) if there is one, and these recordings. Without a stated lag, it
/// is the one that the residuals of a look show, if they do.
fn without_torque_lag(
    arm: &Arm,
    inputs: &[Input<'_>],
    options: &Options,
    progress: &dyn Fn(Step<'_>),
) -> Result<(Look, Option<f64>, WithoutLag), DiagnosisError> {
    let stated = options.torque_lag.or(options.only.is_some().then_some(0.0));
    let mut lag = stated.unwrap_or(0.0);
    let mut without = WithoutLag::new(inputs, lag);
    let moved = without.of(inputs);
    check(arm, &moved, options.cutoff.unwrap_or(CUTOFF))?;
    let mut look = Look::new(arm, &moved, options, progress)?;
    if stated.is_some() {
        return Ok((look, Some(lag).filter(|&lag| lag != 0.0), without));
    }
    let again = |step: Step<'_>| {
        let doing = format!("torques without their lag: {}", step.doing);
        progress(Step::new(step.done, &doing));
    };
    let mut found = None;
    for _ in 0..MOST_LAGS {
        let Some(more) = TorqueLag::of(&look.last) else { break };
        let next = more.after(lag);
        let recordings = WithoutLag::new(inputs, next.seconds);
        let next_moved = recordings.of(inputs);
        if check(arm, &next_moved, options.cutoff.unwrap_or(CUTOFF)).is_err() {
            break;
        }
        let trace = std::mem::take(&mut look.last.study.trace);
        look = Look::again(arm, &next_moved, options, (trace, &next), &again)?;
        (lag, without, found) = (next.seconds, recordings, Some(next));
    }
    if let Some(found) = found {
        look.last.study.data.motions.remarks.push(found.remark());
    }
    Ok((look, found.map(|found| found.seconds), without))
}
