//! From the judged effects to findings: names, alternatives, gains, places.

use std::collections::BTreeMap;

use effects::arm::{InertialParameters, Payload};
use effects::laws::ACCELERATION;

use crate::regression::fit::Products;
use crate::report::{Confusable, Finding, Place};
use crate::search::candidate::Hypothesis;
use crate::search::problem::Problem;
use crate::search::study::Study;
use crate::selection::bootstrap::Resampled;
use crate::selection::gain::held_out_gain;
use crate::selection::judge::{Judged, Member};
use crate::selection::naming::{may_be_nothing, name};
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
    let joint_name = |joint: usize| study.data.arm.joints()[joint].name.clone();
    let share_by_joint: BTreeMap<String, f64> = member
        .shares
        .iter()
        .enumerate()
        .filter(|(_, share)| **share > LISTED_SHARE)
        .map(|(joint, share)| (joint_name(joint), *share))
        .collect();
    let place = place(study, candidate.hypothesis, member.candidate);
    let gain = held_out_gain(problem, held, judged, member);
    let confusable = |&(hypothesis, joint): &Named| Confusable {
        effect: hypothesis.name().unwrap_or_default(),
        joint: joint.map(joint_name),
    };
    let last_link = as_last_link(study, member.candidate);
    let mut list = Vec::new();
    for (k, named) in name(study, resampled, member.candidate).into_iter().enumerate() {
        let share = if k == 0 {
            member.share()
        } else {
            rotor_share(study, judged, member.candidate)
        };
        // A mass that may be zero is that of no body: only moments are determined, which a link may have, too.
        let may_be_link = last_link.is_some() && may_be_nothing(named.effect.spec(), &named.parameters);
        list.push(Finding {
            other: named.other,
            parameters: named.parameters,
            // The probability is calibrated for the effects that were searched, not for one that is brought along.
            probability: (k == 0).then(|| standing.probability(if may_be_link { 0.0 } else { member.evidence })),
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
                let rivals = standing.rivals.iter().chain(&standing.as_likely);
                for rival in rivals.chain(&last_link).map(confusable) {
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
            since_before: study.data.motions.changed_at.is_some() && !study.always_acts(member.candidate),
            corrects: true,
            ..Finding::of(named.effect)
        });
    }
    list
}

/// The last link as an alternative of a payload that was always there, if a link is wrong in any case: the inertial parameters of
/// both have the same torque. Without wrong links, a body at the tool is the likelier of the two.
fn as_last_link(study: &Study, candidate: usize) -> Option<Named> {
    let is_payload = study.candidates[candidate].hypothesis.is(&Payload);
    let links = Hypothesis::of(&InertialParameters);
    let is_wrong = study.strengths.links.iter().any(|&rho| rho > 0.0);
    (is_payload && study.always_acts(candidate) && is_wrong).then(|| (links, study.data.arm.dof().checked_sub(1)))
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
    study
        .data
        .share(joint, study.table.spread(joint, &study.data.fitted, &torque))
}

fn place(study: &Study, hypothesis: Hypothesis, candidate: usize) -> Place {
    if let Some([from, to]) = study.candidates[candidate].window(&study.table) {
        let at = study.data.motions.recording_at(0.5 * (from + to));
        // Refinement may have moved an end just beyond the end of the recording.
        let own = |time: f64| {
            at.map_or(time, |at| {
                let [first, last] = study.data.motions.span(at);
                study.data.motions.own_time(at, time.clamp(first, last))
            })
        };
        let recording = at.map(|at| study.data.motions.sources[at].name.clone());
        return Place {
            time: vec![[own(from), own(to)]],
            recording,
            state: None,
        };
    }
    let joint = &study.data.arm.joints()[study.candidates[candidate].joint.unwrap_or(0)];
    Place {
        state: hypothesis.kind.get().region(&study.terms(candidate), joint.kind),
        ..Place::default()
    }
}
