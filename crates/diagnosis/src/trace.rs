//! The record of a diagnosis: effects that were tried, taken and dropped, with the rule and the evidence that decided
//! (nats).

use std::fmt;
use std::sync::Mutex;

use crate::search::problem::Chosen;
use crate::search::study::Study;

/// A decision on an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// It was fitted beside what was selected, and not taken in this step.
    Tried,
    /// It was taken into the selection.
    Taken,
    /// It was dropped from the selection.
    Dropped,
    /// The background became stronger or weaker.
    Background,
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tried => "tried",
            Self::Taken => "taken",
            Self::Dropped => "dropped",
            Self::Background => "background",
        })
    }
}

/// One row of the record. Rows of one `step` were decided together.
#[derive(Clone, Debug)]
pub struct Decision {
    /// The number of the step, from 1.
    pub step: usize,
    /// The decision.
    pub action: Action,
    /// The name of the effect or of the unmodelled form; for a background, its strengths.
    pub effect: String,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
    /// The rule that decided.
    pub rule: &'static str,
    /// The reduction of the score by the step, costs included (nats); negative where a rule overrides the score.
    pub nats: f64,
}

/// Collects decisions. They are recorded between the parallel parts of the search, so that their order is always the same.
#[derive(Debug, Default)]
pub struct Trace(Mutex<Vec<Decision>>);

impl Trace {
    /// Adds the decisions of the next step.
    fn step(&self, decisions: impl IntoIterator<Item = (Action, String, Option<String>, &'static str, f64)>) {
        let mut list = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let step = list.last().map_or(0, |last| last.step) + 1;
        list.extend(
            decisions
                .into_iter()
                .map(|(action, effect, joint, rule, nats)| Decision {
                    step,
                    action,
                    effect,
                    joint,
                    rule,
                    nats,
                }),
        );
    }

    /// Returns and removes all decisions.
    pub fn take(&self) -> Vec<Decision> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    }
}

impl Study {
    fn described(&self, candidate: usize) -> (String, Option<String>) {
        let candidate = &self.candidates[candidate];
        let joint = candidate.joint.map(|joint| self.arm.joints()[joint].name.clone());
        (candidate.hypothesis.spec().name.to_owned(), joint)
    }

    /// Records the decisions that lead from `before` to `after` by `rule`.
    pub fn note(&self, rule: &'static str, before: &Chosen, after: &Chosen) {
        let nats = before.score - after.score;
        let row = |action: Action| {
            move |&candidate: &usize| {
                let (effect, joint) = self.described(candidate);
                (action, effect, joint, rule, nats)
            }
        };
        let dropped = before.set.iter().filter(|c| !after.set.contains(c));
        let taken = after.set.iter().filter(|c| !before.set.contains(c));
        let rows: Vec<_> = dropped
            .map(row(Action::Dropped))
            .chain(taken.map(row(Action::Taken)))
            .collect();
        if !rows.is_empty() {
            self.trace.step(rows);
        }
    }

    /// Records candidates that were fitted in addition to `chosen` and not taken, each with the score that it would have given.
    pub fn note_tried(&self, chosen: &Chosen, tried: &[(usize, f64, &'static str)]) {
        let rows = tried.iter().map(|&(candidate, score, rule)| {
            let (effect, joint) = self.described(candidate);
            (Action::Tried, effect, joint, rule, chosen.score - score)
        });
        if !tried.is_empty() {
            self.trace.step(rows);
        }
    }

    /// Records a change of the background's strengths since `before`.
    pub fn note_strengths(&self, rule: &'static str, before: &Chosen, after: &Chosen) {
        let strengths = self.strengths.to_string();
        let nats = before.score - after.score;
        self.trace.step([(Action::Background, strengths, None, rule, nats)]);
        self.note(rule, before, after);
    }
}
