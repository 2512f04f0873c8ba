//! Candidates that exclude each other.

use effects::Acts;

use super::Problem;
use crate::search::candidate::Candidate;

impl Problem<'_> {
    /// Whether two candidates exclude each other: sizes of one effect, or forms of one curve.
    pub fn exclude(&self, a: usize, b: usize) -> bool {
        let (a, b) = (&self.candidates[a], &self.candidates[b]);
        // An effect at the tool has the same torque as one of the last link.
        let place = |candidate: &Candidate| candidate.joint.or_else(|| self.table.dof().checked_sub(1));
        if place(a) != place(b) {
            return false;
        }
        let ([when, then], is_one_effect) = (
            [a, b].map(|candidate| self.acts(candidate)),
            a.hypothesis.kind == b.hypothesis.kind && a.joint == b.joint,
        );
        if !when.is_like(then) {
            // An effect that begins or ends may be in addition to one that always acts. One that ends and another that begins are described
            // by one that always acts and a change of it.
            return is_one_effect && when != Acts::Always && then != Acts::Always;
        }
        let ([first, second], [one, other]) =
            ([a, b].map(|c| &self.table.terms[c.columns[0]]), [a.hypothesis, b.hypothesis]);
        if is_one_effect {
            one.other == other.other && (one.spec().is_same)(first, second)
        } else {
            one.spec().excludes.contains(&other.spec().name) || other.spec().excludes.contains(&one.spec().name)
        }
    }

    /// When a candidate acts.
    pub fn acts(&self, candidate: &Candidate) -> Acts {
        Acts::of(candidate.columns.iter().map(|&column| &self.table.terms[column]))
    }
}
