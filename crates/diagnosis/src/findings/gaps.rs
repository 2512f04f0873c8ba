//! Intervals of gaps whose ends are not those of the model.

use std::collections::BTreeMap;

use effects::Size;

use crate::report::{Finding, JointFit};
use crate::selection::FinalFit;
use crate::thresholds::{LARGEST_OF_SEEN_GAP, LEAST_OF_SEEN_GAP, OTHER_ENDS, OTHER_ENDS_ABOVE_NOISE};

/// Extends the intervals of gaps on joints whose residual is far above the noise. The ends of such a gap become stiff gradually, so that
/// it seems to be smaller than it is, or let the link bounce.
pub fn widen(last: &FinalFit, fit: &BTreeMap<String, JointFit>, findings: &mut [(Finding, Option<usize>)]) {
    let has_other_ends = |fit: &JointFit| {
        let error = fit.train_nrmse_augmented;
        error >= OTHER_ENDS && error * fit.torque_std >= OTHER_ENDS_ABOVE_NOISE * fit.noise
    };
    for (finding, candidate) in findings {
        let on = finding.joint.as_ref().and_then(|joint| fit.get(joint));
        let (Some(candidate), true) = (*candidate, on.is_some_and(has_other_ends)) else {
            continue;
        };
        let has_ends = |sizes: &[(Size, usize)]| sizes.iter().any(|(size, _)| *size == Size::Stop);
        if !last.study.terms(candidate).iter().any(|term| has_ends(term.law.sizes)) {
            continue;
        }
        for main in finding.as_effect.spec().main {
            if let Some(size) = finding.parameters.get_mut(main) {
                let [low, high] = size.ci95;
                size.ci95 = [low.min(LEAST_OF_SEEN_GAP * size.value), high.max(LARGEST_OF_SEEN_GAP * size.value)];
            }
        }
    }
}
