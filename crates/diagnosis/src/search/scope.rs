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

#[cfg(test)]
mod tests {
    use effects::Spec;
    use effects::drive::BACKLASH;
    use effects::friction::COULOMB_FRICTION;
    use effects::sensor::TORQUE_SCALE;

    use super::*;
    use crate::thresholds::Thresholds;

    #[test]
    fn what_may_be_named() {
        let scope = Scope { is_open: vec![true, false], names: vec![(Hypothesis::of(&TORQUE_SCALE), Some(1))] };
        let may_be = |kind: &'static Spec, joint: Option<usize>| {
            scope.contains(&Candidate::new(Hypothesis::of(kind), joint, Vec::new(), &Thresholds::default()))
        };
        assert!(may_be(&BACKLASH, Some(0)) && may_be(&TORQUE_SCALE, Some(0)), "on the open joint");
        assert!(!may_be(&BACKLASH, Some(1)), "on the other joint");
        assert!(may_be(&TORQUE_SCALE, Some(1)), "an earlier name");
        assert!(may_be(&COULOMB_FRICTION, Some(1)), "a baseline effect");
        assert!(may_be(&BACKLASH, None), "on the whole arm");
    }
}
