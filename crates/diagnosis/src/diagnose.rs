//! The diagnosis from beginning to end: one phase after the other.

use std::collections::BTreeMap;

use arm::Arm;

use crate::data::Data;
use crate::data::input::{Input, check};
use crate::diagnosis::Diagnosis;
use crate::error::DiagnosisError;
use crate::findings::conclusion::Conclusion;
use crate::next;
use crate::options::{Options, Step};
use crate::search::study::Study;
use crate::selection::FinalFit;
use crate::thresholds::{CUTOFF, MOST_LAGS};
use crate::torque_lag::{Lagging, Lags, TorqueLag, WithoutLag, remark_on_own};
use crate::trace::{Action, Trace};

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
    let (last, lags, without_lag) = without_torque_lag(arm, inputs, options, progress)?;
    let inputs = &without_lag.of(inputs)[..];
    progress(Step::new(0.78, "alternatives of the findings"));
    let conclusion = Conclusion::new(&last, inputs, options);
    let next = if options.next && conclusion.not_enough_data.is_empty() {
        progress(Step::new(0.8, "next experiment"));
        Some(next::propose(&last, &conclusion, arm, &options.known)?)
    } else {
        None
    };
    let mut diagnosis = conclusion.diagnosis(arm, last);
    diagnosis.report.torque_lag = Some(lags.common).filter(|&lag| lag != 0.0);
    diagnosis.report.own_torque_lags = own_lags_by_name(inputs, &lags);
    if let Some(next) = next {
        diagnosis.report.next_experiment = Some(next.report);
        diagnosis.next = next.motion;
    }
    Ok(diagnosis)
}

/// The final fit to the recordings without the lags of their torques, these lags, and these recordings. Without a stated lag, they are those
/// that the residuals of a fit show, if they do.
fn without_torque_lag(
    arm: &Arm,
    inputs: &[Input<'_>],
    options: &Options,
    progress: &dyn Fn(Step<'_>),
) -> Result<(FinalFit, Lags, WithoutLag), DiagnosisError> {
    let stated = options.torque_lag.or(options.only.is_some().then_some(0.0));
    let mut lags = Lags { common: stated.unwrap_or(0.0), own: Vec::new() };
    let mut without = WithoutLag::new(inputs, &lags);
    let moved = without.of(inputs);
    check(arm, &moved, options.cutoff.unwrap_or(CUTOFF))?;
    let mut last = final_fit(arm, &moved, options, Trace::default(), progress)?;
    if stated.is_some() {
        return Ok((last, lags, without));
    }
    let again = |step: Step<'_>| {
        let doing = format!("torques without their lag: {}", step.doing);
        progress(Step::new(step.done, &doing));
    };
    let (mut found, mut of_all, mut of_single): (Option<TorqueLag>, usize, usize) = (None, 0, 0);
    loop {
        let mut next = lags.clone();
        // First those of single recordings, which a lag of all would share with the others.
        let Some(lagging) = Lagging::of(&last) else { break };
        let own = if of_single < MOST_LAGS { lagging.own_lags(&last, &lags.own) } else { None };
        let (removed, rule, of_these) = if let Some(own) = own {
            of_single += 1;
            let before = |at: usize| lags.own.get(at).copied().unwrap_or(0.0);
            next.own = own.iter().enumerate().map(|(at, more)| before(at) + more).collect();
            let some = inputs.iter().zip(&next.own).filter(|(_, own)| **own != 0.0);
            let list: Vec<String> = some.map(|(input, own)| format!("{}: {:.1} ms", input.name, 1e3 * own)).collect();
            (list.join(", "), "the residuals of single recordings show these lags", found)
        } else if of_all < MOST_LAGS
            && let Some(more) = TorqueLag::of(&lagging)
        {
            of_all += 1;
            next.common += more.seconds;
            (format!("{:.1} ms", 1e3 * next.common), "the residuals of all joints show this lag", Some(more))
        } else {
            break;
        };
        let recordings = WithoutLag::new(inputs, &next);
        let next_moved = recordings.of(inputs);
        if check(arm, &next_moved, options.cutoff.unwrap_or(CUTOFF)).is_err() {
            break;
        }
        let trace = std::mem::take(&mut last.study.trace);
        trace.step([(Action::Lag, removed, None, rule, 0.0)]);
        last = final_fit(arm, &next_moved, options, trace, &again)?;
        (lags, without, found) = (next, recordings, of_these);
    }
    let of_all = found.filter(|_| lags.common != 0.0).map(|found| found.remark(lags.common));
    let of_single = remark_on_own(inputs, &own_lags_by_name(inputs, &lags));
    last.study.data.motions.remarks.extend(of_all.into_iter().chain(of_single));
    Ok((last, lags, without))
}

/// The final fit to these recordings, whose decisions continue `trace`.
fn final_fit(
    arm: &Arm,
    inputs: &[Input<'_>],
    options: &Options,
    trace: Trace,
    progress: &dyn Fn(Step<'_>),
) -> Result<FinalFit, DiagnosisError> {
    progress(Step::new(0.08, "filtering, rigid-body torques"));
    let mut study = Study::new(Data::new(arm, inputs, options)?, options).with_own_load(options);
    study.trace = trace;
    let last = FinalFit::new(study, options, progress)?;
    let is_finite = last.judged.named.score.is_finite();
    is_finite.then_some(last).ok_or(DiagnosisError::NotFinite)
}

/// The lags of single recordings by their names (s), without those that have none.
fn own_lags_by_name(inputs: &[Input<'_>], lags: &Lags) -> BTreeMap<String, f64> {
    let own = inputs.iter().zip(&lags.own).filter(|(_, own)| **own != 0.0);
    own.map(|(input, own)| (input.name.to_owned(), *own)).collect()
}
