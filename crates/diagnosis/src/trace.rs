//! The record of a diagnosis: effects that were tried, taken and dropped, with the rule and the evidence that decided
//! (nats).

use std::fmt;
use std::sync::Mutex;

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
    /// The search begins again with torques without their lag.
    Lag,
    /// The rows of a joint count less in the final fit.
    Memory,
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tried => "tried",
            Self::Taken => "taken",
            Self::Dropped => "dropped",
            Self::Background => "background",
            Self::Lag => "lag",
            Self::Memory => "memory",
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
    /// The name of the effect or of the unmodelled form, and whether it begins or ends; for a background, its strengths; for a lag, its length; for
    /// a memory, how many pieces of evidence count as one.
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
    pub fn step(&self, decisions: impl IntoIterator<Item = (Action, String, Option<String>, &'static str, f64)>) {
        let mut list = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let step = list.last().map_or(0, |last| last.step) + 1;
        list.extend(decisions.into_iter().map(|(action, effect, joint, rule, nats)| Decision {
            step,
            action,
            effect,
            joint,
            rule,
            nats,
        }));
    }

    /// Returns and removes all decisions.
    pub fn take(&self) -> Vec<Decision> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    }
}
