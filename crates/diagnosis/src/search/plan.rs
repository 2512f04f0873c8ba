//! The order of the search: suggest, grow, refine, relinearise, swap.

use crate::options::Step;
use crate::search::problem::Selection;
use crate::search::refine::refine;
use crate::search::study::Study;

/// The largest number of rounds of suggestion.
const SUGGESTIONS: usize = 3;
/// The largest number of rounds of refinement.
const REFINEMENTS: usize = 2;
/// The largest number of consecutive swaps.
const SWAPS: usize = 4;

/// The largest number of last additions.
const LAST: usize = 3;

/// Searches the candidates that together explain the training recordings. `progress` receives each step.
pub fn search(study: &mut Study, progress: &dyn Fn(Step<'_>)) -> Selection {
    let baseline: Vec<usize> = (0..study.candidates.len())
        .filter(|&c| study.candidates[c].hypothesis.is_friction())
        .collect();
    let products = study.training_products();
    let mut chosen = study.problem(&products).choose(baseline, &products.first_weights());
    for round in 1..=SUGGESTIONS {
        progress(Step::new(
            0.12 + 0.08 * round as f64,
            &format!("searching effects, round {round}"),
        ));
        let before = chosen.set.clone();
        // Unmodelled forms must not hide effects that the residual suggests. Neither must earlier suggestions, which were
        // made with a worse fit: the period of a ripple, a contact or an onset may have taken the place of another one.
        let products = study.training_products();
        let named = before
            .iter()
            .copied()
            .filter(|&c| {
                let hypothesis = study.candidates[c].hypothesis;
                let sets_in = study.terms(c).iter().any(|term| term.onset().is_some());
                hypothesis.name().is_some() && !sets_in && !hypothesis.spec().is_suggested
            })
            .collect();
        let next = study.problem(&products).choose(named, &chosen.fit.weights);
        study.note("searched again in this round", &chosen, &next);
        chosen = next;
        study.suggest(&chosen);
        let products = study.training_products();
        let problem = study.problem(&products);
        let allowed = study.allowed();
        chosen = problem.choose(chosen.set, &chosen.fit.weights);
        chosen = study.grown(chosen, &allowed);
        let mut sets = [before, chosen.set.clone()];
        sets.iter_mut().for_each(|set| set.sort_unstable());
        if sets[0] == sets[1] {
            break;
        }
    }
    for round in 1..=REFINEMENTS {
        progress(Step::new(
            0.32 + 0.1 * round as f64,
            &format!("refining sizes, round {round}"),
        ));
        chosen = refine(study, chosen, round > 1);
        let formed_anew = study.relinearise(&chosen.fit, &chosen.set);
        let again = formed_anew.is_some();
        let set = formed_anew.unwrap_or_else(|| chosen.set.clone());
        let products = study.training_products();
        let problem = study.problem(&products);
        let allowed = study.allowed();
        let before = set.clone();
        chosen = problem.choose(set, &chosen.fit.weights);
        let pruned = problem.prune(chosen.clone());
        study.note("costs more evidence than it brings", &chosen, &pruned);
        chosen = study.grown(pruned, &allowed);
        let products = study.training_products();
        let swapped = study.problem(&products).swap(chosen.clone(), &allowed, SWAPS);
        study.note("explains more in its place", &chosen, &swapped);
        chosen = swapped;
        if chosen.set != before {
            chosen = refine(study, chosen, false);
        } else if !again {
            break;
        }
    }
    // With all sizes found, candidates that did not pay or were impossible before may do so.
    for _ in 0..LAST {
        let products = study.training_products();
        let allowed = study.allowed();
        let before = chosen.set.clone();
        chosen = study.problem(&products).choose(chosen.set, &chosen.fit.weights);
        chosen = study.grown(chosen, &allowed);
        if chosen.set == before {
            break;
        }
        chosen = refine(study, chosen, false);
    }
    let chosen = study.without_imitations(chosen);
    let chosen = study.with_payload_for_last_link(chosen);
    study.without_payload_of_a_link(chosen)
}
