//! The alternatives of a finding: other hypotheses, fitted in its place with all other effects refitted.

use effects::arm::INERTIAL_PARAMETERS;
use effects::friction::{COULOMB_FRICTION, FRICTION_ASYMMETRY};
use effects::sensor::TORQUE_OFFSET;
use rayon::prelude::*;

use crate::search::candidate::{Candidate, Hypothesis};
use crate::search::problem::{Problem, Selection};
use crate::search::study::Study;
use crate::thresholds::{
    LEAST_LEVEL, MARGIN_SCALE, NEARLY, NEARLY_NATS, PAIRED_RIVALS, PARTNERS, SUREST, TRIED_RIVALS,
};

/// An effect and its joint; `None` is the whole arm.
pub type Rival = (Hypothesis, Option<usize>);

/// The comparison of a finding with its alternatives.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Effects that explain nearly as much, the best first.
    pub rivals: Vec<Rival>,
    /// Two effects that explain nearly as much together, and neither alone, the best first.
    pub pairs: Vec<[Rival; 2]>,
    /// The evidence for the finding against its best alternative (nats).
    pub margin: f64,
    /// The margin without the alternative of one effect on each joint, which is less likely than one effect on the whole arm.
    pub margin_over_single: f64,
    /// The inertial parameters of a link, or of all (`None`), if a stronger background without the finding is as likely by its
    /// score, although it explains less. The probability of the name is then one half.
    pub as_likely: Option<Rival>,
}

impl Comparison {
    /// The probability that the name is right, for a finding of some evidence (nats).
    ///
    /// It is one half if an alternative does equally well, and increases with the margin; the scale was calibrated on simulated
    /// cases with known ground truth.
    pub fn probability(&self, evidence: f64) -> f64 {
        probability(self.margin.min(evidence))
    }
}

/// The probability of a name with a margin over its best alternative (nats).
pub fn probability(margin: f64) -> f64 {
    (1.0 - 0.5 * (-margin.max(0.0) / MARGIN_SCALE).exp()).min(SUREST)
}

/// The largest loss (nats) of an alternative that explains nearly as much as a finding with this evidence (nats).
pub fn allowance(explained: f64) -> f64 {
    NEARLY_NATS.max(NEARLY * explained)
}

/// The set beside which alternatives of `member` are tried: all other members, and the effect that `member` generalises.
pub fn beside(study: &Study, selected: &Selection, member: usize) -> Vec<usize> {
    let finding = &study.candidates[member];
    let mut set: Vec<usize> = selected.others(member);
    // An effect that generalises a simpler one competes with that simpler effect plus another effect.
    let plain = (0..study.candidates.len()).find(|&c| {
        let plain = &study.candidates[c];
        Some(plain.hypothesis) == finding.hypothesis.generalises()
            && plain.joint == finding.joint
            && finding.columns.len() > 1
            && finding.columns.contains(&plain.columns[0])
    });
    if let Some(plain) = plain
        && !set.contains(&plain)
    {
        set.push(plain);
    }
    set
}

/// The equivalent name of `member`, if there is one: a constant torque beside dry friction that is not much smaller equals friction that
/// depends on the direction. No motion distinguishes the two. `set` is the set [`beside`] the finding.
pub fn alias(study: &Study, selected: &Selection, member: usize, set: &[usize]) -> Option<Rival> {
    let finding = &study.candidates[member];
    if finding.hypothesis.is(&FRICTION_ASYMMETRY) {
        return Some((Hypothesis::of(&TORQUE_OFFSET), finding.joint));
    }
    let constant = *finding.columns.first()?;
    let is_as_large = |&c: &usize| {
        let other = &study.candidates[c];
        other.hypothesis.is(&COULOMB_FRICTION)
            && other.joint == finding.joint
            && selected.fit.coefficient(other.columns[0]) > LEAST_LEVEL * selected.fit.coefficient(constant).abs()
    };
    let has_alias = finding.hypothesis.is(&TORQUE_OFFSET) && set.iter().any(is_as_large);
    has_alias.then_some((Hypothesis::of(&FRICTION_ASYMMETRY), finding.joint))
}

/// Tries every other hypothesis in the place of `member`.
pub fn compared(study: &Study, problem: &Problem<'_>, selected: &Selection, member: usize) -> Comparison {
    let finding = &study.candidates[member];
    let set = beside(study, selected, member);
    let without = problem.choose(set.clone(), &selected.fit.weights);
    // The gains of rivals are computed with the weights of the fit without the finding. With the weights of the finding's
    // own fit, every effect on its joint would seem to explain everything.
    let ground = problem.reweighted(without.clone());
    // The differences between recordings may decide on the equivalent name, which the fit does not know.
    let alias = alias(study, selected, member, &set);
    let always = alias.filter(|_| study.always_acts(member));
    let decided = always.and_then(|(_, joint)| study.directions.get(&joint?).copied());
    let is_other = |c: usize| {
        let other = &study.candidates[c];
        let is_excluded = decided.is_some() && Some((other.hypothesis, other.joint)) == alias;
        let same_name = other.hypothesis.name() == finding.hypothesis.name() && other.joint == finding.joint;
        // A candidate with all of the finding's columns and more is a finer form of it, not another hypothesis.
        let finer = finding.columns.iter().all(|column| other.columns.contains(column));
        // A wrong mass of one link resembles one of its neighbour, and so does the encoder offset of a parallel axis.
        let are_neighbours = finding.hypothesis == other.hypothesis && finding.hypothesis.spec().acts_before_its_joint;
        // The mass of a link on a prismatic joint resembles the drives' inertias of its joint and of the parallel ones before it.
        let is_drive_before = other.hypothesis.is_drive_inertia()
            && finding.hypothesis.spec().acts_before_its_joint
            && other.joint < finding.joint;
        !same_name
            && !finer
            && !is_excluded
            && other.hypothesis.name().is_some()
            && (other.joint == finding.joint
                || other.joint.is_none()
                || finding.joint.is_none()
                || are_neighbours
                || is_drive_before)
            && !set.iter().any(|&known| {
                let known = &study.candidates[known];
                known.hypothesis == other.hypothesis && known.joint == other.joint
            })
    };
    let others: Vec<usize> = (0..study.candidates.len()).filter(|&c| is_other(c)).collect();
    let mut promises = problem.promises(&ground, &others);
    promises.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    // Only the best size of each hypothesis is fitted in full.
    let mut tried: Vec<usize> = Vec::new();
    for &(_, c) in &promises {
        let same = |&&known: &&usize| {
            let (a, b) = (&study.candidates[known], &study.candidates[c]);
            a.hypothesis == b.hypothesis && a.joint == b.joint
        };
        if tried.iter().find(same).is_none() {
            tried.push(c);
        }
        if tried.len() == TRIED_RIVALS {
            break;
        }
    }
    // Every hypothesis alone in the finding's place.
    let alone: Vec<(usize, Selection)> = tried
        .into_par_iter()
        .map(|c| (c, problem.choose([&set[..], &[c]].concat(), &selected.fit.weights)))
        .filter(|(c, next)| problem.is_possible(*c, &next.fit))
        .collect();
    let explained = without.fit.loss - selected.fit.loss;
    let allowance = allowance(explained);
    let result = |c: usize, next: &Selection| -> (f64, f64, Hypothesis, Option<usize>) {
        let Candidate { hypothesis, joint, .. } = study.candidates[c];
        let (loss, score) = in_place(problem, selected, member, &[c], next, allowance);
        (loss, score, hypothesis, joint)
    };
    let mut results: Vec<_> = alone.par_iter().map(|(c, next)| result(*c, next)).collect();
    let mut on_all_joints = Vec::new();
    if let Some(same) = finding.hypothesis.spec().same_on_all_joints {
        // Without a known load, a common factor of all masses and one of all torques cannot be distinguished.
        let factors: Vec<usize> =
            (0..study.candidates.len()).filter(|&c| study.candidates[c].hypothesis.name() == Some(same)).collect();
        let next = problem.choose([&set[..], &factors].concat(), &selected.fit.weights);
        if factors.iter().all(|&c| problem.is_possible(c, &next.fit)) {
            on_all_joints.extend(factors.iter().map(|&c| result(c, &next)));
        }
    }
    let alias = alias.filter(|_| decided.is_none_or(|nats| nats < NEARLY_NATS));
    let mut as_likely = None;
    if finding.hypothesis.spec().may_be_inertial {
        let hypothesis = Hypothesis::of(&INERTIAL_PARAMETERS);
        let trials = study.in_the_background(&set, selected);
        let results_of = |(link, next): (Option<usize>, Selection)| {
            (next.fit.loss - selected.fit.loss, next.score - selected.score, hypothesis, link)
        };
        let best = trials.into_iter().map(results_of).min_by(|a, b| a.1.total_cmp(&b.1));
        as_likely = best.filter(|result| result.1 <= 0.0).map(|result| (result.2, result.3));
        results.extend(best);
    }
    let best = |results: &[(f64, f64, Hypothesis, Option<usize>)]| {
        results.iter().map(|result| result.1).fold(f64::INFINITY, f64::min)
    };
    let (single, of_all_joints) = (best(&results), best(&on_all_joints));
    results.extend(on_all_joints);
    results.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)).then(a.3.cmp(&b.3)));
    let mut rivals: Vec<Rival> = results
        .iter()
        .filter(|(loss, ..)| *loss <= allowance)
        .map(|&(_, _, hypothesis, joint)| (hypothesis, joint))
        .collect();
    rivals.extend(alias.filter(|alias| !rivals.contains(alias)));
    let found = Paired { study, problem, selected, member, set: &set, allowance, rivals: &rivals };
    let pairs = if finding.hypothesis.spec().is_baseline { Vec::new() } else { found.pairs(alone, &others) };
    // A simpler hypothesis is more probable: the margin includes the costs.
    let pair = pairs.iter().map(|pair| pair.1).fold(f64::INFINITY, f64::min);
    let margin_over_single = explained.min(single).min(pair).min(decided.unwrap_or(f64::INFINITY));
    // Neither the motion nor its size tells what a constant torque is that is smaller than the friction.
    let over_alias = if alias.is_some() && decided.is_none() { 0.0 } else { f64::INFINITY };
    let margin = margin_over_single.min(of_all_joints).min(over_alias);
    Comparison { rivals, pairs: pairs.into_iter().map(|pair| pair.2).collect(), margin, margin_over_single, as_likely }
}

/// The loss and the score of `next` (nats), in which `alternatives` stand in the place of `member`, beyond those of `selected`; or, if
/// the alternatives improve the fit beside `member` too, beyond those of the fit with all of them. What explains something else of
/// its own would otherwise seem to explain what `member` does. Only alternatives that may be `within` an allowance (nats) are fitted
/// beside `member`.
fn in_place(
    problem: &Problem<'_>,
    selected: &Selection,
    member: usize,
    alternatives: &[usize],
    next: &Selection,
    within: f64,
) -> (f64, f64) {
    let beyond = |reference: &Selection| (next.fit.loss - reference.fit.loss, next.score - reference.score);
    let (loss, score) = beyond(selected);
    let excludes = |&c: &usize| selected.set.iter().any(|&known| problem.exclude(c, known));
    if loss > within && probability(score) >= SUREST || alternatives.iter().any(excludes) {
        return (loss, score);
    }
    let all = problem.choose([&selected.set[..], alternatives].concat(), &selected.fit.weights);
    let is_possible = |&c: &usize| problem.is_possible(c, &all.fit);
    if all.score < selected.score && alternatives.iter().chain([&member]).all(is_possible) {
        beyond(&all)
    } else {
        (loss, score)
    }
}

/// The search for two effects that together explain as much as a finding.
struct Paired<'a> {
    study: &'a Study,
    problem: &'a Problem<'a>,
    selected: &'a Selection,
    /// The finding.
    member: usize,
    /// The set beside which alternatives are tried.
    set: &'a [usize],
    /// The largest loss of an alternative (nats).
    allowance: f64,
    /// The effects that are alternatives alone.
    rivals: &'a [Rival],
}

impl Paired<'_> {
    /// Each pair with its loss and its score beyond those of the finding (nats). One effect of a pair is among those fitted
    /// `alone` that are nearest to an alternative, the other among `others`.
    fn pairs(&self, mut alone: Vec<(usize, Selection)>, others: &[usize]) -> Vec<(f64, f64, [Rival; 2])> {
        alone.retain(|(c, _)| !self.rivals.contains(&self.named(*c)));
        alone.sort_by(|a, b| a.1.fit.loss.total_cmp(&b.1.fit.loss).then(a.0.cmp(&b.0)));
        let mut pairs: Vec<(f64, f64, [Rival; 2])> = Vec::new();
        for (one, next) in alone.into_iter().take(PAIRED_RIVALS) {
            let is_partner = |c: &usize| {
                let named = self.named(*c);
                named != self.named(one) && !self.rivals.contains(&named) && !self.problem.exclude(one, *c)
            };
            let free: Vec<usize> = others.iter().copied().filter(is_partner).collect();
            let mut promises = self.problem.promises(&next, &free);
            promises.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let mut partners: Vec<usize> = Vec::new();
            for (_, c) in promises {
                if partners.len() < PARTNERS && !partners.iter().any(|&known| self.named(known) == self.named(c)) {
                    partners.push(c);
                }
            }
            for other in partners {
                let set = [self.set, &[one, other]].concat();
                let both = self.problem.choose(set, &self.selected.fit.weights);
                let mut names = [self.named(one), self.named(other)];
                names.sort();
                let are_possible = [one, other].iter().all(|&c| self.problem.is_possible(c, &both.fit));
                if !are_possible || pairs.iter().any(|pair| pair.2 == names) {
                    continue;
                }
                let (loss, score) =
                    in_place(self.problem, self.selected, self.member, &[one, other], &both, self.allowance);
                if loss <= self.allowance {
                    pairs.push((loss, score, names));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
        pairs
    }

    fn named(&self, c: usize) -> Rival {
        (self.study.candidates[c].hypothesis, self.study.candidates[c].joint)
    }
}
