//! Physical limits of coefficients.

use arm::Arm;
use effects::{Fitted, Term, UNIT};

use crate::regression::fit::Fit;
use crate::regression::table::Table;
use crate::search::candidate::Candidate;
use crate::thresholds::{LARGEST_TORQUE_SHARE, UNEVEN};

/// The number of smaller sizes that are tried: a thousandth of a size, a millionth, and so on.
const SMALLER: i32 = 6;

/// A candidate with the coefficients of a fit.
struct InFit<'a> {
    candidate: &'a Candidate,
    table: &'a Table,
    fit: &'a Fit,
    arm: &'a Arm,
}

impl Fitted for InFit<'_> {
    fn len(&self) -> usize {
        self.candidate.columns.len()
    }

    fn term(&self, k: usize) -> Term {
        self.table.terms[self.candidate.columns[k]]
    }

    fn value(&self, k: usize) -> f64 {
        self.fit.coefficient(self.candidate.columns[k])
    }

    fn background(&self, term: &Term) -> f64 {
        let columns = &self.fit.columns[..self.fit.background];
        let at = columns.iter().position(|&column| self.table.terms[column] == *term);
        at.map_or(0.0, |k| self.fit.coefficients[k])
    }

    fn column(&self, k: usize) -> Option<&[f64]> {
        let joint = self.candidate.joint?;
        let place = self.table.place[joint][self.candidate.columns[k]]?;
        Some(&self.table.joints[joint].x[place])
    }

    fn residual(&self) -> Vec<f64> {
        let Some(joint) = self.candidate.joint else {
            return Vec::new();
        };
        self.table.residual(joint, &self.fit.columns, &self.fit.coefficients)
    }

    fn moving(&self) -> &[bool] {
        let joint = self.candidate.joint.map(|joint| &self.table.joints[joint]);
        joint.map_or(&[], |joint| &joint.moving)
    }

    fn is_trial(&self) -> bool {
        self.candidate.is_trial
    }

    fn arm(&self) -> &Arm {
        self.arm
    }
}

/// Whether `candidate` is possible at the coefficients of `fit`.
pub fn is_possible(candidate: &Candidate, table: &Table, fit: &Fit, arm: &Arm) -> bool {
    // Masses with the opposite error may hide an effect that every drive has.
    let cancels = |joint| torque_share(candidate, table, fit, joint) >= LARGEST_TORQUE_SHARE;
    let may_be_hidden = candidate.hypothesis.spec().is_baseline || candidate.hypothesis.spec().may_be_hidden;
    if !may_be_hidden && candidate.joint.is_some_and(cancels) {
        return false;
    }
    is_physical(candidate, table, fit, arm)
}

/// Whether the effect of `candidate` can exist at the coefficients of `fit`.
fn is_physical(candidate: &Candidate, table: &Table, fit: &Fit, arm: &Arm) -> bool {
    (candidate.hypothesis.spec().is_possible)(&InFit { candidate, table, fit, arm })
}

/// Whether no effect of `candidate` has a coefficient of ±`size` on `column`, although a smaller one is possible: one a thousandth
/// as large, a millionth, and so on.
pub fn is_beyond_physics(size: f64, column: usize, candidate: &Candidate, table: &Table, fit: &Fit, arm: &Arm) -> bool {
    let is_possible = |size: f64| {
        [size, -size].into_iter().any(|size| {
            let mut other = fit.clone();
            match other.columns.iter().position(|&known| known == column) {
                Some(at) => other.coefficients[at] = size,
                None => {
                    other.columns.push(column);
                    other.coefficients.push(size);
                }
            }
            is_physical(candidate, table, &other, arm)
        })
    };
    is_too_large(size, is_possible)
}

/// Whether `size` is impossible and a thousandth of it is possible, or a millionth, and so on.
fn is_too_large(size: f64, is_possible: impl Fn(f64) -> bool) -> bool {
    let mut smaller = (1..=SMALLER).map(|thousandths| size * 1e-3_f64.powi(thousandths));
    !is_possible(size) && smaller.any(is_possible)
}

/// Whether the coefficient of a simulated effect is near one. The torque of a link behind a spring or a gap is proportional to its
/// inertia, which may be wrong by `links` in the URDF (relative), and a resonance whose frequency is wrong reduces the coefficient.
pub fn is_at_its_size(candidate: &Candidate, table: &Table, fit: &Fit, links: f64) -> bool {
    let column = candidate.columns[0];
    let is_of_link = table.terms[column].law.link_side.is_some();
    let wrong_by = if is_of_link { links } else { 0.0 };
    !candidate.hypothesis.spec().is_simulated || is_near_one(fit.coefficient(column), wrong_by)
}

/// Whether a coefficient is near one if the inertia to which it is proportional may be wrong by `links` (relative).
fn is_near_one(coefficient: f64, links: f64) -> bool {
    let factor = 1.0 + UNEVEN * links;
    (UNIT.start() / factor..=UNIT.end() * factor).contains(&coefficient)
}

/// The root mean square of a candidate's torque over that of the torque to be explained, on moving rows.
fn torque_share(candidate: &Candidate, table: &Table, fit: &Fit, joint: usize) -> f64 {
    let torque = table.torque(joint, &candidate.columns, &fit.values(&candidate.columns));
    let this = &table.joints[joint];
    let power = |signal: &[f64]| -> f64 {
        signal.iter().zip(&this.moving).filter(|(_, moving)| **moving).map(|(v, _)| v * v).sum()
    };
    (power(&torque) / power(&this.y).max(1e-300)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{is_near_one, is_too_large};

    /// Two springs on simulated arms, whose links were wrong by 0.3 and more, had coefficients of 0.47 and 0.50.
    #[test]
    fn the_coefficient_of_a_spring_may_differ_from_one_by_as_much_as_the_links_are_wrong() {
        for (coefficient, links, near) in [
            (0.47, 0.0, false),
            (0.47, 0.3, true),
            (0.2, 0.3, false),
            (1.0, 0.0, true),
            (2.2, 0.0, false),
            (2.2, 0.3, true),
        ] {
            assert_eq!(is_near_one(coefficient, links), near, "{coefficient}, links wrong by {links}");
        }
    }

    #[test]
    fn a_size_far_beyond_its_limit_is_too_large_and_an_impossible_effect_is_not() {
        let below = |limit: f64| move |size: f64| size < limit;
        for (size, limit, too_large) in [(0.1, 0.2, false), (0.3, 0.2, true), (4e14, 0.2, true), (0.3, 0.0, false)] {
            assert_eq!(is_too_large(size, below(limit)), too_large, "{size} of {limit}");
        }
    }
}
