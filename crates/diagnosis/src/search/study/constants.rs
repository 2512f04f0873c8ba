//! Torque constants: those of the background that are possible, and those of all joints that changed together, in the place of changes of
//! masses and friction that imitate them.

use effects::Spec;
use effects::arm::{INERTIAL_SCALE, LINK_INERTIAL_ERROR};
use effects::sensor::TORQUE_SCALE;

use super::Study;
use crate::regression::fit::Fit;
use crate::regression::strengths::PriorStrengths;
use crate::search::problem::Selection;
use crate::thresholds::{FACTOR_OF_MASSES, MOST_CONSTANT, MOST_DEVIATIONS};

/// Factors on masses: torque constants of several joints resemble them.
const OF_MASSES: [&Spec; 2] = [&INERTIAL_SCALE, &LINK_INERTIAL_ERROR];

impl Study {
    /// The fit of `selected` beside a background of these strengths, from which those torque constants are left out, the farthest one
    /// first, that would be wrong by more than any is.
    pub(super) fn with_possible_constants(
        &self,
        mut strengths: PriorStrengths,
        mut selected: Selection,
    ) -> (PriorStrengths, Selection) {
        let most = MOST_CONSTANT.max(MOST_DEVIATIONS * self.stated.torque_accuracy());
        loop {
            let products = self.products_at(&strengths);
            selected = self.problem(&products).reweighted(selected);
            let deviation = |joint: usize| {
                let column = self.torque_constant(joint)?;
                Some((selected.fit.coefficient(column).abs(), joint)).filter(|(deviation, _)| *deviation > most)
            };
            let farthest = (0..self.data.motions.dof).filter_map(deviation).max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, joint)) = farthest else {
                return (strengths, selected);
            };
            strengths.impossible_constants.push(joint);
            let products = self.products_at(&strengths);
            selected = self.problem(&products).choose(selected.set.clone(), &selected.fit.weights);
        }
    }

    /// `selected` with a changed torque constant on each joint in the place of masses and friction that changed since the recordings
    /// from before, if a mass changed and if the constants explain more.
    ///
    /// A search that takes one effect after the other takes a factor of all masses first, or a payload, because it explains more
    /// than the constant of any one joint, and then friction that the factor does not multiply. Masses do not change by a factor,
    /// but all constants do, where a recorder begins to write torques in another unit.
    pub fn with_constants_that_changed(&mut self, selected: Selection) -> Selection {
        let is_wrong_mass = |&c: &usize| self.changes(c) && self.candidates[c].hypothesis.spec().is_wrong_mass;
        if !selected.set.iter().any(is_wrong_mass) {
            return selected;
        }
        let has_factor = selected.set.iter().any(|&c| self.changes(c) && self.is_factor_of_masses(c));
        let most = selected.score + if has_factor { FACTOR_OF_MASSES } else { 0.0 };
        let before = (self.strengths.clone(), self.prior.clone());
        let mut kept = selected.set.clone();
        for all in [false, true] {
            if all && !has_factor {
                break;
            }
            // Beside a factor, any other change may imitate the constants, too.
            let is_replaced = |c: usize| all || self.is_replaced_by_constants(c);
            let others = kept.iter().copied();
            let others = others.filter(|&c| !(self.changes(c) && is_replaced(c))).collect();
            let next;
            (next, kept) = self.with_all_constants(others, kept, &selected.fit.weights);
            if next.score < most {
                return next;
            }
            (self.strengths, self.prior) = before.clone();
        }
        // What was before, evaluated about its own arm again.
        let fit = self.chosen(kept.clone(), &selected.fit.weights).fit;
        let (set, _) = self.about_both(&fit, &kept, &[]);
        self.chosen(set, &selected.fit.weights)
    }

    /// `set` with a torque constant on each joint that changed, and what then gains; with the new indices of `kept`.
    fn with_all_constants(
        &mut self,
        mut set: Vec<usize>,
        mut kept: Vec<usize>,
        weights: &[f64],
    ) -> (Selection, Vec<usize>) {
        let constants = self.allowed().into_iter().filter(|&c| self.is_changed_constant(c));
        set.extend(constants);
        let mut weights = weights.to_vec();
        // The constants multiply the friction of this fit, too.
        for _ in 0..2 {
            let fit = self.chosen(set.clone(), &weights).fit;
            (set, kept) = self.about_both(&fit, &set, &kept);
            weights = fit.weights;
        }
        let next = self.chosen(set, &weights);
        let next = self.with_best_strengths(next);
        let allowed = self.allowed();
        (self.grown(next, &allowed), kept)
    }

    /// Whether a candidate is a torque constant that changed.
    fn is_changed_constant(&self, candidate: usize) -> bool {
        self.changes(candidate) && self.candidates[candidate].hypothesis.is(&TORQUE_SCALE)
    }

    fn is_factor_of_masses(&self, candidate: usize) -> bool {
        OF_MASSES.iter().any(|&kind| self.candidates[candidate].hypothesis.is(kind))
    }

    /// Whether torque constants may explain a change: of masses by a factor, of friction, or of one constant.
    fn is_replaced_by_constants(&self, candidate: usize) -> bool {
        let is_friction = self.candidates[candidate].hypothesis.spec().is_friction;
        is_friction || self.is_factor_of_masses(candidate) || self.is_changed_constant(candidate)
    }

    /// Evaluates everything about the arm and the drives of `fit`; returns the new indices of the candidates of `set` and `others`.
    fn about_both(&mut self, fit: &Fit, set: &[usize], others: &[usize]) -> (Vec<usize>, Vec<usize>) {
        let mut both = self.about(fit, &[set, others].concat(), true).unwrap_or_default();
        let others = both.split_off(set.len());
        (both, others)
    }
}
