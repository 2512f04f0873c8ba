//! Stribeck friction that only the rows near reversals show.

use effects::friction::{COULOMB_FRICTION, STRIBECK_FRICTION, stribeck_velocity};

use crate::search::candidate::{Candidate, Hypothesis};
use crate::search::problem::{Problem, Selection};
use crate::search::refine::resize_only;
use crate::search::study::Study;
use crate::selection::judge::{self, Judged};
use crate::thresholds::{LEAST_AT_REVERSALS, SLOWEST_AT_REVERSALS};

/// Names Stribeck friction in place of Coulomb friction, if the rows of the final fit require it and it predicts the held-out recordings better. The
/// search does without the rows near
/// reversals, on which the friction of a joint that turns quickly is larger, if it falls at all.
pub fn at_reversals(study: &mut Study, judged: &mut Judged) {
    let coulomb = Hypothesis::of(&COULOMB_FRICTION);
    let is_plain = |study: &Study, c: usize| study.candidates[c].hypothesis == coulomb && study.always_acts(c);
    let before: Vec<usize> = judged.named.set.iter().copied().filter(|&c| is_plain(study, c)).collect();
    for friction in before {
        let Some(joint) = study.candidates[friction].joint else {
            continue;
        };
        let stribeck = Hypothesis::of(&STRIBECK_FRICTION);
        let is_form = |candidate: &Candidate| candidate.hypothesis == stribeck && candidate.joint == Some(joint);
        let always_acts = |&c: &usize| is_form(&study.candidates[c]) && study.always_acts(c);
        let forms: Vec<usize> = study.allowed().into_iter().filter(always_acts).collect();
        let products = study.training_products();
        let Some(best) = best_of(&study.problem(&products), &judged.named, friction, &forms) else {
            continue;
        };
        let best = resize_only(study, best, &is_form);
        let products = study.training_products();
        let problem = study.problem(&products);
        // A fall near standstill is an error of the model at reversals.
        let slowest = SLOWEST_AT_REVERSALS * study.data.scales.rest[joint];
        let is_slow = |c: usize| stribeck_velocity(&study.terms(c)).is_some_and(|velocity| velocity >= slowest);
        let is_possible =
            best.set.iter().any(|&c| is_form(&study.candidates[c]) && is_slow(c) && problem.is_possible(c, &best.fit));
        let predicts_more = || {
            study.held_products().is_none_or(|held| {
                held.loss_of(&study.table, &best.fit) < held.loss_of(&study.table, &judged.named.fit)
            })
        };
        if is_possible && best.score < judged.named.score - LEAST_AT_REVERSALS && predicts_more() {
            study.note("the rows near reversals require it", &judged.named, &best);
            judged.members = judge::describe(&problem, &best);
            judged.named = best;
        }
    }
}

/// The best fit with one of the `forms` in place of `friction`, as the last member; `None` if none is possible there.
fn best_of(problem: &Problem<'_>, selected: &Selection, friction: usize, forms: &[usize]) -> Option<Selection> {
    let others = selected.others(friction);
    let is_free = |&&form: &&usize| !others.iter().any(|&c| problem.exclude(form, c));
    let trials = forms.iter().filter(is_free).filter_map(|&form| {
        let next = problem.choose([others.as_slice(), &[form]].concat(), &selected.fit.weights);
        problem.is_possible(form, &next.fit).then_some(next)
    });
    trials.min_by(|a, b| a.score.total_cmp(&b.score))
}
