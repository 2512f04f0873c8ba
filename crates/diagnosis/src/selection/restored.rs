//! Effects that return to the final fit after what removed them is gone.

use effects::sensor::TORQUE_OFFSET;

use crate::search::problem::Selection;
use crate::search::study::{Claim, Study};
use crate::selection::judge::{self, Judged};

/// Adds `friction` again that was removed because of a joint's held-out error, if it is likely beside the background that replaced it: beside a
/// wrong link, friction may have been a part of the error. Candidates of the catalogue keep their numbers.
pub fn restore(study: &mut Study, judged: &mut Judged, friction: Vec<usize>) {
    if friction.is_empty() {
        return;
    }
    let products = study.training_products();
    let problem = study.problem(&products);
    let mut next = judged.named.clone();
    for c in friction {
        let with = problem.choose([&next.set[..], &[c]].concat(), &next.fit.weights);
        if with.score < next.score && problem.is_possible(c, &with.fit) {
            next = with;
        }
    }
    if next.set.len() > judged.named.set.len() {
        study.note("likely again beside another background", &judged.named, &next);
        judged.members = judge::describe(&problem, &next);
        judged.named = next;
    }
}

/// Adds constant torques that have the evidence of a name, after another effect was removed that may have stood for them, as a tilted base does.
/// Joints that `had` one in the final fit are excluded: it was removed for a reason of its own.
pub fn add_constants(study: &mut Study, judged: &mut Judged, had: &[usize]) {
    let products = study.training_products();
    let problem = study.problem(&products);
    let before = judged.named.clone();
    let is_constant = |c: &usize| study.candidates[*c].hypothesis.is(&TORQUE_OFFSET) && study.always_acts(*c);
    let is_free = |c: &usize, named: &Selection| {
        let joint = study.candidates[*c].joint;
        joint.is_some_and(|joint| !had.contains(&joint)) && !named.set.iter().any(|&other| problem.exclude(*c, other))
    };
    let constants: Vec<usize> = study.allowed().into_iter().filter(is_constant).collect();
    loop {
        let named = &judged.named;
        let with = |&c: &usize| problem.choose([&named.set[..], &[c]].concat(), &named.fit.weights);
        let next = constants.iter().filter(|c| !named.set.contains(c) && is_free(c, named)).map(with);
        match next.min_by(|a, b| a.score.total_cmp(&b.score)) {
            Some(best) if best.score < named.score - study.thresholds.least_evidence => judged.named = best,
            _ => break,
        }
    }
    if judged.named.set.len() > before.set.len() {
        study.note("another effect that stood for it is dropped", &before, &judged.named);
        judged.members = judge::describe(&problem, &judged.named);
    }
}

/// Adds the best of the effects that the search exchanged for the one of `claim`, which is no longer named, if it has the evidence of a name.
pub fn take_back(study: &mut Study, judged: &mut Judged, claim: Claim) {
    let exchanged = study.take_exchanged_for(claim);
    if exchanged.is_empty() {
        return;
    }
    let products = study.training_products();
    let problem = study.problem(&products);
    let named = &judged.named;
    let is_free = |&c: &usize| !named.set.iter().any(|&other| other == c || problem.exclude(c, other));
    let with = |c: usize| (c, problem.choose([&named.set[..], &[c]].concat(), &named.fit.weights));
    let removed = exchanged.into_iter().filter(is_free).map(with);
    let possible = removed.filter(|(c, next)| problem.is_possible(*c, &next.fit));
    let Some((_, best)) = possible.min_by(|a, b| a.1.score.total_cmp(&b.1.score)) else { return };
    if best.score < named.score - study.thresholds.least_evidence {
        study.note("the effect that had taken its place is dropped", named, &best);
        judged.members = judge::describe(&problem, &best);
        judged.named = best;
    }
}
