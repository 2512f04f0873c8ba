//! The sizes of Coulomb or viscous friction where only one of the two is named.

use effects::Term;

use crate::report::{Finding, Parameter};
use crate::search::problem::Problem;
use crate::selection::FinalFit;
use crate::selection::judge::Member;

/// Widens the interval of `finding`, if it is friction that every joint has, by what the other such friction of its joint would change:
/// both are probably there, although the recordings need one only.
pub fn widen(finding: &mut Finding, last: &FinalFit, problem: &Problem<'_>, member: &Member) {
    let study = &last.study;
    let candidate = &study.candidates[member.candidate];
    let spec = candidate.hypothesis.spec();
    let (true, true, [own]) = (spec.is_baseline, spec.is_friction, &candidate.columns[..]) else {
        return;
    };
    // What changed, changed alone.
    if !study.always_acts(member.candidate) {
        return;
    }
    let selected = &last.judged.named.set;
    let is_other = |index: &usize| {
        let other = &study.candidates[*index];
        let (kind, spec) = (other.hypothesis, other.hypothesis.spec());
        let is_its_like = spec.is_baseline && spec.is_friction && kind != candidate.hypothesis;
        let contains = |c: usize| {
            let this = &study.candidates[c];
            this.joint == other.joint && this.hypothesis.contains(kind)
        };
        let is_there = || selected.iter().any(|&c| contains(c) || problem.exclude(c, *index));
        let is_lacking = || !study.has_known(kind, other.joint) && !is_there();
        is_its_like && other.joint == candidate.joint && study.always_acts(*index) && is_lacking()
    };
    let Some(other) = (0..study.candidates.len()).find(is_other) else {
        return;
    };
    let fit = &last.judged.named.fit;
    let others: Vec<usize> = fit.selected().iter().copied().filter(|column| column != own).collect();
    let own: Term = study.table.terms[*own];
    // The size and its standard deviation, if the residual were white.
    let size_with = |more: Vec<Term>| -> Option<[f64; 2]> {
        let count = more.len();
        let fit = study.fit_with(&others, more, &fit.weights);
        let covariance = fit.information_of_last(count).try_inverse()?;
        let value = fit.coefficients[fit.coefficients.len() - count];
        Some([value, covariance[(0, 0)].sqrt()])
    };
    let alone = size_with(vec![own]);
    let both = size_with([vec![own], study.terms(other)].concat());
    let parameter = spec.main.first().and_then(|main| finding.parameters.get_mut(main));
    if let (Some([_, alone]), Some([value, with_other]), Some(parameter)) = (alone, both, parameter) {
        widen_to(parameter, value, with_other / alone);
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
            let mut parameter = Parameter {
                value: 4.0,
                ci95: [3.0, 5.0],
                unit: "N m",
            };
            widen_to(&mut parameter, value, times);
            parameter.ci95
        };
        assert_eq!(widened(2.0, 1.5), [0.5, 5.0]);
        assert_eq!(widened(4.0, 0.5), [3.0, 5.0], "it never becomes narrower");
        assert_eq!(widened(1.0, 2.0), [0.0, 5.0], "no friction is negative");
    }
}
