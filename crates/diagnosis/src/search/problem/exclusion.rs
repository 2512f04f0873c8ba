//! Candidates that exclude each other.

use effects::Term;

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
        // A candidate with an onset is in addition to one that always acts.
        if self.onset(a).is_some() != self.onset(b).is_some() {
            return false;
        }
        let ([first, second], [one, other]) = (
            [a, b].map(|c| &self.table.terms[c.columns[0]]),
            [a.hypothesis, b.hypothesis],
        );
        if one.kind == other.kind && a.joint == b.joint {
            one.other == other.other && one.kind.get().is_same(first, second)
        } else {
            one.spec().excludes.contains(&other.spec().name) || other.spec().excludes.contains(&one.spec().name)
        }
    }

    /// The onset of a candidate (s); `None` if it always acts.
    pub fn onset(&self, candidate: &Candidate) -> Option<f64> {
        let mut terms = candidate.columns.iter().map(|&column| &self.table.terms[column]);
        terms.find_map(Term::onset)
    }
}
