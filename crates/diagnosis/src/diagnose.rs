//! The diagnosis from end to end.

use std::collections::BTreeMap;

use arm::Arm;
use rayon::prelude::*;
use torque::Effect;

use crate::bootstrap::{Resampled, resample};
use crate::bursts::{self, Bursts};
use crate::candidate::Cause;
use crate::error::DiagnosisError;
use crate::fit::Products;
use crate::found::findings;
use crate::judge::{self, Judged};
use crate::locate::locate;
use crate::motion::Input;
use crate::naming::name;
use crate::predict::{augmented, errors};
use crate::report::{Finding, Located, RecordingNames, Report, TimeWindow, Traces, Unexplained, Verdict};
use crate::study::Study;
use crate::traces::traces;
use crate::{known, search_plan, sentences, settings, two_sides, unseen};

/// How to diagnose.
#[derive(Clone, Debug)]
pub struct Options {
    /// Half-power frequency of the low-pass filter (Hz).
    pub cutoff: f64,
    /// Effects that the user has already: they are taken off, and not reported again.
    pub known: Vec<Effect>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            cutoff: settings::CUTOFF,
            known: Vec::new(),
        }
    }
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
    /// What was left out of the recordings, in sentences.
    pub remarks: Vec<String>,
}

/// Diagnoses where and why `inputs` differ from `arm`. `progress` is told what is going on.
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
    check(arm, inputs, options.cutoff)?;
    progress("filtering, and the model along the motion");
    let arm_and_known = known::Known::new(arm, &options.known)?;
    let mut study = Study::new(&arm_and_known, inputs, options.cutoff);
    let chosen = search_plan::search(&mut study, progress);
    progress("judging names");
    let fitted = study.fitted.clone();
    let products = study.products(|r| fitted[r]);
    let held = fitted.iter().any(|f| !f).then(|| study.products(|r| !fitted[r]));
    let mut judged = judge::judge(&study, &products, held.as_ref(), chosen);
    settle(&mut study, &mut judged);
    while guard(&study, &mut judged) {
        settle(&mut study, &mut judged);
    }
    progress("intervals");
    let resampled = clear_of_zero(&mut study, &mut judged);
    let products = study.products(|r| fitted[r]);
    let held = fitted.iter().any(|f| !f).then(|| study.products(|r| !fitted[r]));
    progress("what else it could be");
    let mut findings = findings(&study, &products, held.as_ref(), &judged, &resampled);
    let two_sided = two_sides::findings(&study, &judged.named, inputs);
    findings.extend(two_sided.into_iter().map(|finding| (finding, None)));
    let left: Vec<Vec<f64>> = (0..arm.dof())
        .into_par_iter()
        .map(|joint| augmented(&study, &judged.named, joint))
        .collect();
    let bursts = bursts::bursts(&study, &judged, &left);
    findings.extend(bursts.contact.clone().map(|finding| (finding, None)));
    let located = locate(&study, &left);
    let unexplained = unexplained(&study, &judged, &bursts, &left);
    let not_enough_data = not_enough(&study, &products);
    if !not_enough_data.is_empty() {
        // What so little says is not said as if it were known.
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
            (name, errors(&study, joint, &left[joint]))
        })
        .collect();
    findings.sort_by(|(a, _), (b, _)| {
        b.share
            .total_cmp(&a.share)
            .then(a.effect.cmp(b.effect))
            .then(a.joint.cmp(&b.joint))
    });
    for (finding, _) in &mut findings {
        finding.sentence = sentences::of(finding, &fit);
    }
    let traces = traces(&study, &judged, &findings, &left);
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
        not_observable: unseen::unseen(&study, &products, &judged.named),
        not_enough_data,
        located,
        fit,
        rollout: BTreeMap::new(),
        findings,
    };
    let effects = report
        .findings
        .iter()
        .filter(|finding| finding.corrects)
        .map(|finding| finding.as_effect.clone())
        .collect();
    Ok(Diagnosis {
        report,
        traces,
        effects,
        remarks: std::mem::take(&mut study.motions.remarks),
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

/// Forms everything about the arm that the named effects make, and no other, with the rows near reversals, and fits anew.
fn settle(study: &mut Study, judged: &mut Judged) {
    let kept = study.settle(&judged.named.fit, &judged.candidates());
    let named = judged.named.set.len();
    let fitted = study.fitted.clone();
    let products = study.products(|r| fitted[r]);
    let problem = study.problem(&products);
    judged.named = problem.choose(kept[..named].to_vec(), &judged.named.fit.weights);
    judged.members = judge::describe(study, &problem, &judged.named);
    for (member, &number) in judged.nameless.iter_mut().zip(&kept[named..]) {
        member.candidate = number;
    }
}

/// Resamples, and drops names whose size might be zero, until there are none.
fn clear_of_zero(study: &mut Study, judged: &mut Judged) -> Resampled {
    loop {
        let resampled = resample(study, &judged.named);
        let is_unclear = |member: &&judge::Member| {
            let named = name(study, &resampled, member.candidate);
            named.first().is_some_and(|named| {
                let effect = named.effect.name();
                // A factor of one changes nothing.
                let nothing = if effect.ends_with("_scale") { 1.0 } else { 0.0 };
                let size = named.parameters.get(main_parameter(effect));
                size.is_some_and(|size| size.ci95[0] <= nothing && nothing <= size.ci95[1])
            })
        };
        let Some(unclear) = judged
            .members
            .iter()
            .filter(is_unclear)
            .min_by(|a, b| a.evidence.total_cmp(&b.evidence))
        else {
            return resampled;
        };
        let set = judged
            .named
            .set
            .iter()
            .copied()
            .filter(|&c| c != unclear.candidate)
            .collect();
        let fitted = study.fitted.clone();
        let products = study.products(|r| fitted[r]);
        let problem = study.problem(&products);
        judged.named = problem.choose(set, &judged.named.fit.weights);
        judged.members = judge::describe(study, &problem, &judged.named);
    }
}

/// The parameter that says how large an effect is.
fn main_parameter(effect: &str) -> &'static str {
    match effect {
        "viscous_friction" | "quadratic_drag" => "coefficient",
        "coulomb_friction" => "level",
        "friction_asymmetry" => "positive",
        "stribeck_friction" => "breakaway",
        "load_dependent_friction" => "gain",
        "thermal_drift" | "torque_ripple" => "amplitude",
        "rotor_inertia" => "inertia",
        "torque_scale" | "inertial_scale" => "factor",
        "torque_offset" | "encoder_offset" => "offset",
        "actuation_delay" => "delay",
        "backlash" => "halfgap",
        "payload" => "mass",
        "link_inertial_error" => "relative",
        "gravity_misalignment" => "angle",
        "external_contact" => "force",
        "joint_elasticity" | "spring" => "stiffness",
        _ => "",
    }
}

/// Drops findings until no joint's held-out error is larger than the nominal model's. Returns whether there were any.
fn guard(study: &Study, judged: &mut Judged) -> bool {
    let before = judged.named.set.len();
    let fitted = study.fitted.clone();
    let products = study.products(|r| fitted[r]);
    let problem = study.problem(&products);
    loop {
        let nrmse = |chosen: &crate::search::Chosen, joint: usize| {
            let fit = errors(study, joint, &augmented(study, chosen, joint));
            (fit.held_out_nrmse_nominal, fit.held_out_nrmse_augmented)
        };
        let worse = (0..study.motions.dof).find(|&joint| match nrmse(&judged.named, joint) {
            (Some(nominal), Some(augmented)) => judge::harms(nominal, augmented),
            _ => false,
        });
        let Some(joint) = worse else { break };
        let best = judged
            .members
            .iter()
            .filter(|member| member.shares[joint] > 0.0)
            .map(|member| {
                let set = judged
                    .named
                    .set
                    .iter()
                    .copied()
                    .filter(|&c| c != member.candidate)
                    .collect();
                let next = problem.choose(set, &judged.named.fit.weights);
                (nrmse(&next, joint).1.unwrap_or(f64::INFINITY), next)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, next)) = best else { break };
        judged.members = judge::describe(study, &problem, &next);
        judged.named = next;
    }
    judged.named.set.len() < before
}

fn unexplained(study: &Study, judged: &Judged, bursts: &Bursts, left: &[Vec<f64>]) -> Vec<Unexplained> {
    let mut by_joint: BTreeMap<usize, (f64, Vec<(f64, String)>)> = BTreeMap::new();
    for member in &judged.nameless {
        let candidate = &study.candidates[member.candidate];
        let Some(joint) = candidate.joint else { continue };
        let other = |joint: usize| format!("other_joint:{}", study.arm.joints()[joint].name);
        let on = match candidate.cause {
            Cause::OwnPosition => "own_position".to_owned(),
            Cause::OtherPosition(of) | Cause::OtherSpeed(of) => other(of),
            Cause::History => "history".to_owned(),
            Cause::Product => "own_position_times_speed".to_owned(),
            Cause::Periodic | Cause::Time => "time".to_owned(),
            _ => continue,
        };
        let entry = by_joint.entry(joint).or_default();
        entry.0 = entry.0.hypot(member.share());
        if !entry.1.iter().any(|(_, known)| *known == on) {
            entry.1.push((member.share(), on));
        }
    }
    let mut in_bursts = bursts.unexplained.clone();
    for (&joint, (share, _)) in &bursts.unexplained {
        let entry = by_joint.entry(joint).or_default();
        if !entry.1.iter().any(|(_, known)| known == "time") {
            entry.0 = entry.0.max(*share);
            entry.1.push((*share, "time".to_owned()));
        }
    }
    let located = locate(study, left);
    by_joint
        .into_iter()
        .map(|(joint, (share, mut on))| {
            on.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let name = study.arm.joints()[joint].name.clone();
            let bursts = in_bursts.remove(&joint).map(|(_, windows)| windows);
            let time: Vec<TimeWindow> = bursts.unwrap_or_else(|| {
                located
                    .iter()
                    .find(|located| located.joint == name && on.iter().any(|(_, on)| on == "time"))
                    .map_or(Vec::new(), |located: &Located| located.time.clone())
            });
            let depends_on: Vec<String> = on.into_iter().map(|(_, on)| on).collect();
            Unexplained {
                next: sentences::next_experiment(&name, depends_on.first().map_or("", String::as_str)),
                joint: name,
                share,
                depends_on,
                time,
            }
        })
        .collect()
}

/// The least time in motion (s) and of reversals that a diagnosis needs on some joint.
const LEAST_MOTION: f64 = 4.0;

fn not_enough(study: &Study, products: &Products) -> Vec<String> {
    let seconds = |joint: usize| -> f64 {
        let counts = study.table.joints[joint]
            .count
            .iter()
            .zip(&study.seconds)
            .zip(&study.fitted);
        counts
            .filter(|(_, fitted)| **fitted)
            .map(|((count, seconds), _)| *count as f64 * seconds)
            .sum()
    };
    let longest = (0..study.motions.dof).map(seconds).fold(0.0, f64::max);
    let mut reasons = Vec::new();
    if products.count.iter().all(|&count| count == 0.0) {
        reasons.push("no joint moves in the training recordings".to_owned());
    } else if longest < LEAST_MOTION {
        reasons.push(format!(
            "the training recordings hold {longest:.1} s of motion; {LEAST_MOTION:.0} s and several reversals on each joint are the least"
        ));
    }
    reasons
}

fn verdict(findings: &[Finding], unexplained: &[Unexplained], not_enough: &[String], located: &[Located]) -> Verdict {
    match (findings.is_empty(), unexplained.is_empty()) {
        _ if !not_enough.is_empty() => Verdict::NotEnoughData,
        (true, true) if located.is_empty() => Verdict::NoMismatch,
        (true, _) => Verdict::Unexplained,
        (false, true) => Verdict::Explained,
        (false, false) => Verdict::PartlyExplained,
    }
}
