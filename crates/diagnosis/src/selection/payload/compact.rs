//! Payloads whose moments of inertia are those of the drives.

use effects::arm::body;
use effects::drive::ROTOR_INERTIA;

use crate::regression::bodies::PER_LINK;
use crate::search::problem::Selection;
use crate::search::study::Study;
use crate::thresholds::LARGEST_BODY;

/// `selected` with a small body in the place of its payload, and with inertias of drives, if that explains as much, and if some
/// drives have an inertia already or no tool has such moments. Where each joint moves alone, the moments of a body and the inertias of the drives have the same torques, and a tool is small.
pub fn with_drives(study: &Study, selected: Selection) -> Selection {
    let mut payloads = selected.set.iter().copied().filter(|&c| study.has_free_moments(c));
    let (Some(payload), None) = (payloads.next(), payloads.next()) else {
        return selected;
    };
    let Some(small) = study.without_moments(payload) else {
        return selected;
    };
    let products = study.training_products();
    let problem = study.problem(&products);
    let is_drive = |&c: &usize| study.candidates[c].hypothesis.is(&ROTOR_INERTIA) && study.always_acts(c);
    let drives: Vec<usize> = study.allowed().into_iter().filter(is_drive).collect();
    // Where no drive has an inertia so far, the moments may be those of a long body, but not of any.
    let values: [f64; PER_LINK] =
        std::array::from_fn(|k| selected.fit.coefficient(study.candidates[payload].columns[k]));
    let of_gyration = (0.5 * body(&values).tensor.trace() / values[0]).max(0.0).sqrt();
    if !selected.set.iter().any(is_drive) && of_gyration < LARGEST_BODY {
        return selected;
    }
    let set: Vec<usize> = selected.set.iter().map(|&c| if c == payload { small } else { c }).collect();
    let next = problem.forward(problem.choose(set, &selected.fit.weights), &drives);
    if next.score < selected.score && problem.is_possible(small, &next.fit) {
        study.note("a small body and drives explain as much", &selected, &next);
        return next;
    }
    selected
}
