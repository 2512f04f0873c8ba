//! A tool that the URDF contains and that is not mounted, which the background represents as a change of the last link.
//!
//! Any change of the last link may be a body on the tool, because the ten columns are the same. A general change of all links'
//! inertial parameters costs fewer nats than ten coefficients, so that the search leaves a missing tool to the background. If
//! that one body explains nearly as much as the background of all links, it is named.

use effects::arm::Payload;

use crate::regression::bodies::PER_LINK;
use crate::regression::strengths::Strengths;
use crate::search::problem::Selection;
use crate::search::study::Study;
use crate::selection::bootstrap::{Resampled, resample};
use crate::selection::judge::{self, Judged};
use crate::selection::naming::name;
use crate::selection::predict::{augmented, errors};
use crate::selection::rivals::{allowance, standing};
use crate::thresholds::{LEAST_OF_THE_LINK, NEARLY_ALL, PARTLY, UNDECIDED_NATS};

/// Names a body that is missing at the tool, if the background represents one and no other effect explains nearly as much in its
/// place; returns the new resamplings. Other payloads are unchanged: a part of the background, or named by the search.
pub fn unmounted(study: &mut Study, judged: &mut Judged) -> Option<Resampled> {
    let is_payload = |c: usize| study.candidates[c].hypothesis.is(&Payload);
    if study.strengths.links.last().is_none_or(|&rho| rho == 0.0) || judged.named.set.iter().any(|&c| is_payload(c)) {
        return None;
    }
    let whole = |&c: &usize| is_payload(c) && study.candidates[c].columns.len() == PER_LINK;
    let always = |&c: &usize| study.always_acts(c);
    let body = (0..study.candidates.len()).filter(whole).find(always)?;
    let (strengths, next) = instead(study, &judged.named, body)?;
    let before = std::mem::replace(&mut study.strengths, strengths);
    let resampled = resample(study, &next);
    let drawn = study.arm.inertial_parameters()[(study.arm.dof() - 1) * PER_LINK];
    let is_missing = name(study, &resampled.evenly(), body)
        .first()
        .and_then(|named| named.parameters.get("mass"))
        .is_some_and(|mass| mass.ci95[1] < 0.0 && -mass.value >= LEAST_OF_THE_LINK * drawn);
    let products = study.training_products();
    let problem = study.problem(&products);
    let is_undecided = || {
        let standing = standing(study, &problem, &next, body);
        standing.margin < UNDECIDED_NATS && !standing.rivals.is_empty()
    };
    if !is_missing || is_undecided() || !explains_a_part(study, &next) {
        study.strengths = before;
        return None;
    }
    judged.members = judge::describe(study, &problem, &next);
    study.note_strengths(
        "one missing body explains nearly as much as the background",
        &judged.named,
        &next,
    );
    judged.named = next;
    Some(resampled)
}

/// Whether `selected` explains a part of the torque on any joint that moves. On torques that do not depend on the motion, a body that
/// cancels the model's own torque reduces every error, too, but only to that of a constant.
fn explains_a_part(study: &Study, selected: &Selection) -> bool {
    (0..study.motions.dof).any(|joint| {
        let fit = errors(study, joint, &augmented(study, selected, joint));
        fit.train_nrmse_nominal > 0.0 && fit.train_nrmse_augmented < PARTLY
    })
}

/// `selected` with a missing `body` and a smaller background, if the body explains nearly as much as that background and both
/// predict held-out recordings nearly as well.
fn instead(study: &Study, selected: &Selection, body: usize) -> Option<(Strengths, Selection)> {
    let with = [selected.set.as_slice(), &[body]].concat();
    let fit = |strengths: &Strengths, set: &[usize]| {
        let products = study.products_at(strengths);
        let problem = study.problem(&products);
        let next = problem.reweighted(problem.choose(set.to_vec(), &selected.fit.weights));
        let is_possible = !set.contains(&body) || problem.is_possible(body, &next.fit);
        (next, is_possible)
    };
    let exact = Strengths {
        links: vec![0.0; study.arm.dof()],
        ..study.strengths.clone()
    };
    let (bare, _) = fit(&exact, &selected.set);
    let (alone, _) = fit(&exact, &with);
    let explained = bare.score - selected.score;
    if bare.score - alone.score < NEARLY_ALL * explained {
        return None;
    }
    let fitted = study
        .stated
        .weaker(&study.strengths)
        .map(|strengths| (fit(&strengths, &with), strengths));
    let ((next, _), strengths) = fitted
        .filter(|((next, is_possible), _)| {
            *is_possible && next.fit.coefficient(study.candidates[body].columns[0]) < 0.0
        })
        .min_by(|a, b| a.0.0.score.total_cmp(&b.0.0.score))?;
    if next.score - selected.score > allowance(explained) {
        return None;
    }
    if let Some(held) = study.held_products() {
        let loss = |selected: &Selection| held.loss_of(&study.table, &selected.fit);
        if loss(&next) - loss(selected) > allowance(loss(&bare) - loss(selected)) {
            return None;
        }
    }
    Some((strengths, next))
}
