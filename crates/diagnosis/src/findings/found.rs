//! From the judged effects to findings: names, alternatives, gains, places.

use std::collections::BTreeMap;

use effects::Acts;
use effects::arm::{INERTIAL_PARAMETERS, INERTIAL_SCALE};
use effects::laws::ACCELERATION;
use effects::sensor::TORQUE_SCALE;

use crate::data::Data;
use crate::findings::other_friction::{possible_beside, widen};
use crate::report::{Change, Confusable, Finding, Parameter, Place};
use crate::search::candidate::{Candidate, Hypothesis};
use crate::search::problem::Problem;
use crate::selection::FinalFit;
use crate::selection::coupling::OnOneJoint;
use crate::selection::gain::held_out_gain;
use crate::selection::judge::Member;
use crate::selection::naming::{may_be_nothing, name};
use crate::selection::payload::as_last_link;
use crate::selection::rivals::{Comparison, Rival, compared, probability};
use crate::selection::torque_constants;
use crate::thresholds::{GAIN_BESIDE_LINKS, LISTED_SHARE, MOST_USUAL, MUCH_WRONG_LINKS, SUREST, UNSURE_MASS};

/// The findings, each with its candidate.
pub fn findings(last: &FinalFit) -> Vec<(Finding, Option<usize>)> {
    let problem = last.problem();
    let compared = |member: &Member| compared(&last.study, &problem, &last.judged.named, member.candidate);
    let comparisons: Vec<(&Member, Comparison)> =
        last.judged.members.iter().map(|member| (member, compared(member))).collect();
    let beside = possible_beside(last, &comparisons);
    comparisons
        .iter()
        .flat_map(|(member, comparison)| {
            let mut list = finding(last, &problem, member, comparison);
            if let Some(first) = list.first_mut() {
                widen(first, last, &problem, member, &beside);
            }
            list.into_iter().map(|finding| (finding, Some(member.candidate))).collect::<Vec<_>>()
        })
        .collect()
}

fn finding(last: &FinalFit, problem: &Problem<'_>, member: &Member, comparison: &Comparison) -> Vec<Finding> {
    let study = &last.study;
    let candidate = &study.candidates[member.candidate];
    let joint_name = |joint: usize| study.data.arm.joints()[joint].name.clone();
    let share_by_joint: BTreeMap<String, f64> = member
        .shares
        .iter()
        .enumerate()
        .filter(|(_, share)| **share > LISTED_SHARE)
        .map(|(joint, share)| (joint_name(joint), *share))
        .collect();
    let place = place(last, candidate);
    let gain = held_out_gain(problem, last.held.as_ref(), &last.judged, member);
    let confusable = |&(hypothesis, joint): &Rival| Confusable {
        effect: hypothesis.name().unwrap_or_default(),
        joint: joint.map(joint_name),
    };
    let last_link = as_last_link(&last.study, member.candidate);
    let few_links = last.payload.filter(|(payload, _)| *payload == member.candidate);
    let over_links = few_links.map(|(_, nats)| nats);
    let over_one_joint = OnOneJoint::of(study, &last.judged.named, member.candidate).map(|one| one.margin);
    let evidence = over_links.into_iter().chain(over_one_joint).fold(member.evidence, f64::min);
    let is_doubtful = over_links.is_some_and(|nats| probability(nats) < SUREST);
    let as_links = is_doubtful.then(|| (Hypothesis::of(&INERTIAL_PARAMETERS), None));
    // Factors on the masses stand for the torque constants of the other joints.
    let named = &last.judged.named;
    let of_others = torque_constants::alike(study, named).contains(&member.candidate);
    let of_all = candidate.hypothesis.spec().is_wrong_mass && torque_constants::most_are_alike(study, named);
    let as_masses = of_others.then(|| (Hypothesis::of(&INERTIAL_SCALE), None));
    let change = change(last, member.candidate);
    let mut list = Vec::new();
    for (k, mut named) in name(study, &last.resampled, member.candidate).into_iter().enumerate() {
        if let Some(start) = named.parameters.get_mut("start") {
            let motions = &study.data.motions;
            let shift = recording_of(last, candidate).map_or(0.0, |(_, at)| motions.own_time(at, 0.0));
            start.value += shift;
            start.ci95 = start.ci95.map(|end| end + shift);
        }
        let share = if k == 0 { member.share() } else { rotor_share(last, candidate) };
        // A mass that may be zero is that of no body: only moments are determined, which a link may have, too. A change that may be zero is
        // no clear change, a gap or a delay that may be zero is none, and a torque constant that may be right is not wrong.
        let spec = named.effect.spec();
        let needs_size = last_link.is_some() || change.is_some() || spec.is_simulated || named.effect.is(&TORQUE_SCALE);
        let is_body = study.is_payload(member.candidate) && change.is_none();
        let is_open = of_others
            || of_all
            || needs_size && may_be_nothing(spec, &named.parameters)
            || is_body && may_be_links(study.strengths.common(), named.parameters.get("mass"), gain)
            || named.effect.is(&INERTIAL_SCALE)
                && change.is_none()
                && may_be_constants(named.parameters.get("factor"), study.stated.torque_accuracy());
        list.push(Finding {
            other: named.other,
            parameters: named.parameters,
            // The probability is calibrated for the effects that were searched, not for one that is brought along.
            probability: (k == 0).then(|| comparison.probability(if is_open { 0.0 } else { evidence })),
            share,
            share_by_joint: if k == 0 {
                share_by_joint.clone()
            } else {
                candidate.joint.map(|joint| (joint_name(joint), share)).into_iter().collect()
            },
            held_out_gain: gain,
            confusable_with: if k == 0 {
                let mut list: Vec<Confusable> = Vec::new();
                let rivals = comparison.rivals.iter().chain(&comparison.as_likely);
                for rival in rivals.chain(&last_link).chain(&as_links).chain(&as_masses).map(confusable) {
                    if !list.contains(&rival) {
                        list.push(rival);
                    }
                }
                list
            } else {
                Vec::new()
            },
            confusable_with_pairs: if k == 0 {
                comparison.pairs.iter().map(|pair| pair.each_ref().map(confusable)).collect()
            } else {
                Vec::new()
            },
            place: place.clone(),
            since_before: change.is_some_and(|change| !change.is_past()),
            change,
            corrects: true,
            ..Finding::of(named.effect)
        });
    }
    list
}

/// Whether a body with this `mass` may as well be a part of links that all differ from the URDF by `links` (relative): they differ much, the
/// mass is hardly determined, and the body hardly improves the prediction of held-out recordings. Only the prior then prefers a body.
fn may_be_links(links: f64, mass: Option<&Parameter>, held_out_gain: Option<f64>) -> bool {
    let is_unsure = |mass: &Parameter| 0.5 * (mass.ci95[1] - mass.ci95[0]) > UNSURE_MASS * mass.value.abs();
    let is_unproven = held_out_gain.is_none_or(|gain| gain < GAIN_BESIDE_LINKS);
    links >= MUCH_WRONG_LINKS && is_unproven && mass.is_some_and(is_unsure)
}

/// Whether a factor on all masses is as small as a usual deviation of the torque constants, which the joints may have in common; `accuracy` is
/// its standard deviation (relative).
fn may_be_constants(factor: Option<&Parameter>, accuracy: f64) -> bool {
    factor.is_some_and(|factor| (factor.value - 1.0).abs() <= MOST_USUAL * accuracy)
}

/// How a candidate changed since the recordings from before.
fn change(last: &FinalFit, candidate: usize) -> Option<Change> {
    let study = &last.study;
    study.data.motions.changed_at?;
    let this = &study.candidates[candidate];
    let is_beside = |&other: &usize| {
        let other = &study.candidates[other];
        other.hypothesis.contains(this.hypothesis) && other.joint == this.joint
    };
    let is_known = study.has_known(this.hypothesis, this.joint);
    // What remains of a spring today may be a part of links that are wrong.
    let may_remain =
        this.hypothesis.spec().may_be_inertial && this.joint.is_some() && study.strengths.strongest() > 0.0;
    let was_there = last.judged.named.set.iter().filter(|&&other| study.always_acts(other)).any(is_beside) || is_known;
    match Acts::of(&study.terms(candidate)) {
        Acts::Always => None,
        Acts::Since(_) if was_there => Some(Change::Increased),
        Acts::Since(_) => Some(Change::Added),
        Acts::Until(_) if was_there || may_remain => Some(Change::Reduced),
        Acts::Until(_) => Some(Change::Removed),
    }
}

/// The share of the drive's inertia that is named with a spring or a gap.
fn rotor_share(last: &FinalFit, candidate: &Candidate) -> f64 {
    let (data, table) = (&last.study.data, &last.study.table);
    let Some(joint) = candidate.joint else { return 0.0 };
    let mut rotor = candidate.columns.clone();
    rotor.retain(|&column| table.terms[column].is(&ACCELERATION));
    let torque = table.torque(joint, &rotor, &last.judged.named.fit.values(&rotor));
    data.share(joint, table.spread(joint, &data.fitted, &torque))
}

/// The window of a contact (s) and its recording, on whose clock it is reported; `None` for another effect, or between recordings.
fn recording_of(last: &FinalFit, candidate: &Candidate) -> Option<([f64; 2], usize)> {
    let window = candidate.window(&last.study.table)?;
    let at = last.study.data.motions.recording_at(0.5 * (window[0] + window[1]))?;
    Some((window, at))
}

fn place(last: &FinalFit, candidate: &Candidate) -> Place {
    let (Data { arm, motions, .. }, table) = (&last.study.data, &last.study.table);
    if let Some((window, at)) = recording_of(last, candidate) {
        // Refinement may have moved an end just beyond the end of the recording.
        let [first, end] = motions.span(at);
        return Place {
            time: vec![window.map(|time| motions.own_time(at, time.clamp(first, end)))],
            recording: Some(motions.sources[at].name.clone()),
            state: None,
        };
    }
    if let Some(window) = candidate.window(table) {
        return Place { time: vec![window], ..Place::default() };
    }
    let joint = &arm.joints()[candidate.joint.unwrap_or(0)];
    let region = candidate.hypothesis.spec().region;
    Place { state: region(&candidate.terms(table), joint.kind), ..Place::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With torque constants that are accurate to 5 %, a factor of 6 % on all masses may be theirs, and one of 20 % may not.
    #[test]
    fn a_small_factor_on_all_masses_may_be_one_on_the_torque_constants() {
        let factor = |value: f64| Parameter { value, ci95: [value, value], unit: "" };
        assert!(may_be_constants(Some(&factor(1.06)), 0.05));
        assert!(may_be_constants(Some(&factor(0.94)), 0.05));
        assert!(!may_be_constants(Some(&factor(1.2)), 0.05));
        assert!(!may_be_constants(Some(&factor(1.06)), 0.01), "constants that are known better");
        assert!(!may_be_constants(None, 0.05));
    }

    #[test]
    fn a_body_of_any_mass_beside_links_that_are_all_wrong_may_be_a_part_of_them() {
        let mass = |half: f64| Parameter { value: 1.0, ci95: [1.0 - half, 1.0 + half], unit: "kg" };
        assert!(may_be_links(0.56, Some(&mass(0.6)), Some(0.04)));
        assert!(may_be_links(0.56, Some(&mass(0.6)), None));
        assert!(!may_be_links(0.2, Some(&mass(0.6)), Some(0.04)), "links that are nearly right");
        assert!(!may_be_links(0.56, Some(&mass(0.3)), Some(0.04)), "a mass that is determined");
        assert!(!may_be_links(0.56, Some(&mass(0.6)), Some(0.7)), "a better prediction");
    }
}
