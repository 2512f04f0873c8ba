//! Payloads whose moments of inertia no body has, because the recordings do not determine all of them.

use effects::arm::{body, exists};
use nalgebra::Matrix6;

use crate::regression::bodies::{PER_LINK, WITHOUT_MOMENTS, nearest_tensor};
use crate::search::study::Study;
use crate::selection::judge::{self, Judged};

/// Gives the payload, if its moments are impossible, the possible ones that the recordings contradict least: it is replaced by the
/// payload without moments in the fit, which has them as its tensor. Returns whether a payload was replaced.
pub fn make_moments_possible(study: &mut Study, judged: &mut Judged) -> bool {
    let mut payloads = judged.named.set.iter().copied().filter(|&c| study.is_payload(c));
    // Two payloads have one tensor in the fit, if neither has moments.
    let (Some(payload), None) = (payloads.next(), payloads.next()) else {
        return false;
    };
    if !study.has_free_moments(payload) {
        return false;
    }
    let columns = study.candidates[payload].columns.clone();
    let values: [f64; PER_LINK] = std::array::from_fn(|k| judged.named.fit.coefficient(columns[k]));
    let (mass, tensor) = (values[0], body(&values).tensor);
    if exists(mass, &tensor) {
        return false;
    }
    let Some(without) = study.without_moments(payload) else {
        return false;
    };
    let products = study.training_products();
    // The moments last, so that everything else adapts to them.
    let mut all = judged.named.fit.selected().to_vec();
    all.retain(|column| !columns.contains(column));
    all.extend(&columns);
    let fit = products.solve(&study.table, &all, &judged.named.fit.weights);
    let information = fit.information_of_last(PER_LINK - WITHOUT_MOMENTS);
    let precision = Matrix6::from_fn(|i, k| information[(i, k)]);
    let Some(nearest) = nearest_tensor(&(tensor * mass.signum()), &precision) else {
        return false;
    };
    let mut set = judged.named.set.clone();
    set.iter_mut().filter(|c| **c == payload).for_each(|c| *c = without);
    let problem = study.problem(&products);
    let next = problem.choose(set, &judged.named.fit.weights);
    study.note("no body has its moments of inertia", &judged.named, &next);
    judged.members = judge::describe(&problem, &next);
    judged.named = next;
    study.load_tensor = nearest * mass.signum();
    true
}
