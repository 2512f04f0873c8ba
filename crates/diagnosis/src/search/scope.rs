//! What a search may name, if it follows another one.

use crate::search::candidate::{Candidate, Hypothesis};

/// The joints whose residual an earlier search left unexplained, and the names that it gave.
#[derive(Clone, Debug)]
pub struct Scope {
    /// Whether a joint's residual is unexplained: every effect may be named there. One each.
    pub is_open: Vec<bool>,
    /// The names that the other joints may keep.
    pub names: Vec<(Hypothesis, Option<usize>)>,
}

impl Scope {
    /// Whether `candidate` may be taken: an effect on a joint that is open or on the whole arm, a baseline effect, an unmodelled form,
    /// or an earlier name.
    pub fn contains(&self, candidate: &Candidate) -> bool {
        let Candidate { hypothesis, joint, .. } = candidate;
        joint.is_none_or(|joint| self.is_open[joint])
            || hypothesis.name().is_none()
            || hypothesis.spec().is_baseline
            || self.names.contains(&(*hypothesis, *joint))
    }
}
