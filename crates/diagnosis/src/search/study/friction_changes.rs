//! Friction of all joints that changed together, in the place of differences between recordings that imitate it.

use std::collections::BTreeSet;

use effects::Acts;

use super::Study;
use crate::regression::strengths::PriorStrengths;
use crate::search::problem::Selection;

/// The strengths of friction that differs between the recordings beside the one that changed: none, or less than without it.
const STRENGTHS: [f64; 3] = [0.0, 0.1, 0.3];

impl Study {
    /// `selected` with the friction that changed on most joints since the recordings from before, if it explains more together.
    ///
    /// A search that takes one effect after the other finds that friction that differs between the recordings of all joints explains
    /// more than the change of any one joint, and then leaves nothing to the others.
    pub fn with_friction_that_changed(&mut self, selected: Selection) -> Selection {
        let changed: Vec<usize> = self.allowed().into_iter().filter(|&c| self.is_changed_friction(c)).collect();
        if changed.is_empty() || self.strengths.friction == 0.0 && self.strengths.varied.is_empty() {
            return selected;
        }
        let before = self.strengths.clone();
        let others: Vec<usize> = selected.set.iter().copied().filter(|&c| !self.is_changed_friction(c)).collect();
        (self.strengths.friction, self.strengths.varied) = (0.0, Vec::new());
        self.strengths.between.fill(1.0);
        let products = self.training_products();
        let problem = self.problem(&products);
        // More friction acts since the change, and what it was more before acts until then.
        let acts_since = |&&c: &&usize| matches!(Acts::of(&self.terms(c)), Acts::Since(_));
        let since: Vec<usize> = changed.iter().filter(acts_since).copied().collect();
        let all = problem.choose([&others[..], &since].concat(), &selected.fit.weights);
        let is_more = |c: usize| all.fit.coefficient(self.candidates[c].columns[0]) > 0.0;
        let until = |c: usize| {
            let this = &self.candidates[c];
            changed.iter().copied().find(|other| {
                let candidate = &self.candidates[*other];
                !acts_since(&other) && (candidate.hypothesis, candidate.joint) == (this.hypothesis, this.joint)
            })
        };
        let of_sign = since.iter().filter_map(|&c| if is_more(c) { Some(c) } else { until(c) });
        let set: Vec<usize> = others.into_iter().chain(of_sign).collect();
        let beside = STRENGTHS.map(|friction| PriorStrengths { friction, ..self.strengths.clone() });
        let trials = beside.map(|strengths| {
            let products = self.products_at(&strengths);
            let problem = self.problem(&products);
            let together = problem.reweighted(problem.choose(set.clone(), &all.fit.weights));
            (problem.prune(together), strengths)
        });
        let best = trials.into_iter().min_by(|a, b| a.0.score.total_cmp(&b.0.score));
        let Some((together, strengths)) = best else {
            return selected;
        };
        self.strengths = strengths;
        let together = self.with_best_strengths(together);
        let changed = together.set.iter().copied().filter(|&c| self.is_changed_friction(c));
        let joints: BTreeSet<Option<usize>> = changed.map(|c| self.candidates[c].joint).collect();
        // By chance, some joints differ more from one side to the other than between recordings of one side.
        let are_most =
            2 * joints.len() > (0..self.data.arm.dof()).filter(|&joint| self.data.scales.moves(joint)).count();
        if are_most && together.score < selected.score {
            self.note("friction of the joints changed together", &selected, &together);
            return together;
        }
        self.strengths = before;
        selected
    }

    /// Whether a candidate is Coulomb or viscous friction that changed.
    fn is_changed_friction(&self, candidate: usize) -> bool {
        self.changes(candidate) && self.candidates[candidate].hypothesis.is_plain_friction()
    }
}
