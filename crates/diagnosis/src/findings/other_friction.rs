//! The sizes of friction beside other friction of the joint that is not named.

use effects::friction::{QUADRATIC_DRAG, TURBULENT, VISCOUS_FRICTION};
use effects::{Acts, Term};

use crate::report::{Finding, Parameter};
use crate::search::candidate::Hypothesis;
use crate::search::problem::Problem;
use crate::selection::FinalFit;
use crate::selection::judge::Member;
use crate::selection::rivals::{Comparison, Rival};

/// The friction that may be on a joint beside the one that is named there: alternatives of its Coulomb or viscous friction.
pub fn possible_beside(last: &FinalFit, of: &[(&Member, Comparison)]) -> Vec<Rival> {
    let study = &last.study;
    let is_plain = |member: &Member| study.candidates[member.candidate].hypothesis.is_plain_friction();
    let plain = of.iter().filter(|(member, _)| is_plain(member));
    let drag = Hypothesis::of(&QUADRATIC_DRAG);
    let drags = plain.flat_map(|(member, comparison)| {
        let joint = study.candidates[member.candidate].joint;
        let rivals = comparison.rivals.iter().copied();
        rivals.filter(move |&(hypothesis, on)| hypothesis == drag && on == joint)
    });
    drags.collect()
}

/// Widens the interval of `finding`, if it is friction that grows with the speed or that every joint has, by what other friction of its
/// joint would change that is probably or possibly there, although the recordings do not require it: Coulomb and viscous friction, and
/// the drag among `beside`.
pub fn widen(finding: &mut Finding, last: &FinalFit, problem: &Problem<'_>, member: &Member, beside: &[Rival]) {
    let study = &last.study;
    let candidate = &study.candidates[member.candidate];
    let is_drag = candidate.hypothesis.is(&QUADRATIC_DRAG);
    let (true, [own]) = (is_drag || candidate.hypothesis.is_plain_friction(), &candidate.columns[..]) else {
        return;
    };
    // What sets in within the recordings, sets in alone; what changed since those from before may have changed beside the other friction.
    if !study.always_acts(member.candidate) && !study.changes(member.candidate) {
        return;
    }
    let acts = Acts::of(&study.terms(member.candidate));
    let acts_alike = |index: usize| Acts::of(&study.terms(index)) == acts;
    let selected = &last.judged.named.set;
    let is_free = |index: usize| {
        let other = &study.candidates[index];
        let contains = |c: usize| {
            let this = &study.candidates[c];
            this.joint == other.joint && this.hypothesis.contains(other.hypothesis) && acts_alike(c)
        };
        let is_there = || selected.iter().any(|&c| contains(c) || problem.exclude(c, index));
        other.joint == candidate.joint
            && acts_alike(index)
            && !(study.always_acts(index) && study.has_known(other.hypothesis, other.joint))
            && !is_there()
    };
    let is_other = |index: &usize| {
        let other = study.candidates[*index].hypothesis;
        let is_its_like = match is_drag {
            true => other.is(&VISCOUS_FRICTION),
            false => other.is_plain_friction() && other != candidate.hypothesis,
        };
        is_its_like && is_free(*index)
    };
    let fit = &last.judged.named.fit;
    let others: Vec<usize> = fit.selected().iter().copied().filter(|column| column != own).collect();
    let alone: Term = study.table.terms[*own];
    // The size and its standard deviation, if the residual were white.
    let size_with = |more: Vec<Term>| -> Option<[f64; 2]> {
        let count = more.len();
        let fit = study.fit_with(&others, more, &fit.weights);
        let covariance = fit.information_of_last(count).try_inverse()?;
        let value = fit.coefficients[fit.coefficients.len() - count];
        Some([value, covariance[(0, 0)].sqrt()])
    };
    let other = (0..study.candidates.len()).find(is_other).map(|other| study.terms(other));
    let drag = beside.iter().find(|(_, on)| *on == candidate.joint && !is_drag);
    let drag = drag.and_then(|&(drag, _)| {
        let is_usual = |index| study.terms(index).iter().all(|term: &Term| term.sizes[0] == TURBULENT);
        let is_this = |&index: &usize| study.candidates[index].hypothesis == drag && is_free(index) && is_usual(index);
        (0..study.candidates.len()).find(is_this).map(|index| study.terms(index))
    });
    if other.is_none() && drag.is_none() {
        return;
    }
    let beside = [other.clone(), drag.clone()].into_iter().flatten();
    let both = other.zip(drag).map(|(other, drag)| [other, drag].concat());
    let main = candidate.hypothesis.spec().main.first();
    let Some([_, deviation]) = size_with(vec![alone]) else {
        return;
    };
    for more in beside.chain(both) {
        // A drag beside viscous friction has its usual exponent.
        let own = if is_drag { alone.sized([TURBULENT]) } else { alone };
        let size = size_with([vec![own], more].concat());
        let parameter = main.and_then(|main| finding.parameters.get_mut(main));
        if let (Some([value, with_other]), Some(parameter)) = (size, parameter) {
            widen_to(parameter, value, with_other / deviation);
            if is_drag && let Some(exponent) = finding.parameters.get_mut("exponent") {
                widen_to(exponent, TURBULENT, 0.0);
            }
        }
    }
}

/// Widens an interval to hold that about `value` which is `times` as wide. A level of friction is not negative.
fn widen_to(parameter: &mut Parameter, value: f64, times: f64) {
    let [low, high] = parameter.ci95;
    let half = 0.5 * (high - low) * times;
    if half.is_finite() {
        parameter.ci95 = [low.min((value - half).max(0.0)), high.max(value + half)];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_holds_the_one_beside_the_other_friction() {
        let widened = |value: f64, times: f64| {
            let mut parameter = Parameter { value: 4.0, ci95: [3.0, 5.0], unit: "N m" };
            widen_to(&mut parameter, value, times);
            parameter.ci95
        };
        assert_eq!(widened(2.0, 1.5), [0.5, 5.0]);
        assert_eq!(widened(4.0, 0.5), [3.0, 5.0], "it never becomes narrower");
        assert_eq!(widened(1.0, 2.0), [0.0, 5.0], "no friction is negative");
    }
}
