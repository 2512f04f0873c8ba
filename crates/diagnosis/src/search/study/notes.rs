//! The study's decisions, as rows of the record.

use effects::Acts;

use super::Study;
use crate::regression::fit::Products;
use crate::search::problem::Selection;
use crate::trace::Action;

impl Study {
    fn described(&self, candidate: usize) -> (String, Option<String>) {
        let acts = match Acts::of(&self.terms(candidate)) {
            Acts::Always => "",
            Acts::Since(at) if Some(at) == self.data.motions.changed_at => " since the change",
            Acts::Since(_) => " since an onset",
            Acts::Until(_) => " until the change",
        };
        let candidate = &self.candidates[candidate];
        let joint = candidate.joint.map(|joint| self.data.arm.joints()[joint].name.clone());
        (format!("{}{acts}", candidate.hypothesis.spec().name), joint)
    }

    /// Records the decisions that lead from `before` to `after` by `rule`.
    pub fn note(&self, rule: &'static str, before: &Selection, after: &Selection) {
        let nats = before.score - after.score;
        let row = |action: Action| {
            move |&candidate: &usize| {
                let (effect, joint) = self.described(candidate);
                (action, effect, joint, rule, nats)
            }
        };
        let dropped = before.set.iter().filter(|c| !after.set.contains(c));
        let taken = after.set.iter().filter(|c| !before.set.contains(c));
        let rows: Vec<_> = dropped.map(row(Action::Dropped)).chain(taken.map(row(Action::Taken))).collect();
        if !rows.is_empty() {
            self.trace.step(rows);
        }
    }

    /// `selected` without the members that do not pay or are impossible, each of which is recorded; `products` are those of this study.
    pub fn pruned(&self, products: &Products, selected: Selection) -> Selection {
        let note = |rule: &'static str, before: &Selection, after: &Selection| self.note(rule, before, after);
        self.problem(products).prune_noting(selected, note)
    }

    /// Records candidates that were fitted in addition to `selected` and not taken, each with the score that it would have given.
    pub fn note_tried(&self, selected: &Selection, tried: &[(usize, f64, &'static str)]) {
        let rows = tried.iter().map(|&(candidate, score, rule)| {
            let (effect, joint) = self.described(candidate);
            (Action::Tried, effect, joint, rule, selected.score - score)
        });
        if !tried.is_empty() {
            self.trace.step(rows);
        }
    }

    /// Records a change of the background's strengths since `before`.
    pub fn note_strengths(&self, rule: &'static str, before: &Selection, after: &Selection) {
        let strengths = self.strengths.to_string();
        let nats = before.score - after.score;
        self.trace.step([(Action::Background, strengths, None, rule, nats)]);
        self.note(rule, before, after);
    }
}
