//! Which candidates cannot both be.

use super::Problem;
use crate::regression::term::Term;
use crate::search::candidate::{Candidate, Cause};

impl Problem<'_> {
    /// Whether two candidates cannot both be: sizes of one effect, or forms of one curve.
    pub fn exclude(&self, a: usize, b: usize) -> bool {
        let (a, b) = (&self.candidates[a], &self.candidates[b]);
        if a.joint != b.joint {
            return false;
        }
        let offsets = |cause| matches!(cause, Cause::TorqueOffset | Cause::Asymmetry | Cause::Spring);
        let shapes = |cause| matches!(cause, Cause::OwnPosition | Cause::Spring);
        // What sets in halfway comes on top of what always acts.
        if self.onset(a).is_some() != self.onset(b).is_some() {
            return false;
        }
        let same = std::mem::discriminant(&a.cause) == std::mem::discriminant(&b.cause);
        match a.cause {
            Cause::Ripple | Cause::Periodic => same && self.unresolved(a, b),
            Cause::Contact => same && self.overlap(a, b),
            Cause::Coupling(_) | Cause::OtherPosition(_) | Cause::OtherSpeed(_) => a.cause == b.cause,
            _ if shapes(a.cause) && shapes(b.cause) => true,
            _ if offsets(a.cause) && offsets(b.cause) => true,
            _ => same,
        }
    }

    /// When a candidate sets in (s); `None` if it always acts.
    pub fn onset(&self, candidate: &Candidate) -> Option<f64> {
        self.table.terms[candidate.columns[0]].onset()
    }

    /// Whether two contacts are within a second of each other: one contact, then.
    fn overlap(&self, a: &Candidate, b: &Candidate) -> bool {
        let window = |candidate: &Candidate| match self.table.terms[candidate.columns[0]] {
            Term::Force { from, to, .. } => (from, to),
            _ => (f64::NAN, f64::NAN),
        };
        let ((a, b), (c, d)) = (window(a), window(b));
        a < d + 1.0 && c < b + 1.0
    }

    /// Whether two sinusoids are too close to be told apart.
    fn unresolved(&self, a: &Candidate, b: &Candidate) -> bool {
        match (self.table.terms[a.columns[0]], self.table.terms[b.columns[0]]) {
            (Term::Ripple { periods: a, .. }, Term::Ripple { periods: b, .. }) => (a - b).abs() < 0.2 * a.min(b),
            (Term::Wave { omega: a, .. }, Term::Wave { omega: b, .. }) => (a - b).abs() < 0.1 * a.min(b),
            _ => false,
        }
    }
}
