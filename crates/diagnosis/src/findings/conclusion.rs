//! The conclusions from the final fit: findings, unexplained residuals, effects that are not testable, and the report.

use std::collections::BTreeMap;

use arm::{Arm, Joint};
use effects::Effect;
use effects::drive::JOINT_ELASTICITY;

use super::found::findings;
use super::held_out_friction::OtherFriction;
use super::inertials::{Inertials, doubt_payload, inertials, leave_out_single_links};
use super::locate::locate;
use super::observability::not_testable;
use super::traces::traces;
use super::verdict::{
    ask_for_motion, beyond_limits, known_too_large, moves_in_training, not_enough, poorly_predicted, slower_filter,
    unexplained, verdict, with_common_cause, with_places,
};
use super::{at_rest, dual_sensor, gaps, own_friction, sentences, transients};
use crate::data::Data;
use crate::data::input::Input;
use crate::data::motion::SourceRecording;
use crate::data::statistics::NORMAL_95;
use crate::diagnosis::Diagnosis;
use crate::options::Options;
use crate::report::{
    Axis, DifferentLoad, Finding, HeldOutFriction, JointFit, Located, NotObservable, Parameter, RecordingNames, Report,
    SCHEMA, Traces, Unexplained, UsedPart,
};
use crate::search::own_load::OwnLoad;
use crate::selection::FinalFit;
use crate::selection::judge::Member;
use crate::selection::predict::errors;
use crate::selection::{constant_torques, coupling, torque_constants};
use crate::thresholds::LEAST_FOR_DYNAMICS;
use crate::torque_lag;

/// The note that the next experiment was requested in vain.
const NO_MOTION: &str = "no motion is proposed, because the recordings do not contain enough data";

/// The conclusions from the final fit.
pub struct Conclusion {
    /// The findings, the largest share first, each with its candidate.
    pub findings: Vec<(Finding, Option<usize>)>,
    inertials: Inertials,
    /// The constant torques of the joints that no finding names.
    constant_torques: BTreeMap<String, Parameter>,
    located: Vec<Located>,
    /// The reasons why the data are not sufficient for a diagnosis; empty if they are.
    pub not_enough_data: Vec<String>,
    /// How well each joint's torque is predicted.
    pub fit: BTreeMap<String, JointFit>,
    /// Structured residuals that no effect in the catalogue explains.
    pub unexplained: Vec<Unexplained>,
    /// Effects that are not testable with these recordings.
    pub not_observable: Vec<NotObservable>,
    changed: Option<Vec<String>>,
    different_load: Option<DifferentLoad>,
    held_out_friction: Vec<HeldOutFriction>,
    traces: Traces,
    /// Notes on a motion that is not proposed, on torques that only the background explains, and on known effects.
    notes: Vec<String>,
    /// Whether only the requested effects were fitted.
    is_requested: bool,
}

impl Conclusion {
    /// The conclusions from the fit `last`.
    pub fn new(last: &FinalFit, inputs: &[Input<'_>], options: &Options) -> Self {
        let FinalFit { study, judged, resampled, residual, .. } = last;
        let (data, table) = (&study.data, &study.table);
        let mut findings = findings(last);
        let not_there = without_known(data, options, &mut findings);
        let mut inertials = inertials(last, options.only.is_some());
        let is_contact_named = !last.contacts().is_empty();
        let transients = transients::search(data, table, study.force(), residual, is_contact_named);
        let mut others = std::mem::take(&mut inertials.findings);
        if options.only.is_none() {
            others.splice(0..0, dual_sensor::findings(data, inputs, |joint| last.names(&JOINT_ELASTICITY, joint)));
            // What acts on the whole arm without a name may have been stronger for a while.
            let is_of_arm = |form: &Member| study.candidates[form.candidate].joint.is_none();
            let acts_on_arm = judged.unmodelled.iter().any(is_of_arm);
            others.extend(transients.contact.clone().filter(|_| !acts_on_arm));
        }
        findings.extend(others.into_iter().map(|finding| (finding, None)));
        if options.only.is_some() {
            // Nothing else was searched, so that the probability of a name is not calibrated.
            for (finding, _) in &mut findings {
                finding.probability = None;
            }
        }
        let not_enough_data = not_enough(last);
        if !not_enough_data.is_empty() {
            // With too few data, no finding is supported.
            findings.clear();
        }
        let fit = fit(last);
        gaps::widen(last, &fit, &mut findings);
        let located = locate(data, table, &data.nominal, residual);
        let mut unexplained = unexplained(last, &fit, &transients, &located);
        let has_findings = !findings.is_empty();
        known_too_large(last, &fit, &options.known, &mut unexplained);
        let other_friction = OtherFriction::new(last);
        poorly_predicted(last, &fit, &other_friction, has_findings, &mut unexplained);
        if !not_enough_data.is_empty() {
            // More data are the only next step.
            unexplained.clear();
        }
        let of_moved = unexplained.iter().filter(|open| moves_in_training(last, open));
        let of_moved: Vec<Unexplained> = of_moved.cloned().collect();
        let mut links_not_named = None;
        if options.only.is_none() {
            links_not_named = leave_out_single_links(&mut findings, &of_moved);
            let joints: Vec<String> = data.arm.joints().iter().map(|joint| joint.name.clone()).collect();
            doubt_payload(&mut findings, &joints);
        }
        if !has_findings {
            beyond_limits(&data.arm, &fit, &transients, &mut unexplained);
            with_places(&located, &mut unexplained);
        } else if unexplained.iter().any(|open| open.depends_on.is_empty()) {
            let mut open = locate(data, table, residual, residual);
            for place in &mut open {
                // A residual that drifts has an unmodelled form. What remains in one stretch of time is not a drift.
                place.regions.retain(|region| region.axis != Axis::ElapsedTime);
            }
            with_places(&open, &mut unexplained);
        }
        with_common_cause(&mut unexplained);
        ask_for_motion(last, &mut unexplained);
        findings.sort_by(|(a, _), (b, _)| {
            b.share.total_cmp(&a.share).then(a.effect.cmp(b.effect)).then(a.joint.cmp(&b.joint))
        });
        let changed = data.motions.changed_at.map(|_| {
            let new = findings.iter().map(|(finding, _)| finding);
            sentences::changes(new.filter(|finding| finding.change.is_some()), |joint| {
                data.arm.joints().iter().position(|known| known.name == joint)
            })
        });
        // If a change is named that a load at rest resembles, nothing is to be added.
        let is_named = |(finding, _): &(Finding, _)| {
            let spec = finding.as_effect.spec();
            finding.change.is_some() && (spec.is_wrong_mass || spec.may_be_inertial)
        };
        let own_load = study.own_load.as_ref();
        let different_load =
            own_load.filter(|_| !findings.iter().any(is_named)).map(|load| different(load, &data.motions.sources));
        for (finding, _) in &mut findings {
            finding.sentence = sentences::of(finding, &fit);
        }
        let constants = constant_torques::corrections(study, &judged.named, resampled);
        let no_motion = (options.next && !not_enough_data.is_empty()).then(|| NO_MOTION.to_owned());
        let notes = [
            no_motion,
            links_not_named,
            sentences::not_compared(data),
            at_rest::note(last),
            own_friction::note(last),
            torque_constants::note_on_unnamed(study, &judged.named),
            torque_constants::note_on_alike(study, &judged.named),
            coupling::note(study, &judged.named),
            torque_lag::note_on_short(table, resampled),
            slower_filter(&data.motions, &unexplained).filter(|_| options.cutoff.is_none() && options.only.is_none()),
            sentences::constant_torques(&constant_torques::reported(study, &constants)),
        ];
        let placeholders = sentences::placeholders(&data.arm, &study.strengths.least);
        let notes = notes.into_iter().flatten().chain(placeholders).chain(not_there).collect();
        Self {
            located,
            constant_torques: constants,
            notes,
            is_requested: options.only.is_some(),
            traces: traces(last, &findings),
            not_observable: not_named(not_testable(last), &findings),
            findings,
            inertials,
            not_enough_data,
            fit,
            unexplained,
            changed,
            different_load,
            held_out_friction: other_friction.reported(last),
        }
    }

    /// The effects that correct the torque model.
    pub fn effects(&self) -> impl Iterator<Item = Effect> {
        let found = self.findings.iter().filter(|(finding, _)| finding.corrects && finding.acts_today());
        let found = found.map(|(finding, _)| &finding.as_effect);
        let constants = self.constant_torques.iter().map(constant_torques::effect);
        found.chain(&self.inertials.effects).cloned().chain(constants)
    }

    /// The diagnosis of `arm`, without a next experiment.
    pub fn diagnosis(self, arm: &Arm, last: FinalFit) -> Diagnosis {
        let effects = self.effects().collect();
        let data = last.study.data;
        let motions = data.motions;
        // A channel that holds no torque, or none in the held-out recordings, has no relative error.
        let has_held_out = motions.sources.iter().any(|source| source.held_out);
        let mut fit = self.fit;
        for (joint, torque) in arm.joints().iter().zip(&data.scales.torque) {
            let is_tested = |fit: &JointFit| !has_held_out || fit.held_out_nrmse_nominal.is_some();
            if *torque == 0.0 || !fit.get(&joint.name).is_some_and(is_tested) {
                fit.remove(&joint.name);
            }
        }
        let names = |held_out: bool| {
            let sources = motions.sources.iter();
            let selected = sources.filter(|source| source.held_out == held_out);
            selected.map(|source| source.name.clone()).collect()
        };
        let before = (0..motions.sources.len()).filter(|&at| motions.is_before(at));
        let findings: Vec<Finding> = self.findings.into_iter().map(|(finding, _)| finding).collect();
        let report = Report {
            schema: SCHEMA,
            robot: arm.name().to_owned(),
            recordings: RecordingNames {
                train: names(false),
                before: before.map(|at| motions.sources[at].name.clone()).collect(),
                held_out: names(true),
                used_in_part: used_in_part(&motions.sources),
            },
            cutoff: Some(motions.cutoff),
            torque_lag: None,
            own_torque_lags: BTreeMap::new(),
            doubts: Vec::new(),
            warnings: Vec::new(),
            verdict: verdict(&findings, &self.unexplained, &self.not_enough_data),
            unexplained: self.unexplained,
            not_diagnosed: data.not_diagnosed,
            not_observable: self.not_observable,
            not_enough_data: self.not_enough_data,
            located: self.located,
            fit,
            changed: self.changed,
            different_load: self.different_load,
            held_out_friction: self.held_out_friction,
            inertials: self.inertials.links,
            constant_torques: self.constant_torques,
            rollout: BTreeMap::new(),
            next_experiment: None,
            is_requested: self.is_requested,
            findings,
        };
        Diagnosis {
            report,
            traces: self.traces,
            effects,
            next: None,
            remarks: [motions.remarks, self.notes].concat(),
            trace: last.study.trace.take(),
        }
    }
}

/// `load` as it is reported.
fn different(load: &OwnLoad, sources: &[SourceRecording]) -> DifferentLoad {
    let names = load.recordings.iter().map(|&recording| sources[recording].name.clone());
    let (value, half) = (load.load[0], NORMAL_95 * load.deviations[0]);
    DifferentLoad {
        recordings: names.collect(),
        until: load.until.map(|until| (until * 1e3).round() / 1e3),
        more_than_others: Parameter { value, ci95: [value - half, value + half], unit: "kg" },
    }
}

/// The recordings that are not used whole.
fn used_in_part(sources: &[SourceRecording]) -> Vec<UsedPart> {
    let parts = sources.iter().filter_map(|source| {
        let [used_seconds, of_seconds] = source.part?.map(|seconds| (seconds * 1e3).round() / 1e3);
        let recording = source.name.clone();
        Some(UsedPart { recording, used_seconds, of_seconds })
    });
    parts.collect()
}

/// The effects of `list` without a finding. A second encoder or a motor current may show an effect that the torque alone
/// does not.
fn not_named(mut list: Vec<NotObservable>, findings: &[(Finding, Option<usize>)]) -> Vec<NotObservable> {
    let is_named = |entry: &NotObservable| {
        let same = |finding: &Finding| finding.effect == entry.effect && finding.joint == entry.joint;
        findings.iter().any(|(finding, _)| same(finding))
    };
    list.retain(|entry| !is_named(entry));
    list
}

/// How well each joint's torque is predicted.
fn fit(last: &FinalFit) -> BTreeMap<String, JointFit> {
    let (data, table) = (&last.study.data, &last.study.table);
    let of = |(joint, described): (usize, &Joint)| {
        let of_exported = errors(data, table, joint, &last.exported[joint]);
        let errors = JointFit {
            held_out_nrmse_identified: last.identified[joint],
            held_out_nrmse_exported: of_exported.held_out_nrmse_augmented,
            ..errors(data, table, joint, &last.residual[joint])
        };
        (described.name.clone(), errors)
    };
    data.arm.joints().iter().enumerate().map(of).collect()
}

/// Removes known gaps and springs between drive and link from `findings`: their torque depends on the links, which may be wrong, so
/// that they are found again instead of subtracted. Returns remarks on those that are not found, or with another size.
fn without_known(data: &Data, options: &Options, findings: &mut Vec<(Finding, Option<usize>)>) -> Vec<String> {
    let is_found_again = |known: &&Effect| known.spec().is_simulated && known.of_command(0).is_none();
    let mut remarks = Vec::new();
    for known in options.known.iter().filter(is_found_again) {
        let is_same = |finding: &Finding| known.name() == finding.effect && known.joint() == finding.joint.as_deref();
        match findings.iter().position(|(finding, _)| is_same(finding)) {
            Some(place) => {
                let (finding, _) = findings.remove(place);
                remarks.extend(sentences::of_another_size(known, &finding));
            }
            None => remarks.push(sentences::not_subtracted(known, data.motions.cutoff < LEAST_FOR_DYNAMICS)),
        }
    }
    remarks
}

#[cfg(test)]
mod tests {
    use effects::drive::JOINT_ELASTICITY;

    use super::*;

    #[test]
    fn an_effect_that_is_named_is_not_listed_as_not_testable() {
        let entry = |effect, joint: &str| NotObservable {
            effect,
            joint: Some(joint.to_owned()),
            because: String::new(),
            would_be_seen_above: BTreeMap::new(),
            would_be_seen_below: BTreeMap::new(),
        };
        let list = vec![entry("joint_elasticity", "a"), entry("joint_elasticity", "b"), entry("backlash", "a")];
        let finding = Finding::of(Effect::of(&JOINT_ELASTICITY).on("a".to_owned()));
        let remaining = not_named(list, &[(finding, None)]);
        let remaining: Vec<_> = remaining.iter().map(|entry| (entry.effect, entry.joint.as_deref())).collect();
        assert_eq!(remaining, [("joint_elasticity", Some("b")), ("backlash", Some("a"))]);
    }
}
