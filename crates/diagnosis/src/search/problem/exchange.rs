//! Exchanges of members for better ones.

use effects::Acts;
use rayon::prelude::*;

use super::{Growth, Problem, Selection};
use crate::thresholds::SWAP_GAIN;

impl Problem<'_> {
    /// `selected` with one hypothesis that acts on the whole arm, and without the members that it then explains. Several
    /// hypotheses on several joints may imitate it, none of which can be exchanged alone.
    fn arm_wide(&self, selected: &Selection, allowed: &[usize]) -> Vec<Selection> {
        let is_free = |c: &usize| {
            let candidate = &self.candidates[*c];
            candidate.joint.is_none()
                && !candidate.hypothesis.spec().may_be_in_one_recording
                && !selected.set.iter().any(|&other| other == *c || self.exclude(*c, other))
        };
        let free: Vec<usize> = allowed.iter().copied().filter(is_free).collect();
        free.par_iter()
            .filter_map(|&candidate| {
                let with = self.choose(self.with(&selected.set, candidate), &selected.fit.weights);
                if !self.is_possible(candidate, &with.fit) {
                    return None;
                }
                let pruned = self.prune(with);
                pruned.set.contains(&candidate).then_some(pruned)
            })
            .collect()
    }

    /// `selected` with one or two other wrong masses in place of its own. Masses are coupled along the arm, so that two wrong
    /// masses may resemble a third one, and one may resemble two others. No exchange of one mass for one other leads to the
    /// true masses then.
    fn other_masses(&self, selected: &Selection, allowed: &[usize]) -> Vec<Selection> {
        let is_mass = |c: &usize| self.candidates[*c].hypothesis.spec().is_wrong_mass;
        let rest: Vec<usize> = selected.set.iter().copied().filter(|c| !is_mass(c)).collect();
        if rest.len() == selected.set.len() {
            return Vec::new();
        }
        let masses: Vec<usize> = allowed.iter().copied().filter(is_mass).collect();
        let alone = masses.iter().map(|&one| vec![one]);
        let pairs = masses.iter().enumerate().flat_map(|(k, &one)| {
            let others = masses[k + 1..].iter().filter(move |&&two| !self.exclude(one, two));
            others.map(move |&two| vec![one, two])
        });
        let sets: Vec<Vec<usize>> = alone.chain(pairs).collect();
        sets.into_par_iter()
            .filter_map(|new| {
                let next = self.choose([rest.clone(), new.clone()].concat(), &selected.fit.weights);
                new.iter().all(|&c| self.is_possible(c, &next.fit)).then_some(next)
            })
            .collect()
    }

    /// `selected` without a factor of all masses and without the torque constants that it has, and with those of the other joints: all
    /// torque constants but one that have the inverse of a factor of all masses resemble the factor of the one.
    fn other_constants(&self, selected: &Selection, allowed: &[usize]) -> Option<Selection> {
        let spec = |c: usize| self.candidates[c].hypothesis.spec();
        let common = selected.set.iter().find_map(|&c| Some((c, spec(c).same_on_all_joints?)));
        let (factor, constant) = common?;
        let is_constant = |c: &usize| spec(*c).name == constant && self.acts(&self.candidates[*c]) == Acts::Always;
        let named: Vec<Option<usize>> =
            selected.set.iter().copied().filter(is_constant).map(|c| self.candidates[c].joint).collect();
        let rest = selected.others(factor).into_iter().filter(|c| !is_constant(c));
        let others = allowed.iter().copied().filter(|c| is_constant(c) && !named.contains(&self.candidates[*c].joint));
        let set = rest.chain(others).collect();
        Some(self.prune(self.choose(set, &selected.fit.weights)))
    }

    /// Replaces single members by better ones, until none is better.
    pub fn swap(&self, mut selected: Selection, allowed: &[usize], rounds: usize) -> Selection {
        for _ in 0..rounds {
            let trials: Vec<Selection> = (0..selected.set.len())
                .into_par_iter()
                .filter_map(|k| {
                    let removed = selected.set[k];
                    let out = &self.candidates[removed];
                    if out.hypothesis.spec().is_friction {
                        return None;
                    }
                    let without = self.without(&selected, removed);
                    // The replacement acts where the member did, or is the same effect of another joint, if that may be in its place.
                    let others: Vec<usize> = allowed
                        .iter()
                        .copied()
                        .filter(|&c| c != removed)
                        .filter(|&c| {
                            let other = &self.candidates[c];
                            let is_neighbour =
                                other.hypothesis == out.hypothesis && out.hypothesis.spec().acts_before_its_joint;
                            other.joint == out.joint || other.joint.is_none() || out.joint.is_none() || is_neighbour
                        })
                        .collect();
                    self.grow(&without, &others, &mut Growth::default())
                })
                .collect();
            let trials = trials
                .into_iter()
                .chain(self.arm_wide(&selected, allowed))
                .chain(self.other_masses(&selected, allowed))
                .chain(self.other_constants(&selected, allowed));
            match trials.min_by(|a, b| a.score.total_cmp(&b.score)) {
                Some(next) if next.score < selected.score - SWAP_GAIN => selected = self.prune(self.reweighted(next)),
                _ => break,
            }
        }
        selected
    }
}
