//! The growth of a selection by one candidate at a time.

use std::collections::HashMap;
use std::sync::OnceLock;

use rayon::prelude::*;

use super::{DOES_NOT_PAY, IMPOSSIBLE, Problem, Selection};
use crate::regression::fit::{ArmLeftOut, LeftOut};
use crate::search::candidate::Hypothesis;
use crate::thresholds::{FITTED_AT_ONCE, FORMS_AT_ONCE, MOST_BATCHES, MOST_PROMISING};

/// The memory of a stepwise growth.
#[derive(Clone, Debug, Default)]
pub struct Growth {
    /// Candidates that do not improve the prediction of recordings that they were not fitted to.
    pub refused: Vec<usize>,
    /// Candidates that were fitted and not taken, with their score and the reason.
    pub tried: Vec<(usize, f64, &'static str)>,
    /// What candidates promised when they were last looked at (nats, minus their costs).
    promises: HashMap<usize, f64>,
}

impl Growth {
    /// Forgets what depends on the background.
    pub fn begin_anew(&mut self) {
        self.refused.clear();
        self.promises.clear();
    }

    /// `candidates` that promised most before, with those never looked at, and the others.
    fn by_promise(&self, mut candidates: Vec<usize>) -> (Vec<usize>, Vec<usize>) {
        let promise = |c: &usize| self.promises.get(c).copied().unwrap_or(f64::INFINITY);
        candidates.sort_by(|a, b| promise(b).total_cmp(&promise(a)).then(a.cmp(b)));
        let unknown = candidates.partition_point(|c| promise(c) == f64::INFINITY);
        let rest = candidates.split_off(candidates.len().min(unknown + MOST_PROMISING));
        (candidates, rest)
    }
}

/// The fits of a selection to which candidates are added, each computed once.
struct Bases<'a> {
    /// On each joint.
    joints: Vec<OnceLock<LeftOut<'a>>>,
    /// On all joints together.
    arm: OnceLock<ArmLeftOut<'a>>,
}

impl Problem<'_> {
    /// The best addition to `selected` among `allowed`, if one pays. Candidates that `growth` refused before are not tried again.
    /// Those that promised most before are tried first; all are, before none is added.
    pub fn grow(&self, selected: &Selection, allowed: &[usize], growth: &mut Growth) -> Option<Selection> {
        let free: Vec<usize> = allowed
            .iter()
            .copied()
            .filter(|&c| {
                !growth.refused.contains(&c)
                    && !selected.set.contains(&c)
                    && !selected.set.iter().any(|&other| self.exclude(c, other))
            })
            .collect();
        let (first, rest) = growth.by_promise(free);
        let mut promises = self.promises(selected, &first);
        growth.promises.extend(promises.iter().map(|&(promise, c)| (c, promise)));
        let mut fitted = Vec::new();
        if !rest.is_empty() {
            if let Some(best) = self.best_of(selected, promises.clone(), growth, &mut fitted) {
                return Some(best);
            }
            let others = self.promises(selected, &rest);
            growth.promises.extend(others.iter().map(|&(promise, c)| (c, promise)));
            promises.extend(others);
            promises.retain(|(_, c)| !growth.refused.contains(c));
        }
        self.best_of(selected, promises, growth, &mut fitted)
    }

    /// The best addition to `selected` among the most promising candidates, if one pays. Candidates that were `fitted` before did
    /// not pay.
    fn best_of(
        &self,
        selected: &Selection,
        mut promises: Vec<(f64, usize)>,
        growth: &mut Growth,
        fitted: &mut Vec<usize>,
    ) -> Option<Selection> {
        promises.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        promises.retain(|(promise, _)| *promise > 0.0);
        // The most promising candidates of each kind come first, because a candidate that contains a simpler one promises
        // as much as that one, at all its sizes.
        let kind = |c: usize| (self.candidates[c].joint, self.candidates[c].hypothesis);
        let mut of_kind: HashMap<(Option<usize>, Hypothesis), usize> = HashMap::new();
        let mut turns: Vec<(usize, usize)> = promises
            .into_iter()
            .map(|(_, candidate)| {
                let before = of_kind.entry(kind(candidate)).or_default();
                *before += 1;
                ((*before - 1) / FORMS_AT_ONCE, candidate)
            })
            .collect();
        turns.sort_by_key(|&(turn, _)| turn);
        let mut waiting = turns.into_iter().map(|(_, candidate)| candidate);
        let bases = Bases { joints: (0..self.table.dof()).map(|_| OnceLock::new()).collect(), arm: OnceLock::new() };
        for _ in 0..MOST_BATCHES {
            let mut batch = Vec::with_capacity(FITTED_AT_ONCE);
            while batch.len() < FITTED_AT_ONCE {
                let next: Vec<usize> = waiting.by_ref().take(FITTED_AT_ONCE - batch.len()).collect();
                if next.is_empty() {
                    break;
                }
                let predicts = next
                    .par_iter()
                    .map(|&candidate| fitted.contains(&candidate) || self.predicts(selected, candidate, &bases));
                let predicts: Vec<bool> = predicts.collect();
                for (candidate, predicts) in next.into_iter().zip(predicts) {
                    if predicts {
                        batch.push(candidate);
                    } else {
                        growth.refused.push(candidate);
                        growth.tried.push((
                            candidate,
                            selected.score,
                            "does not improve the prediction of recordings it was not fitted to",
                        ));
                    }
                }
            }
            if batch.is_empty() {
                break;
            }
            batch.retain(|candidate| !fitted.contains(candidate));
            let tried: Vec<Selection> = batch
                .par_iter()
                .map(|&candidate| self.choose(self.with(&selected.set, candidate), &selected.fit.weights))
                .collect();
            fitted.extend(batch);
            let best = tried
                .into_iter()
                .filter(|next| {
                    let added = next.set[next.set.len() - 1];
                    let (possible, pays) = (self.is_possible(added, &next.fit), next.score < selected.score);
                    let rule = match (possible, pays) {
                        (false, _) => IMPOSSIBLE,
                        (true, false) => DOES_NOT_PAY,
                        (true, true) => "another gains more",
                    };
                    growth.tried.push((added, next.score, rule));
                    possible && pays
                })
                .min_by(|a, b| a.score.total_cmp(&b.score));
            if let Some(best) = best {
                let taken = best.set.last();
                growth.tried.retain(|(candidate, ..)| Some(candidate) != taken);
                return Some(best);
            }
        }
        None
    }

    /// Whether `candidate` improves the prediction of recordings that it was not fitted to. `bases` are the fits of `selected`.
    fn predicts<'a>(&'a self, selected: &'a Selection, candidate: usize, bases: &Bases<'a>) -> bool {
        let candidate = &self.candidates[candidate];
        if candidate.hypothesis.spec().may_be_in_one_recording
            || candidate.hypothesis.spec().is_baseline
            || self.is_background_too(candidate)
        {
            return true;
        }
        let columns = &selected.fit.columns;
        let weights = &selected.fit.weights;
        let on_the_arm = || {
            let base = bases.arm.get_or_init(|| self.products.arm_left_out(self.table, columns, weights));
            self.products.arm_gain(self.table, base, &candidate.columns) > 0.0
        };
        let Some(joint) = candidate.joint else {
            return on_the_arm();
        };
        let fit = || self.products.left_out(self.table, joint, columns, weights);
        let base = bases.joints[joint].get_or_init(fit);
        let (inside, outside) = self.products.gains(self.table, base, &candidate.columns);
        let needed = if candidate.hypothesis.name().is_none() { self.thresholds.predicted * inside } else { 0.0 };
        // A coupling acts on two joints, and may show on the other one. Unmodelled forms of another joint's motion act on one.
        let is_coupling = candidate.hypothesis.name().is_some() && candidate.hypothesis.other.is_some();
        outside > needed || (is_coupling && on_the_arm())
    }
}
