//! Decides which of the selected candidates are named.

use effects::Acts;
use effects::arm::EXTERNAL_CONTACT;
use rayon::prelude::*;

use crate::data::statistics::{moments, rms};
use crate::regression::fit::Products;
use crate::search::physics::is_at_its_size;
use crate::search::problem::{IMPOSSIBLE, Problem, Selection};
use crate::search::study::Study;
use crate::selection::of_noise::{may_be_noise, may_be_noise_of_base};
use crate::thresholds::{
    ABOVE_RESIDUAL, HARMLESS, IDLE_EFFECT, LEAST_DRIVE, LEAST_OF_ARM, LEAST_OF_MISMATCH, MOST_OF_A_RECORDING,
    NEARLY_CONSTANT, OF_BEYOND, WORSE,
};

mod held_out;

use held_out::{harmful, predicting};

/// A selected candidate with its contribution.
#[derive(Clone, Debug)]
pub struct Member {
    /// The index of the candidate.
    pub candidate: usize,
    /// The standard deviation of its torque over that of the joint's, training recordings, one per joint.
    pub shares: Vec<f64>,
    /// The loss of the score without it (nats).
    pub evidence: f64,
    /// The part of the joint's torque that only it explains (RMS over standard deviation); for a form of a simpler effect, the part that the
    /// simpler effect does not explain either.
    pub beyond: f64,
}

impl Member {
    /// The largest of its shares.
    pub fn share(&self) -> f64 {
        self.shares.iter().copied().fold(0.0, f64::max)
    }

    /// Whether it has a notable share on `joint`. One of the whole arm has a torque on every joint.
    pub fn is_on(&self, joint: usize) -> bool {
        self.shares[joint] > 0.0 && self.shares[joint] >= LEAST_OF_ARM * self.share()
    }

    /// The joint on which its share is largest.
    pub fn place(&self) -> usize {
        (0..self.shares.len()).max_by(|&a, &b| self.shares[a].total_cmp(&self.shares[b])).unwrap_or(0)
    }
}

/// The named effects, and the unmodelled forms.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The named candidates, fitted together.
    pub named: Selection,
    /// Their contributions.
    pub members: Vec<Member>,
    /// The unmodelled forms that remain.
    pub unmodelled: Vec<Member>,
}

impl Judged {
    /// The named candidates, then the unmodelled forms.
    pub fn candidates(&self) -> Vec<usize> {
        let unmodelled = self.unmodelled.iter().map(|member| member.candidate);
        self.named.set.iter().copied().chain(unmodelled).collect()
    }

    /// The named effects in the order of their evidence.
    pub fn weakest_first(&self) -> Vec<&Member> {
        let mut members: Vec<&Member> = self.members.iter().collect();
        members.sort_by(|a, b| a.evidence.total_cmp(&b.evidence));
        members
    }
}

/// Judges `selected`; `held` are the products of the held-out recordings, if there are any.
pub fn judge(study: &Study, products: &Products, held: Option<&Products>, mut selected: Selection) -> Judged {
    let problem = study.problem(products);
    let is_unmodelled = |&c: &usize| study.candidates[c].hypothesis.name().is_none();
    let had_unmodelled = selected.set.iter().any(is_unmodelled);
    let off = |selected: &Selection| -> Option<usize> {
        let links = study.strengths.common();
        let is_off = |&c: &usize| !is_at_its_size(&study.candidates[c], &study.table, &selected.fit, links);
        selected.set.iter().copied().find(is_off)
    };
    while let Some(off) = off(&selected) {
        let next = problem.without(&selected, off);
        study.note("it was simulated at its size, and the fit multiplies it", &selected, &next);
        selected = next;
    }
    while let Some(long) = lasting(&problem, &selected) {
        selected = problem.without(&selected, long);
    }
    while let Some(early) = at_the_beginning(&problem, &selected) {
        let next = problem.without(&selected, early);
        study.note("a robot that begins to move may shake", &selected, &next);
        selected = next;
    }
    let mut members;
    if let Some(held) = held {
        let next = predicting(&problem, held, selected.clone());
        study.note("does not predict held-out recordings", &selected, &next);
        selected = next;
    }
    loop {
        members = describe(&problem, &selected);
        let Some(weak) = weakest(study, &members) else { break };
        let next = problem.without(&selected, members[weak].candidate);
        study.note("too small, or too little evidence, for a name", &selected, &next);
        selected = next;
    }
    let (unmodelled, named): (Vec<Member>, Vec<Member>) =
        members.into_iter().partition(|member| study.candidates[member.candidate].hypothesis.name().is_none());
    let mut kept = problem.choose(named.iter().map(|m| m.candidate).collect(), &selected.fit.weights);
    if had_unmodelled {
        // Unmodelled forms, including those that were dropped, may have displaced simple effects. A constant is allowed if no other
        // form remains on its joint, or if it is much larger than the residual of the named effects there, because unmodelled forms
        // also represent constants.
        let candidates = &study.candidates;
        let mut simple = study.allowed();
        simple.retain(|&c| candidates[c].hypothesis.spec().is_baseline_or_constant && study.always_acts(c));
        let with_all = problem.forward(kept.clone(), &simple);
        let forms = beside(&problem, &with_all, &unmodelled);
        let has_form = |c: usize| candidates[c].joint.is_some_and(|joint| forms.iter().any(|form| form.is_on(joint)));
        let exceeds_the_rest = |c: usize| {
            let Some(joint) = candidates[c].joint else { return false };
            let rest = (with_all.fit.rss[joint].max(0.0) / products.count[joint].max(1.0)).sqrt();
            with_all.set.contains(&c)
                && shares(&problem, &with_all, c)[joint]
                    > ABOVE_RESIDUAL * rest / study.data.scales.torque[joint].max(1e-300)
        };
        let mut allowed = simple;
        allowed.retain(|&c| candidates[c].hypothesis.spec().is_baseline || !has_form(c) || exceeds_the_rest(c));
        let next = problem.forward(kept.clone(), &allowed);
        study.note("replaces unmodelled forms", &kept, &next);
        kept = next;
    }
    if let Some(held) = held {
        while let Some((rule, bad)) = harmful(&problem, held, &kept) {
            // What a gap brought along, the inertia of its rotor, may remain; without it, the links would stand for it.
            let next = problem.without(&kept, bad);
            study.note(rule, &kept, &next);
            kept = next;
        }
    }
    // Without the unmodelled forms and the refused names, other effects may have become impossible.
    while let Some(&bad) = kept.set.iter().find(|&&c| !problem.is_possible(c, &kept.fit)) {
        let next = problem.choose(kept.others(bad), &kept.fit.weights);
        study.note(IMPOSSIBLE, &kept, &next);
        kept = next;
    }
    let members = describe(&problem, &kept);
    let unmodelled = beside(&problem, &kept, &unmodelled);
    Judged { named: kept, members, unmodelled }
}

/// The longest contact in a recording of which contacts cover too much: together they replace another effect.
fn lasting(problem: &Problem<'_>, selected: &Selection) -> Option<usize> {
    let window = |&c: &usize| Some((c, problem.candidates[c].window(problem.table)?));
    let windows: Vec<(usize, [f64; 2])> = selected.set.iter().filter_map(window).collect();
    let (recording, share) =
        problem.data.contact_share(&windows.iter().map(|(_, window)| *window).collect::<Vec<_>>())?;
    if share <= MOST_OF_A_RECORDING {
        return None;
    }
    let is_there = |[from, to]: [f64; 2]| problem.data.motions.recording_at(0.5 * (from + to)) == Some(recording);
    let there = windows.iter().filter(|(_, window)| is_there(*window));
    let length = |[from, to]: [f64; 2]| to - from;
    there.max_by(|a, b| length(a.1).total_cmp(&length(b.1))).map(|(c, _)| *c)
}

/// A contact that is over soon after its recording has begun.
fn at_the_beginning(problem: &Problem<'_>, selected: &Selection) -> Option<usize> {
    let motions = &problem.data.motions;
    let is_early = |&c: &usize| {
        let window = problem.candidates[c].window(problem.table);
        window.is_some_and(|[_, to]| {
            let recording = motions.recording_at(to);
            recording.is_some_and(|recording| motions.is_at_a_beginning(recording, to))
        })
    };
    selected.set.iter().copied().find(is_early)
}

/// The unmodelled forms that remain in addition to `kept`, with their contributions.
fn beside(problem: &Problem<'_>, kept: &Selection, unmodelled: &[Member]) -> Vec<Member> {
    let mut set = kept.set.clone();
    set.extend(unmodelled.iter().map(|member| member.candidate));
    loop {
        let all = problem.choose(set.clone(), &kept.fit.weights);
        let mut members = describe(problem, &all);
        members.retain(|member| !kept.set.contains(&member.candidate));
        let fails = |member: &Member| {
            let joint = member.place();
            let mismatch = problem.products.power(joint).sqrt() / problem.data.scales.torque[joint].max(1e-300);
            member.share() < problem.thresholds.least_unmodelled_share.max(LEAST_OF_MISMATCH * mismatch)
                || member.evidence < problem.thresholds.least_unmodelled_evidence
        };
        let weak = members.iter().filter(|m| fails(m)).min_by(|a, b| a.evidence.total_cmp(&b.evidence));
        match weak {
            Some(weak) => set.retain(|&c| c != weak.candidate),
            None => return members,
        }
    }
}

/// Shares and evidence of all selected candidates.
pub fn describe(problem: &Problem<'_>, selected: &Selection) -> Vec<Member> {
    (0..selected.set.len())
        .into_par_iter()
        .map(|k| {
            let candidate = selected.set[k];
            let without = problem.without(selected, candidate);
            let beyond = |joint: usize| {
                let gained = (without.fit.rss[joint] - selected.fit.rss[joint]).max(0.0);
                (gained / problem.products.count[joint].max(1.0)).sqrt() / problem.data.scales.torque[joint].max(1e-300)
            };
            Member {
                candidate,
                shares: shares(problem, selected, candidate),
                evidence: without.score - selected.score,
                beyond: (0..problem.data.motions.dof).map(beyond).fold(0.0, f64::max),
            }
        })
        .collect()
}

/// The standard deviation of a candidate's torque over the measured one's, on moving training rows, one per joint. For a nearly
/// constant torque, the root mean square is used instead.
fn shares(problem: &Problem<'_>, selected: &Selection, candidate: usize) -> Vec<f64> {
    let columns = &problem.candidates[candidate].columns;
    let values = selected.fit.values(columns);
    (0..problem.data.motions.dof)
        .map(|joint| {
            let torque = problem.table.torque(joint, columns, &values);
            let rows = problem.table.moving_rows(joint, &problem.data.fitted);
            let (mean, variance) = moments(rows.iter().map(|&row| torque[row]));
            let size =
                if variance < (NEARLY_CONSTANT * mean).powi(2) { mean.hypot(variance.sqrt()) } else { variance.sqrt() };
            size / problem.data.scales.torque[joint].max(1e-300)
        })
        .collect()
}

/// Whether a candidate has no torque in the held-out recordings, so that they do not test it: neither alone, nor together with the
/// change that ended it.
pub fn is_idle(problem: &Problem<'_>, selected: &Selection, candidate: usize) -> bool {
    let this = &problem.candidates[candidate];
    let always = problem.acts(this) == Acts::Always;
    let others = selected.set.iter().map(|&c| &problem.candidates[c]);
    let changes = others.filter(|other| {
        always
            && problem.acts(other) != Acts::Always
            && other.joint == this.joint
            && other.hypothesis == this.hypothesis
    });
    let mut columns = this.columns.clone();
    columns.extend(changes.flat_map(|change| &change.columns));
    let values = selected.fit.values(&columns);
    let rows = problem.table.rows_of(|recording| !problem.data.fitted[recording]);
    (0..problem.data.motions.dof).all(|joint| {
        let torque = problem.table.torque(joint, &columns, &values);
        let moving = &problem.table.joints[joint].moving;
        let on_rows = rows.iter().filter(|&&row| moving[row]).map(|&row| torque[row]);
        rms(on_rows).unwrap_or(0.0) < IDLE_EFFECT * problem.data.scales.torque[joint]
    })
}

/// The weakest member that does not satisfy the thresholds, if there is one.
fn weakest(study: &Study, members: &[Member]) -> Option<usize> {
    let hypothesis = |member: &Member| study.candidates[member.candidate].hypothesis;
    let is_named = |member: &Member| hypothesis(member).name().is_some();
    // Every joint has friction, but not friction that changed.
    let is_baseline = |member: &Member| hypothesis(member).spec().is_baseline && study.always_acts(member.candidate);
    let is_changed_friction = |member: &Member| hypothesis(member).is_plain_friction() && !is_baseline(member);
    // On each joint, the largest unmodelled form and the largest effect that is not a baseline effect.
    let dof = study.data.motions.dof;
    let largest = |wanted: &dyn Fn(&Member) -> bool, joint: usize| -> f64 {
        members.iter().filter(|m| wanted(m)).map(|m| m.shares[joint]).fold(0.0, f64::max)
    };
    let fails = |member: &Member| -> bool {
        let share = member.share();
        let at = member.place();
        if !is_named(member) {
            let named = largest(&|m| is_named(m) && !is_baseline(m), at);
            return share < study.thresholds.least_unmodelled_share
                || member.evidence < study.thresholds.least_unmodelled_evidence
                || share < study.thresholds.beside_a_larger * named
                || may_be_noise_of_base(study, member.candidate, &member.shares);
        }
        let unmodelled = largest(&|m| !is_named(m), at);
        if is_changed_friction(member) {
            // One of the two on a joint is sufficient. Without the other, its size would be wrong.
            let on_joint = |other: &&Member| {
                let joint = |member: &Member| study.candidates[member.candidate].joint;
                is_changed_friction(other) && joint(other) == joint(member)
            };
            let most = members.iter().filter(on_joint).map(|other| other.evidence);
            return most.fold(0.0, f64::max) < study.thresholds.least_evidence;
        }
        if is_baseline(member) {
            // If the unmodelled forms on the joint are larger, a rotor inertia may be a part of what they represent.
            return hypothesis(member).is_drive_inertia() && share < unmodelled.max(LEAST_DRIVE);
        }
        if may_be_noise(study, member.candidate, member.evidence) {
            return true;
        }
        let needed = match hypothesis(member).generalises() {
            Some(_) if study.strengths.friction == 0.0 => OF_BEYOND * study.thresholds.least_beyond,
            Some(_) => study.thresholds.least_beyond,
            None => study.thresholds.least_evidence,
        };
        // An effect on several joints need not stand out on all of them.
        let stands_out = |joint: usize| {
            let others = |certain: bool| {
                let is_other = |m: &Member| {
                    let hypothesis = hypothesis(m);
                    let is_known = is_named(m) && !is_baseline(m) && hypothesis.spec().is_certain_in_form == certain;
                    m.candidate != member.candidate && is_known
                };
                largest(&is_other, joint)
            };
            let share = member.shares[joint];
            let alike = |&(name, part): &(&str, f64)| part * largest(&|m| hypothesis(m).name() == Some(name), joint);
            let alike = hypothesis(member).spec().least_beside.iter().map(alike).fold(0.0, f64::max);
            share >= study.thresholds.least_share
                && share >= alike
                && share >= study.thresholds.beside_a_larger * others(false)
                // A share above one cancels the model's torque or another effect's: the torque hardly shows its form's error.
                && share >= study.thresholds.beside_a_certain * others(true).min(1.0)
                && share >= study.thresholds.beside_unmodelled * largest(&|m| !is_named(m), joint)
        };
        // The end of a gap jolts all joints, most of all its own. A contact must stand out on the joint on which it is largest.
        let stands_out =
            if hypothesis(member).is(&EXTERNAL_CONTACT) { stands_out(at) } else { (0..dof).any(stands_out) };
        member.evidence < needed || member.beyond < hypothesis(member).spec().least_beyond_simpler || !stands_out
    };
    (0..members.len())
        .filter(|&k| fails(&members[k]))
        .min_by(|&a, &b| members[a].evidence.total_cmp(&members[b].evidence))
}

/// The rule that removes an effect that makes a joint's held-out error larger than the nominal model's.
pub const HARMS: &str = "a joint's held-out error becomes larger than the nominal model's";

/// Whether an error (NRMSE) exceeds `nominal` by more than an effect of another joint may cause.
pub fn harms(nominal: f64, with: f64) -> bool {
    with > nominal + HARMLESS.max(WORSE * nominal)
}
