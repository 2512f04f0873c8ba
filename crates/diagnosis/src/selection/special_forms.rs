//! Special forms of wrong inertial parameters: effects that explain, beside links that differ less from the URDF, nearly as much as
//! the correction of all links does without them.

use effects::Acts;
use effects::drive::ROTOR_INERTIA;
use rayon::prelude::*;

use crate::regression::strengths::PriorStrengths;
use crate::search::candidate::Candidate;
use crate::search::problem::{Problem, Selection};
use crate::search::study::Study;
use crate::selection::rivals::Rival;
use crate::thresholds::{MOST_SPECIAL_FORMS, NEARLY_AS_LIKELY, NEARLY_NATS, SPECIAL_FORMS_TRIED};

/// The special forms that the recordings do not exclude: names that were given up because wrong inertial parameters explain nearly as
/// much, then those that are as likely beside a smaller correction of the links, or explain as much beside it. Also the least score of
/// one of the latter beyond that of `selected`, the final fit (nats); infinite without one.
pub fn special_forms(study: &Study, selected: &Selection) -> (f64, Vec<Rival>) {
    let links = |strengths: &PriorStrengths| strengths.links.clone();
    let is_smaller =
        |strengths: &PriorStrengths| links(strengths) != links(&study.strengths) && study.stated.allows(strengths);
    let smaller: Vec<PriorStrengths> = study.strengths.weaker().into_iter().filter(is_smaller).collect();
    let mut scores: Vec<(f64, Rival)> = smaller
        .into_par_iter()
        .flat_map_iter(|strengths| {
            let products = study.products_at(&strengths);
            beside(&Beside::new(study, study.problem(&products), selected))
        })
        .filter(|(next, _)| is_nearly_as_good(next, selected))
        .map(|(next, form)| (next.score, form))
        .collect();
    scores.sort_by(|a, b| a.0.total_cmp(&b.0));
    let margin = scores.first().map_or(f64::INFINITY, |(score, _)| score - selected.score);
    let mut forms: Vec<Rival> = Vec::new();
    for form in study.given_up.iter().chain(scores.iter().map(|(_, form)| form)) {
        let is_named = |&c: &usize| (study.candidates[c].hypothesis, study.candidates[c].joint) == *form;
        if !forms.contains(form) && !selected.set.iter().any(is_named) {
            forms.push(*form);
        }
    }
    forms.truncate(MOST_SPECIAL_FORMS);
    (margin, forms)
}

/// The special forms that are nearly as likely as a `link` that differs more than most links, beside one that does not: each with its
/// score beyond that of `selected` (nats), the most likely first.
pub fn in_place_of_link(study: &Study, selected: &Selection, link: usize) -> Vec<(f64, Rival)> {
    let strengths = study.strengths.with_link_as_most(link);
    let products = study.products_at(&strengths);
    let most = Beside::new(study, study.problem(&products), selected);
    let mut forms: Vec<(f64, Rival)> = beside(&most)
        .into_iter()
        .chain(drive_inertias_beside(&most))
        .filter(|(next, _)| is_nearly_as_good(next, selected))
        .map(|(next, form)| (next.score - selected.score, form))
        .collect();
    forms.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut known: Vec<Rival> = Vec::new();
    forms.retain(|(_, form)| {
        let is_new = !known.contains(form);
        known.push(*form);
        is_new
    });
    forms.truncate(MOST_SPECIAL_FORMS);
    forms
}

/// Whether a fit is nearly as likely as the `selected` one, or explains as much with more parameters. A body on the tool has up to ten of
/// them, and links that are all wrong cost less, however wrong they are.
fn is_nearly_as_good(next: &Selection, selected: &Selection) -> bool {
    next.score < selected.score + NEARLY_AS_LIKELY || next.fit.loss < selected.fit.loss + NEARLY_NATS
}

/// A selection beside links of other strengths.
struct Beside<'a> {
    study: &'a Study,
    /// The fit beside these links.
    problem: Problem<'a>,
    selected: &'a Selection,
    /// `selected`, fitted again beside these links.
    base: Selection,
}

impl<'a> Beside<'a> {
    fn new(study: &'a Study, problem: Problem<'a>, selected: &'a Selection) -> Self {
        let base = problem.reweighted(problem.choose(selected.set.clone(), &selected.fit.weights));
        Self { study, problem, selected, base }
    }

    /// The candidates that always act, may be added, and are `wanted`.
    fn free(&self, wanted: impl Fn(&Candidate) -> bool) -> Vec<usize> {
        let is_free = |&c: &usize| {
            let candidate = &self.study.candidates[c];
            wanted(candidate)
                && self.problem.acts(candidate) == Acts::Always
                && !self.selected.set.iter().any(|&other| other == c || self.problem.exclude(c, other))
        };
        self.study.allowed().into_iter().filter(is_free).collect()
    }

    fn rival(&self, c: usize) -> Rival {
        (self.study.candidates[c].hypothesis, self.study.candidates[c].joint)
    }
}

/// The drives' inertias that are likely together, each with the fit of all. Nearly every URDF omits them on every joint.
fn drive_inertias_beside(most: &Beside<'_>) -> Vec<(Selection, Rival)> {
    let Beside { problem, selected, base, .. } = most;
    let free = most.free(|candidate| candidate.hypothesis.is(&ROTOR_INERTIA));
    let with = problem.reweighted(problem.forward(base.clone(), &free));
    let is_whole = selected.set.iter().all(|c| with.set.contains(c));
    let added = with.set.iter().filter(|c| is_whole && !selected.set.contains(c));
    added.map(|&c| (with.clone(), most.rival(c))).collect()
}

/// The most promising special forms, each with its fit.
fn beside(these: &Beside<'_>) -> Vec<(Selection, Rival)> {
    let Beside { problem, selected, base, .. } = these;
    // A rotor adds to the inertia of its link about the joint's axis, which is all that a first link on a vertical axis shows.
    let free = these.free(|candidate| {
        candidate.hypothesis.name().is_some()
            && (candidate.hypothesis.spec().may_be_inertial || candidate.hypothesis.is(&ROTOR_INERTIA))
    });
    let mut promises = problem.promises(base, &free);
    promises.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let of = |c: usize| these.rival(c);
    let mut forms: Vec<Rival> = Vec::new();
    for &(promise, c) in &promises {
        if promise > 0.0 && forms.len() < SPECIAL_FORMS_TRIED && !forms.contains(&of(c)) {
            forms.push(of(c));
        }
    }
    // A body on the tool may be a point or have moments of inertia.
    let tried = free.into_iter().filter(|&c| forms.contains(&of(c)));
    let fitted = tried.filter_map(|c| {
        let with = problem.choose([&selected.set[..], &[c]].concat(), &base.fit.weights);
        let pays = with.score < base.score && problem.is_possible(c, &with.fit);
        pays.then(|| (problem.reweighted(with), of(c)))
    });
    fitted.collect()
}
