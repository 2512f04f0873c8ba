//! The control for comparison: full linear identification, without names.

use effects::OMITTED_BY_MOST;

use crate::regression::strengths::PriorStrengths;
use crate::regression::table::Moving;
use crate::search::study::Study;
use crate::selection::predict::errors_with;
use crate::thresholds::FREE_INERTIALS;

/// The held-out error (NRMSE) of each joint with least squares on all inertial parameters, and on viscous and Coulomb friction,
/// drive inertia and a constant of every joint. It is fitted to, and measured on, the rows of the final fit, which include those near
/// reversals. `study` is that before the search, with the columns about the nominal arm.
pub fn identified(study: &Study) -> Vec<Option<f64>> {
    let dof = study.data.arm.dof();
    let strengths = PriorStrengths { links: vec![FREE_INERTIALS; dof], ..PriorStrengths::none(dof) };
    let is_part = |&candidate: &usize| {
        let hypothesis = study.candidates[candidate].hypothesis;
        study.always_acts(candidate) && OMITTED_BY_MOST.iter().any(|&kind| hypothesis.is(kind))
    };
    let parts = (0..study.candidates.len()).filter(is_part);
    let columns = parts.flat_map(|candidate| study.candidates[candidate].columns.clone());
    let columns: Vec<usize> = columns.collect();
    let (table, products) = study.reduced(&columns, Vec::new(), Moving::ThroughReversals, &strengths);
    let selected: Vec<usize> = (table.terms.len() - columns.len()..table.terms.len()).collect();
    let fit = products.fit(&table, &selected, &products.first_weights());
    let fit = products.reweighted(&table, fit);
    let of = |joint| errors_with(&study.data, &table, &fit, joint).held_out_nrmse_augmented;
    (0..dof).map(of).collect()
}
