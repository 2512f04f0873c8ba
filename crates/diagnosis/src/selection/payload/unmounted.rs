//! A tool that the URDF contains and that is not mounted, which the background represents as a change of the last link.
//!
//! Any change of the last link may be a body on the tool, because the ten columns are the same. A general change of all links'
//! inertial parameters costs fewer nats than ten coefficients, so that the search leaves a missing tool to the background. If
//! that one body explains nearly as much as the background of all links, it is named, and also if there is clearly more evidence
//! for the body beside another background.

use effects::arm::{INERTIAL_PARAMETERS, LINK_INERTIAL_ERROR};

use crate::regression::bodies::PER_LINK;
use crate::regression::strengths::PriorStrengths;
use crate::search::problem::Selection;
use crate::search::study::Study;
use crate::selection::bootstrap::{Resampled, resample};
use crate::selection::judge::{self, Judged};
use crate::selection::naming::name;
use crate::selection::predict::errors_with;
use crate::selection::rivals::{Rival, allowance, compared};
use crate::thresholds::{LEAST_BESIDE_SOME_LINKS, LEAST_OF_THE_LINK, NEARLY_ALL, PARTLY, UNDECIDED_NATS};

/// Names a body that is missing at the tool, if the background or a lighter last link represents one and no other effect explains
/// nearly as much in its place; returns the new resamplings. Other payloads are unchanged: a part of the background, or named by
/// the search.
pub fn unmounted(study: &mut Study, judged: &mut Judged) -> Option<Resampled> {
    let lighter = lighter_last_link(study, &judged.named);
    let is_exact = study.strengths.links.last().is_none_or(|&rho| rho == 0.0);
    if is_exact && lighter.is_none() || judged.named.set.iter().any(|&c| study.is_payload(c)) {
        return None;
    }
    let whole = |&c: &usize| study.is_payload(c) && study.candidates[c].columns.len() == PER_LINK;
    let always = |&c: &usize| study.always_acts(c);
    let body = (0..study.candidates.len()).filter(whole).find(always)?;
    // About the last link's body without the tool, the quadratic prior is smallest between that body and the URDF's. Beside the
    // missing body, it would leave a part of the tool to the link.
    let prior = study.set_bodies_but_the_last(&judged.named.fit);
    let Some(MissingBodyFit { strengths, next, rule }) = missing_body_fit(study, &judged.named, lighter, body) else {
        study.set_prior(prior);
        return None;
    };
    let before = std::mem::replace(&mut study.strengths, strengths);
    let resampled = resample(study, &next);
    let is_missing = name(study, &resampled.evenly(), body)
        .first()
        .and_then(|named| named.parameters.get("mass"))
        .is_some_and(|mass| mass.ci95[1] < 0.0 && -mass.value >= LEAST_OF_THE_LINK * study.mass_of_last_link());
    let products = study.training_products();
    let problem = study.problem(&products);
    let is_undecided = || {
        let comparison = compared(study, &problem, &next, body);
        // The background and a lighter last link were compared in `instead`.
        let replaced = lighter.map(|c| (study.candidates[c].hypothesis, study.candidates[c].joint));
        let is_other = |rival: &Rival| !rival.0.is(&INERTIAL_PARAMETERS) && Some(*rival) != replaced;
        comparison.margin < UNDECIDED_NATS && comparison.rivals.iter().any(is_other)
    };
    if !is_missing || is_undecided() || !explains_a_part(study, &next) {
        study.strengths = before;
        study.set_prior(prior);
        return None;
    }
    judged.members = judge::describe(&problem, &next);
    study.note_strengths(rule, &judged.named, &next);
    judged.named = next;
    Some(resampled)
}

/// Whether `selected` explains a part of the torque on any joint that moves. On torques that do not depend on the motion, a body that
/// cancels the model's own torque reduces every error, too, but only to that of a constant.
fn explains_a_part(study: &Study, selected: &Selection) -> bool {
    (0..study.data.motions.dof).any(|joint| {
        let fit = errors_with(&study.data, &study.table, &selected.fit, joint);
        fit.train_nrmse_nominal > 0.0 && fit.train_nrmse_augmented < PARTLY
    })
}

/// A fit with a missing body.
struct MissingBodyFit {
    strengths: PriorStrengths,
    next: Selection,
    /// Why it takes the place of the fit without the body.
    rule: &'static str,
}

/// The named error of the last link, if it makes the link lighter by more than a URDF is wrong without a missing tool.
fn lighter_last_link(study: &Study, selected: &Selection) -> Option<usize> {
    let last = study.data.arm.dof().checked_sub(1)?;
    let is_lighter = |&c: &usize| {
        let candidate = &study.candidates[c];
        candidate.hypothesis.is(&LINK_INERTIAL_ERROR)
            && candidate.joint == Some(last)
            && study.always_acts(c)
            && selected.fit.coefficient(candidate.columns[0]) < -LEAST_OF_THE_LINK
    };
    selected.set.iter().copied().find(is_lighter)
}

/// `selected` with a missing `body` in the place of a `lighter` last link and of a part of the background, if the body explains nearly
/// as much as these, or the evidence is clearly greater with it, and if both predict held-out recordings nearly as well.
///
/// Scores are compared each with the prior about its own bodies. The determinants of the two priors differ by up to 20 nats in
/// favour of `selected` where the last link loses nine tenths of its mass.
fn missing_body_fit(
    study: &Study,
    selected: &Selection,
    lighter: Option<usize>,
    body: usize,
) -> Option<MissingBodyFit> {
    let others: Vec<usize> = selected.set.iter().copied().filter(|&c| Some(c) != lighter).collect();
    let with = [others.as_slice(), &[body]].concat();
    let fit = |strengths: &PriorStrengths, set: &[usize]| {
        let products = study.products_at(strengths);
        let problem = study.problem(&products);
        let next = problem.reweighted(problem.choose(set.to_vec(), &selected.fit.weights));
        let is_possible = !set.contains(&body) || problem.is_possible(body, &next.fit);
        (next, is_possible)
    };
    let exact = PriorStrengths { links: vec![0.0; study.data.arm.dof()], ..study.strengths.clone() };
    let (bare, _) = fit(&exact, &others);
    let (alone, _) = fit(&exact, &with);
    let explained = bare.score - selected.score;
    let is_nearly_all = explained > 0.0 && bare.score - alone.score >= NEARLY_ALL * explained;
    let fitted = study
        .stated
        .weaker(&study.strengths)
        .chain([study.strengths.clone()])
        .chain(study.strengths.finer())
        .filter(|strengths| study.stated.allows(strengths))
        .map(|strengths| (fit(&strengths, &with), strengths));
    let ((next, _), strengths) = fitted
        .filter(|((next, is_possible), _)| {
            *is_possible && next.fit.coefficient(study.candidates[body].columns[0]) < 0.0
        })
        .min_by(|a, b| a.0.0.score.total_cmp(&b.0.0.score))?;
    let (most, rule) = match lighter {
        _ if is_nearly_all => (allowance(explained), "one missing body explains nearly as much as the background"),
        // A missing tool is likelier than a last link that is lighter by as much.
        Some(_) => (UNDECIDED_NATS, "a missing body explains as much as a lighter last link"),
        None => (-LEAST_BESIDE_SOME_LINKS, "a missing body explains more than the last link's background"),
    };
    if next.score - selected.score > most {
        return None;
    }
    if let Some(held) = study.held_products() {
        let loss = |selected: &Selection| held.loss_of(&study.table, &selected.fit);
        if loss(&next) - loss(selected) > allowance(loss(&bare) - loss(selected)) {
            return None;
        }
    }
    Some(MissingBodyFit { strengths, next, rule })
}
