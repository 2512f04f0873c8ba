//! Sizes on which a column depends nonlinearly, refined between those of the forms.

use effects::{Acts, Size, Term};
use rayon::prelude::*;

use crate::data::statistics::mean;
use crate::search::candidate::Candidate;
use crate::search::problem::Selection;
use crate::search::study::Study;
use crate::thresholds::{FINER_STEPS, OTHER_FORM_SIZES, REFINED_ONSET, REFINED_SIZES, REFINED_STEPS, SECOND_SIZE_STEP};

/// The sizes of terms that have intervals.
pub fn sizes(terms: &[Term]) -> Vec<Size> {
    let all = [Size::Main, Size::Exponent, Size::Damping, Size::Stop, Size::Periods, Size::Duration];
    all.into_iter().filter(|&size| varied(terms, size, 1.01) != terms).collect()
}

/// `terms` with one size times `factor`.
pub fn varied(terms: &[Term], size: Size, factor: f64) -> Vec<Term> {
    terms.iter().map(|term| term.varied(size, factor)).collect()
}

/// `terms` with their main size, or exponent, times `factor`; empty if they have neither.
fn resized(terms: &[Term], factor: f64) -> Vec<Term> {
    let new = varied(&varied(terms, Size::Main, factor), Size::Exponent, factor);
    if new == terms { Vec::new() } else { new }
}

/// The rounds in which other forms are tried.
const FORMS: usize = 2;

/// The onset of a term within the recordings (s); `None` if it always acts, or since the recordings from before a change.
fn found_onset(term: &Term, changed_at: Option<f64>) -> Option<f64> {
    term.onset().filter(|&onset| Some(onset) != changed_at)
}

/// The other form of terms, at the sizes at which it is most similar.
fn forms(terms: &[Term], changed_at: Option<f64>) -> Vec<Vec<Term>> {
    let mut list = Vec::new();
    for factor in OTHER_FORM_SIZES {
        let mut other = terms.to_vec();
        let mut changed = false;
        for term in &mut other {
            if let (Some(other_form), None) = (term.law.other_form, found_onset(term, changed_at)) {
                let (form, is_other) = other_form(term, factor);
                *term = form;
                changed |= is_other;
            }
        }
        if changed {
            list.push(other);
        }
    }
    list
}

/// `terms` of a rigid gap, with compliant ends; `mass` is that of the link (kg m²).
fn softened(terms: &[Term], mass: f64) -> Vec<Vec<Term>> {
    let soft = |term: &Term| (term.law.softened)(term, mass);
    let Some((at, soft)) = terms.iter().map(soft).enumerate().find(|(_, soft)| !soft.is_empty()) else {
        return Vec::new();
    };
    soft.into_iter()
        .map(|term| {
            let mut terms = terms.to_vec();
            terms[at] = term;
            terms
        })
        .collect()
}

/// Variants of a candidate's terms in a round of refinement; `mass` is the inertia of its link (kg m² or kg), `changed_at` the
/// time of a change between the recordings (s).
fn variants(terms: &[Term], round: usize, mass: f64, changed_at: Option<f64>) -> Vec<Vec<Term>> {
    let mut list: Vec<Vec<Term>> = REFINED_SIZES[round].iter().map(|&factor| resized(terms, factor)).collect();
    list.retain(|terms| !terms.is_empty());
    // The stiffness and the damping of a spring are coupled, as are a gap and its compliant ends: all combinations of sizes
    // are tried.
    let second = [Size::Damping, Size::Stop].into_iter().find(|second| sizes(terms).contains(second));
    if let Some(second) = second {
        let steps = REFINED_STEPS.map(|step| (SECOND_SIZE_STEP * step * FINER_STEPS.powi(round as i32)).exp());
        let stiffer = list.clone();
        for terms in stiffer.into_iter().chain([terms.to_vec()]) {
            list.extend(steps.map(|factor| varied(&terms, second, factor)));
        }
    }
    let sized: Vec<Vec<Term>> = list.iter().cloned().chain([terms.to_vec()]).collect();
    list.extend(sized.iter().flat_map(|terms| softened(terms, mass)));
    list.extend(if round < FORMS { forms(terms, changed_at) } else { Vec::new() });
    // A finer step of a ripple's period, relative to one period over the range.
    let nudges = REFINED_STEPS.map(|step| step * FINER_STEPS.powi(round as i32));
    for kind in 0..NUDGES {
        for step in nudges {
            let nudged = terms.iter().map(|term| nudged(term, kind, step, changed_at));
            let new: Vec<Option<Term>> = nudged.collect();
            if new.iter().any(Option::is_some) {
                let both = new.into_iter().zip(terms);
                list.push(both.map(|(new, old)| new.unwrap_or(*old)).collect());
            }
        }
    }
    list.retain(|terms| terms.iter().all(|term| (term.law.is_sound)(term)));
    list
}

/// The sizes with which the effect of `member` was tried first. When it was taken, other effects were selected, so that its
/// size may be far from the best one now: a torque limit far below the true one may have explained a part of friction that
/// was not yet found.
fn first_sizes(study: &Study, member: usize) -> Vec<Vec<Term>> {
    let this = &study.candidates[member];
    let own = study.terms(member);
    if sizes(&own).is_empty() || own.iter().any(|term| found_onset(term, study.data.motions.changed_at).is_some()) {
        return Vec::new();
    }
    let is_like = |c: &usize| {
        let other = &study.candidates[*c];
        *c != member && !other.is_trial && other.hypothesis == this.hypothesis && other.joint == this.joint
    };
    let terms = (0..study.candidates.len()).filter(is_like).map(|c| study.terms(c));
    terms.filter(|terms| Acts::of(terms) == Acts::of(&own)).collect()
}

/// The largest number of kinds of finer steps of a law.
const NUDGES: usize = 3;

/// A term after a finer step of the `kind`; `None` if there is no such step.
fn nudged(term: &Term, kind: usize, step: f64, changed_at: Option<f64>) -> Option<Term> {
    match found_onset(term, changed_at) {
        Some(from) => (kind == 0).then(|| term.since(from + REFINED_ONSET * step)),
        None => term.law.nudges.get(kind).map(|nudge| nudge(term, step)),
    }
}

/// Refines the sizes in `selected`, coarsely first if they were not refined before, and removes members that no longer pay.
pub fn refine(study: &mut Study, selected: Selection, again: bool) -> Selection {
    let before = selected.clone();
    let selected = resize(study, selected, again);
    study.note("a better size or form", &before, &selected);
    let products = study.training_products();
    study.pruned(&products, selected)
}

/// Refines the sizes in `selected`; all members stay, in their order.
pub fn resize(study: &mut Study, selected: Selection, again: bool) -> Selection {
    resize_from(study, selected, if again { 2 } else { 0 }, &|_| true)
}

/// Refines the sizes of the members that are `included`.
pub fn resize_only(study: &mut Study, selected: Selection, included: &dyn Fn(&Candidate) -> bool) -> Selection {
    resize_from(study, selected, 0, included)
}

fn resize_from(
    study: &mut Study,
    mut selected: Selection,
    first: usize,
    included: &dyn Fn(&Candidate) -> bool,
) -> Selection {
    for round in first..REFINED_SIZES.len() {
        selected = resize_once(study, selected, round, included);
    }
    selected
}

/// One round of refinement of the members that are `included`.
fn resize_once(
    study: &mut Study,
    mut selected: Selection,
    round: usize,
    included: &dyn Fn(&Candidate) -> bool,
) -> Selection {
    let mut options: Vec<(usize, Vec<Vec<Term>>)> = Vec::new();
    let mut missing = Vec::new();
    for &member in selected.set.iter().filter(|&&member| included(&study.candidates[member])) {
        let candidate = &study.candidates[member];
        let terms: Vec<Term> = candidate.columns.iter().map(|&column| study.table.terms[column]).collect();
        let mass =
            candidate.joint.map_or(0.0, |joint| mean(study.data.rigid.iter().flat_map(|rigid| rigid.link_mass(joint))));
        let mut list = variants(&terms, round, mass, study.data.motions.changed_at);
        if round == 0 {
            list.extend(first_sizes(study, member));
        }
        list.retain(|terms| study.is_brief(terms) && study.repeats(terms));
        for &term in list.iter().flatten() {
            if !study.table.terms.contains(&term) && !missing.contains(&term) {
                missing.push(term);
            }
        }
        if !list.is_empty() {
            options.push((member, list));
        }
    }
    study.extend(missing);
    let options: Vec<(usize, Vec<usize>)> = options
        .into_iter()
        .map(|(member, list)| {
            let (hypothesis, joint) = (study.candidates[member].hypothesis, study.candidates[member].joint);
            let known = study.candidates.len();
            let add = |terms| study.add(hypothesis, joint, terms);
            let indices = list.into_iter().map(add).collect();
            study.candidates[known..].iter_mut().for_each(|trial| trial.is_trial = true);
            (member, indices)
        })
        .collect();
    let products = study.training_products();
    let problem = study.problem(&products);
    for (member, indices) in options {
        // A size must not become that of another member, as the periods of two ripples may.
        let is_another = |index: usize| selected.set.iter().any(|&m| m != member && problem.exclude(index, m));
        let best = indices
            .into_par_iter()
            .filter(|&index| !is_another(index))
            .filter_map(|index| {
                let set = selected.set.iter().map(|&m| if m == member { index } else { m }).collect();
                let next = problem.choose(set, &selected.fit.weights);
                problem.is_possible(index, &next.fit).then_some(next)
            })
            .collect::<Vec<_>>()
            .into_iter()
            .min_by(|a, b| a.score.total_cmp(&b.score));
        if let Some(best) = best
            && best.score < selected.score
        {
            selected = best;
        }
    }
    selected
}
