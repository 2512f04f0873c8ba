//! What connects a drive to its link: a gap or a spring in place of a delay.

use effects::Spec;
use effects::drive::{ACTUATION_DELAY, BACKLASH, JOINT_ELASTICITY};
use rayon::prelude::*;

use crate::search::candidate::{Candidate, Hypothesis};
use crate::search::problem::Selection;
use crate::search::refine::resize_only;
use crate::search::study::Study;
use crate::thresholds::SWAP_GAIN;

/// The effects that may stand in place of a delay.
const CONNECTIONS: [&Spec; 2] = [&BACKLASH, &JOINT_ELASTICITY];

/// `selected` with a gap or a spring, at its best sizes, in place of each delay that explains less. A delay has one size, and is at its
/// best at once; a gap explains little until its sizes are found, and is excluded by the delay.
pub fn in_place_of_delays(study: &mut Study, mut selected: Selection) -> Selection {
    for delay in selected.set.clone() {
        let Candidate { hypothesis, joint, .. } = study.candidates[delay];
        if !hypothesis.is(&ACTUATION_DELAY) || !study.always_acts(delay) {
            continue;
        }
        let trials: Vec<Selection> =
            CONNECTIONS.iter().filter_map(|kind| sized(study, &selected, delay, kind, joint)).collect();
        let best = trials.into_iter().min_by(|a, b| a.score.total_cmp(&b.score));
        if let Some(best) = best.filter(|best| best.score < selected.score - SWAP_GAIN) {
            study.note("explains more in its place", &selected, &best);
            selected = best;
        }
    }
    selected
}

/// `selected` with an effect of this `kind` on `joint` in place of `member`, at its best sizes.
fn sized(
    study: &mut Study,
    selected: &Selection,
    member: usize,
    kind: &'static Spec,
    joint: Option<usize>,
) -> Option<Selection> {
    let hypothesis = Hypothesis::of(kind);
    let is_this = |candidate: &Candidate| candidate.hypothesis == hypothesis && candidate.joint == joint;
    let first = {
        let products = study.training_products();
        let problem = study.problem(&products);
        let rest = selected.others(member);
        let allowed = study.allowed();
        let forms = allowed.into_par_iter().filter(|&c| {
            let is_free = !rest.iter().any(|&other| other == c || problem.exclude(c, other));
            is_this(&study.candidates[c]) && study.always_acts(c) && is_free
        });
        // A size that is tried first may have a coefficient that is not near one.
        let fitted = forms.map(|c| problem.choose([rest.clone(), vec![c]].concat(), &selected.fit.weights));
        let fitted: Vec<Selection> = fitted.collect();
        fitted.into_iter().min_by(|a, b| a.score.total_cmp(&b.score))?
    };
    let next = resize_only(study, first, &is_this);
    let products = study.training_products();
    let problem = study.problem(&products);
    let mut own = next.set.iter().filter(|&&c| is_this(&study.candidates[c]));
    own.all(|&c| problem.is_possible(c, &next.fit)).then_some(next)
}
