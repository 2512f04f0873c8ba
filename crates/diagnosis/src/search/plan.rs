//! The order of the search: suggest, grow, refine, relinearise, swap.

use crate::options::Step;
use crate::search::connection;
use crate::search::drag;
use crate::search::problem::Selection;
use crate::search::refine::refine;
use crate::search::study::Study;
use crate::thresholds::{MOST_LAST, MOST_REFINEMENTS, MOST_SUGGESTIONS, MOST_SWAPS};

/// Searches the candidates that together explain the training recordings. `progress` receives each step.
pub fn search(study: &mut Study, progress: &dyn Fn(Step<'_>)) -> Selection {
    let baseline: Vec<usize> = (0..study.candidates.len())
        .filter(|&c| study.candidates[c].hypothesis.spec().is_friction && study.always_acts(c))
        .collect();
    let mut selected = {
        let products = study.training_products();
        let problem = study.problem(&products);
        // With a background that is stated, or of placeholders, the weights are not recomputed by themselves.
        problem.reweighted(problem.choose(baseline, &products.first_weights()))
    };
    for round in 1..=MOST_SUGGESTIONS {
        progress(Step::new(0.12 + 0.08 * round as f64, &format!("searching effects, round {round}")));
        let before = selected.set.clone();
        // Unmodelled forms must not hide effects that the residual suggests. Neither must earlier suggestions, which were
        // made with a worse fit: the period of a ripple, a contact or an onset may have taken the place of another one. What changed
        // since the recordings from before does not follow from the residual.
        let products = study.training_products();
        let named = before
            .iter()
            .copied()
            .filter(|&c| {
                let hypothesis = study.candidates[c].hypothesis;
                let sets_in = !study.always_acts(c) && !study.changes(c);
                hypothesis.name().is_some() && !sets_in && !hypothesis.spec().is_suggested
            })
            .collect();
        let next = study.problem(&products).choose(named, &selected.fit.weights);
        study.note("searched again in this round", &selected, &next);
        selected = next;
        study.suggest(&selected);
        let products = study.training_products();
        let problem = study.problem(&products);
        let allowed = study.allowed();
        selected = problem.choose(selected.set, &selected.fit.weights);
        selected = study.grown(selected, &allowed);
        let mut sets = [before, selected.set.clone()];
        sets.iter_mut().for_each(|set| set.sort_unstable());
        if sets[0] == sets[1] {
            break;
        }
    }
    for round in 1..=MOST_REFINEMENTS {
        progress(Step::new(0.32 + 0.1 * round as f64, &format!("refining sizes, round {round}")));
        selected = refine(study, selected, round > 1);
        let formed_anew = study.relinearise(&selected.fit, &selected.set);
        let again = formed_anew.is_some();
        let set = formed_anew.unwrap_or_else(|| selected.set.clone());
        let products = study.training_products();
        let problem = study.problem(&products);
        let allowed = study.allowed();
        let before = set.clone();
        selected = problem.choose(set, &selected.fit.weights);
        let pruned = study.pruned(&products, selected);
        selected = study.grown(pruned, &allowed);
        let products = study.training_products();
        let swapped = study.problem(&products).swap(selected.clone(), &allowed, MOST_SWAPS);
        study.note("explains more in its place", &selected, &swapped);
        study.record_exchange(&selected, &swapped);
        selected = swapped;
        if selected.set != before {
            selected = refine(study, selected, false);
        } else if !again {
            break;
        }
    }
    selected = connection::in_place_of_delays(study, selected);
    selected = drag::beside_viscous_friction(study, selected);
    // With all sizes found, candidates that did not pay or were impossible before may do so, and the residual may show a contact, a
    // ripple or an onset that wrong sizes hid. Where unmodelled forms remain, it would show the errors of these.
    for _ in 0..MOST_LAST {
        let is_named = |&c: &usize| study.candidates[c].hypothesis.name().is_some();
        if selected.set.iter().all(is_named) {
            study.suggest(&selected);
        }
        let allowed = study.allowed();
        let before = selected.set.clone();
        selected = study.chosen(selected.set, &selected.fit.weights);
        selected = study.grown(selected, &allowed);
        if selected.set == before {
            break;
        }
        selected = refine(study, selected, false);
        selected = connection::in_place_of_delays(study, selected);
        selected = drag::beside_viscous_friction(study, selected);
    }
    let selected = study.with_friction_that_changed(selected);
    let selected = study.with_constants_that_changed(selected);
    let selected = study.without_imitations(selected);
    let selected = study.with_payload_for_last_link(selected);
    study.without_payload_of_a_link(selected)
}
