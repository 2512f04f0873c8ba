//! Viscous friction beside drag.

use effects::Term;
use effects::friction::{DRAG, QUADRATIC_DRAG, TURBULENT, VISCOUS_FRICTION};

use crate::search::candidate::{Candidate, Hypothesis};
use crate::search::problem::Selection;
use crate::search::study::Study;

/// `selected` with viscous friction and a drag with an exponent of two, in place of each drag with a smaller exponent, unless that drag
/// explains more than the two together. A smaller exponent resembles viscous friction, which most joints have, and has as many sizes as both.
pub fn beside_viscous_friction(study: &mut Study, mut selected: Selection) -> Selection {
    for drag in selected.set.clone() {
        let Candidate { hypothesis, joint, .. } = study.candidates[drag];
        let is_less = |term: &Term| term.is(&DRAG) && term.sizes[0] < TURBULENT;
        let (true, Some(joint)) = (hypothesis.is(&QUADRATIC_DRAG), joint) else {
            continue;
        };
        if !study.terms(drag).iter().all(is_less) {
            continue;
        }
        let viscous = Hypothesis::of(&VISCOUS_FRICTION);
        let is_viscous = |&c: &usize| {
            let other = &study.candidates[c];
            other.hypothesis == viscous && other.joint == Some(joint) && study.always_acts(c)
        };
        let is_there = selected.set.iter().any(is_viscous) || study.has_known(viscous, Some(joint));
        let mut allowed = study.allowed().into_iter();
        let Some(friction) = allowed.find(is_viscous).filter(|_| !is_there) else {
            continue;
        };
        let textbook = study.add(hypothesis, Some(joint), vec![Term::on(&DRAG, joint).sized([TURBULENT])]);
        let products = study.training_products();
        let problem = study.problem(&products);
        if selected.set.iter().any(|&c| problem.exclude(friction, c)) {
            continue;
        }
        let set = [selected.others(drag), vec![textbook, friction]].concat();
        let next = problem.choose(set, &selected.fit.weights);
        let alone = problem.choose([selected.others(drag), vec![textbook]].concat(), &selected.fit.weights);
        let are_possible = [textbook, friction].iter().all(|&c| problem.is_possible(c, &next.fit));
        let is_as_good = next.score - study.candidates[friction].cost <= selected.score;
        if are_possible && is_as_good && next.score < alone.score {
            study.note("viscous friction and an exponent of two explain as much", &selected, &next);
            selected = next;
        }
    }
    selected
}
