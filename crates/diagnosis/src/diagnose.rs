//! The diagnosis from end to end.

use std::collections::BTreeMap;

use arm::Arm;
use effects::Effect;
use rayon::prelude::*;
use torque::Reference;

use crate::data::known;
use crate::data::motion::Input;
use crate::error::DiagnosisError;
use crate::findings::dual_sensor;
use crate::findings::found::findings;
use crate::findings::identified::identified;
use crate::findings::inertials::inertials;
use crate::findings::locate::locate;
use crate::findings::observability;
use crate::findings::report::{Finding, JointFit, RecordingNames, Report, Traces};
use crate::findings::sentences;
use crate::findings::traces::traces;
use crate::findings::transients;
use crate::findings::verdict::{leftover, not_enough, unexplained, verdict};
use crate::next;
use crate::search::candidate::Cause;
use crate::search::hypothesis::{self, Wanted};
use crate::search::plan;
use crate::search::study::Study;
use crate::selection::final_fit;
use crate::selection::judge;
use crate::selection::predict::{augmented, errors, exported};
use crate::selection::unmounted::unmounted;
use crate::thresholds::{CUTOFF, MOST_REFUSED, Thresholds};
use crate::trace::Decision;

/// How to diagnose.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Half-power frequency of the low-pass filter (Hz); `None` lets the data decide.
    pub cutoff: Option<f64>,
    /// How far the URDF's masses, centres of mass and inertias may be off, as a part of each link's own (0.1: ten per cent);
    /// `None` lets the recordings decide.
    pub urdf_accuracy: Option<f64>,
    /// The relative standard deviation of each joint's torque constant; `None` if nobody knows.
    pub torque_accuracy: Option<f64>,
    /// Effects that the user has already: they are taken off, and not reported again.
    pub known: Vec<Effect>,
    /// Fit these effects and no others, whatever comes of them: nothing is searched for, no name is earned or lost. `None`
    /// searches the catalogue.
    pub only: Option<Vec<Wanted>>,
    /// Whether to propose the next experiment.
    pub next: bool,
    /// The most decisive thresholds, to see what hangs on them.
    pub thresholds: Thresholds,
}

/// A diagnosis and what its figures are drawn from.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// What others read.
    pub report: Report,
    /// On the diagnosis' own grid.
    pub traces: Traces,
    /// The named effects that correct the torque model.
    pub effects: Vec<Effect>,
    /// The motion of the next experiment, if one was requested and gives more information.
    pub next: Option<Reference>,
    /// Remarks on the use of the recordings, in sentences.
    pub remarks: Vec<String>,
    /// What was tried, taken and dropped on the way, in order.
    pub trace: Vec<Decision>,
}

/// Diagnoses where and why `inputs` differ from `arm`. `progress` receives the current step.
///
/// The result depends on the inputs and options alone, not on the number of threads.
///
/// # Errors
/// [`DiagnosisError`], if there is nothing to fit or a recording does not fit the arm.
pub fn diagnose(
    arm: &Arm,
    inputs: &[Input<'_>],
    options: &Options,
    progress: &dyn Fn(&str),
) -> Result<Diagnosis, DiagnosisError> {
    check(arm, inputs, options.cutoff.unwrap_or(CUTOFF))?;
    progress("filtering, rigid-body torques");
    let arm_and_known = known::Known::new(arm, &options.known)?;
    let may_be = |cause: Cause, joint: Option<usize>| {
        options.only.as_ref().is_none_or(|wanted| {
            let joint = joint.map(|joint| &arm.joints()[joint].name);
            let is_wanted = |one: &Wanted| {
                let is_there = joint == one.joint.as_ref() || (joint.is_some() && joint == one.other.as_ref());
                cause.name() == Some(&one.effect) && is_there
            };
            wanted.iter().any(is_wanted)
        })
    };
    let mut study = Study::new(&arm_and_known, inputs, options, &may_be);
    let fitted = study.fitted.clone();
    let identified = identified(&study);
    let (judged, resampled) = match &options.only {
        Some(wanted) => {
            progress("fitting the requested effects");
            let mut judged = hypothesis::fit(&mut study, wanted)?;
            let resampled = final_fit::as_given(&mut study, &mut judged);
            (judged, resampled)
        }
        None => {
            let mut judged;
            let mut resampled;
            loop {
                let refused = study.refused();
                let chosen = plan::search(&mut study, progress);
                progress("testing the selected effects");
                let products = study.products(|r| fitted[r]);
                let held = fitted.iter().any(|f| !f).then(|| study.products(|r| !fitted[r]));
                judged = judge::judge(&study, &products, held.as_ref(), chosen);
                progress("final fit and intervals");
                resampled = final_fit::settled(&mut study, &mut judged);
                // What turns out not to be may have kept something else from being found.
                if study.refused() == refused || refused > MOST_REFUSED {
                    break;
                }
                study.restart();
            }
            let resampled = unmounted(&mut study, &mut judged).unwrap_or(resampled);
            (judged, resampled)
        }
    };
    let products = study.products(|r| fitted[r]);
    let held = fitted.iter().any(|f| !f).then(|| study.products(|r| !fitted[r]));
    progress("alternatives of the findings");
    let mut findings = findings(&study, &products, held.as_ref(), &judged, &resampled);
    findings.retain(|(finding, _)| {
        let same = |known: &Effect| known.name() == finding.effect && known.joint() == finding.joint.as_deref();
        !arm_and_known.past.iter().any(same)
    });
    if options.only.is_none() {
        let two_sided = dual_sensor::findings(&study, &judged.named, inputs);
        findings.extend(two_sided.into_iter().map(|finding| (finding, None)));
    }
    let inertials = inertials(&study, &products, held.as_ref(), &judged, &resampled);
    findings.extend(inertials.findings.into_iter().map(|finding| (finding, None)));
    let left: Vec<Vec<f64>> = (0..arm.dof())
        .into_par_iter()
        .map(|joint| augmented(&study, &judged.named, joint))
        .collect();
    let bursts = transients::bursts(&study, &judged, &left);
    if options.only.is_none() {
        findings.extend(bursts.contact.clone().map(|finding| (finding, None)));
    }
    let located = locate(&study, &left);
    let not_enough_data = not_enough(&study, &products);
    if !not_enough_data.is_empty() {
        // So little data does not support any finding.
        findings.clear();
    }
    let names = |held_out: bool| {
        let chosen = study
            .motions
            .sources
            .iter()
            .filter(|source| source.held_out == held_out);
        chosen.map(|source| source.name.clone()).collect()
    };
    let fit: BTreeMap<_, _> = (0..arm.dof())
        .map(|joint| {
            let name = arm.joints()[joint].name.clone();
            let of_exported = errors(&study, joint, &exported(&study, &judged.named, joint));
            let errors = JointFit {
                held_out_nrmse_identified: identified[joint],
                held_out_nrmse_exported: of_exported.held_out_nrmse_augmented,
                ..errors(&study, joint, &left[joint])
            };
            (name, errors)
        })
        .collect();
    let mut unexplained = unexplained(&study, &judged, &bursts, &left);
    leftover(&study, &fit, &mut unexplained);
    findings.sort_by(|(a, _), (b, _)| {
        b.share
            .total_cmp(&a.share)
            .then(a.effect.cmp(b.effect))
            .then(a.joint.cmp(&b.joint))
    });
    let changed: Option<Vec<String>> = study.motions.changed_at.map(|_| {
        let sets_in = |(finding, _): &&(Finding, Option<usize>)| finding.since_before;
        findings
            .iter()
            .filter(sets_in)
            .map(|(finding, _)| sentences::changed(finding))
            .collect()
    });
    for (finding, _) in &mut findings {
        finding.sentence = sentences::of(finding, &fit);
    }
    let traces = traces(&study, &judged, &findings, &left);
    let not_observable = observability::unseen(&study, &products, &judged.named);
    if options.next && !not_enough_data.is_empty() {
        let remark = "no motion is proposed, because the recordings do not contain enough data";
        study.motions.remarks.push(remark.to_owned());
    }
    let next = if options.next && not_enough_data.is_empty() {
        progress("next experiment");
        let corrects = |(finding, _): &&(Finding, Option<usize>)| finding.corrects;
        let found = findings.iter().filter(corrects).map(|(finding, _)| &finding.as_effect);
        let effects = options.known.iter().chain(found).chain(&inertials.effects);
        let effects: Vec<Effect> = effects.cloned().collect();
        let robot = (arm, effects.as_slice());
        Some(next::propose(
            &study,
            &products,
            &judged.named,
            robot,
            &findings,
            &not_observable,
            &unexplained,
        )?)
    } else {
        None
    };
    let (next_experiment, next) = next.map_or((None, None), |next| (Some(next.report), next.motion));
    let findings: Vec<Finding> = findings.into_iter().map(|(finding, _)| finding).collect();
    let report = Report {
        schema: "testbed.diagnosis/1",
        robot: arm.name().to_owned(),
        recordings: RecordingNames {
            train: names(false),
            held_out: names(true),
        },
        verdict: verdict(&findings, &unexplained, &not_enough_data, &located),
        unexplained,
        not_observable,
        not_enough_data,
        located,
        fit,
        changed,
        inertials: inertials.links,
        rollout: BTreeMap::new(),
        next_experiment,
        findings,
    };
    let effects = report
        .findings
        .iter()
        .filter(|finding| finding.corrects)
        .map(|finding| finding.as_effect.clone())
        .chain(inertials.effects)
        .collect();
    Ok(Diagnosis {
        report,
        traces,
        effects,
        next,
        remarks: std::mem::take(&mut study.motions.remarks),
        trace: study.trace.take(),
    })
}

fn check(arm: &Arm, inputs: &[Input<'_>], cutoff: f64) -> Result<(), DiagnosisError> {
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
        // Both filters' reach, and ten rows.
        let needed = (10.0 + 6.0) * 0.235 / cutoff.min(0.235 / recording.period);
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
