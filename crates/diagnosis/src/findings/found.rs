//! From the judged effects to findings: names, alternatives, gains, places.

use std::collections::BTreeMap;

use effects::laws::ACCELERATION;

use crate::regression::fit::Products;
use crate::report::{Confusable, Finding, Place};
use crate::search::candidate::Hypothesis;
use crate::search::problem::Problem;
use crate::search::study::Study;
use crate::selection::bootstrap::Resampled;
use crate::selection::gain::held_out_gain;
use crate::selection::judge::{Judged, Member};
use crate::selection::naming::name;
use crate::selection::predict::deviation;
use crate::selection::rivals::{Named, Standing, standing};
use crate::thresholds::LISTED_SHARE;

/// The findings, each with its candidate.
pub fn findings(
    study: &Study,
    products: &Products,
    held: Option<&Products>,
    judged: &Judged,
    resampled: &Resampled,
) -> Vec<(Finding, Option<usize>)> {
    let problem = study.problem(products);
    judged
        .members
        .iter()
        .flat_map(|member| {
            let standing = standing(study, &problem, &judged.named, member.candidate);
            let list = finding(study, &problem, held, judged, resampled, member, &standing);
            list.into_iter()
                .map(|finding| (finding, Some(member.candidate)))
                .collect::<Vec<_>>()
        })
        .collect()
}

fn finding(
    study: &Study,
    problem: &Problem<'_>,
    held: Option<&Products>,
    judged: &Judged,
    resampled: &Resampled,
    member: &Member,
    standing: &Standing,
) -> Vec<Finding> {
    let candidate = &study.candidates[member.candidate];
    let joint_name = |joint: usize| study.arm.joints()[joint].name.clone();
    let share_by_joint: BTreeMap<String, f64> = member
        .shares
        .iter()
        .enumerate()
        .filter(|(_, share)| **share > LISTED_SHARE)
        .map(|(joint, share)| (joint_name(joint), *share))
        .collect();
    let place = place(study, candidate.hypothesis, member.candidate);
    let gain = held_out_gain(study, problem, held, judged, member);
    let confusable = |&(hypothesis, joint): &Named| Confusable {
        effect: hypothesis.name().unwrap_or_default(),
        joint: joint.map(joint_name),
    };
    let mut list = Vec::new();
    for (k, named) in name(study, resampled, member.candidate).into_iter().enumerate() {
        let share = if k == 0 {
            member.share()
        } else {
            rotor_share(study, judged, member.candidate)
        };
        list.push(Finding {
            other: named.other,
            parameters: named.parameters,
            probability: Some(standing.probability(member.evidence)),
            share,
            share_by_joint: if k == 0 {
                share_by_joint.clone()
            } else {
                candidate
                    .joint
                    .map(|joint| (joint_name(joint), share))
                    .into_iter()
                    .collect()
            },
            held_out_gain: gain,
            confusable_with: if k == 0 {
                let mut list: Vec<Confusable> = Vec::new();
                for rival in standing.rivals.iter().chain(&standing.as_likely).map(confusable) {
                    if !list.contains(&rival) {
                        list.push(rival);
                    }
                }
                list
            } else {
                Vec::new()
            },
            confusable_with_pairs: if k == 0 {
                standing
                    .pairs
                    .iter()
                    .map(|pair| pair.each_ref().map(confusable))
                    .collect()
            } else {
                Vec::new()
            },
            place: place.clone(),
            since_before: study.motions.changed_at.is_some()
                && study.terms(member.candidate).iter().any(|term| term.onset().is_some()),
            corrects: true,
            ..Finding::of(named.effect)
        });
    }
    list
}

/// The share of the drive's inertia that is named with a spring or a gap.
fn rotor_share(study: &Study, judged: &Judged, candidate: usize) -> f64 {
    let columns = &study.candidates[candidate].columns;
    let Some(joint) = study.candidates[candidate].joint else {
        return 0.0;
    };
    let rotor: Vec<usize> = columns
        .iter()
        .copied()
        .filter(|&column| study.table.terms[column].is(&ACCELERATION))
        .collect();
    let torque = study.table.torque(joint, &rotor, &judged.named.fit.values(&rotor));
    deviation(&torque, &study.training_rows(joint)) / study.scales.torque[joint].max(1e-300)
}

fn place(study: &Study, hypothesis: Hypothesis, candidate: usize) -> Place {
    if let Some([from, to]) = study.window(candidate) {
        let at = study.motions.recording_at(0.5 * (from + to));
        // Refinement may have moved an end just beyond the end of the recording.
        let own = |time: f64| {
            at.map_or(time, |at| {
                let [first, last] = study.motions.span(at);
                study.motions.own_time(at, time.clamp(first, last))
            })
        };
        let recording = at.map(|at| study.motions.sources[at].name.clone());
        return Place {
            time: vec![[own(from), own(to)]],
            recording,
            state: None,
        };
    }
    let joint = &study.arm.joints()[study.candidates[candidate].joint.unwrap_or(0)];
    Place {
        state: hypothesis.kind.get().region(&study.terms(candidate), joint.kind),
        ..Place::default()
    }
}
