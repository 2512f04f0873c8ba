//! The joint search: which candidates together explain the residual.

use std::collections::HashMap;
use std::sync::OnceLock;

use arm::Arm;
use rayon::prelude::*;

use crate::regression::fit::{Fit, LeftOut, Products};
use crate::regression::table::Table;
use crate::search::candidate::{Candidate, Hypothesis};
use crate::search::physics::is_possible;
use crate::thresholds::{KNOWN_DRIVE, TELLING_DRIVES, Thresholds};

mod exchange;
mod exclusion;
mod promise;

/// The number of the most promising candidates that are fitted in full each round.
const TRIED: usize = 8;
/// The number of forms of one effect on one joint that are fitted in full before other effects.
const AT_ONCE: usize = 3;
/// The largest number of selected candidates.
pub const MOST: usize = 60;

/// The number of times that the next most promising candidates are tried if the first do not pay.
const BATCHES: usize = 6;

/// Selected candidates with their fit.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Indices into the candidates.
    pub set: Vec<usize>,
    /// The fit of all of them.
    pub fit: Fit,
    /// Loss and costs (nats).
    pub score: f64,
}

impl Selection {
    /// Its set without one member.
    pub fn others(&self, member: usize) -> Vec<usize> {
        self.set.iter().copied().filter(|&c| c != member).collect()
    }
}

/// The memory of a stepwise growth.
#[derive(Clone, Debug, Default)]
pub struct Growth {
    /// Candidates that do not improve the prediction of recordings that they were not fitted to.
    pub refused: Vec<usize>,
    /// Candidates that were fitted and not taken, with their score and the reason.
    pub tried: Vec<(usize, f64, &'static str)>,
}

/// The rule that removes what is physically impossible.
pub const IMPOSSIBLE: &str = "its parameters are not physical";

/// The data of the search.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// All columns.
    pub table: &'a Table,
    /// The inner products over the training recordings.
    pub products: &'a Products,
    /// All candidates.
    pub candidates: &'a [Candidate],
    /// The arm.
    pub arm: &'a Arm,
    /// The thresholds.
    pub thresholds: &'a Thresholds,
}

impl Problem<'_> {
    /// The columns of a set, without repetition.
    pub fn columns(&self, set: &[usize]) -> Vec<usize> {
        let mut columns: Vec<usize> = set
            .iter()
            .flat_map(|&c| self.candidates[c].columns.iter().copied())
            .collect();
        columns.sort_unstable();
        columns.dedup();
        columns
    }

    /// The cost of a set; shared columns are paid once.
    fn cost(&self, set: &[usize]) -> f64 {
        let own: f64 = set.iter().map(|&c| self.candidates[c].cost).sum();
        let counted: usize = set.iter().map(|&c| self.candidates[c].columns.len()).sum();
        let drives = set
            .iter()
            .filter(|&&c| self.candidates[c].hypothesis.is_drive_inertia())
            .count();
        own - self.thresholds.per_coefficient * (counted - self.columns(set).len()) as f64
            - KNOWN_DRIVE * drives.saturating_sub(TELLING_DRIVES) as f64
    }

    /// Fits a set, starting with the weights of `near`.
    pub fn choose(&self, set: Vec<usize>, near: &[f64]) -> Selection {
        let fit = self.products.fit(self.table, &self.columns(&set), near);
        let score = fit.loss + self.cost(&set) + self.misfit(&set, &fit);
        Selection { set, fit, score }
    }

    /// `chosen` with the joints weighted by their residuals.
    pub fn reweighted(&self, chosen: Selection) -> Selection {
        let fit = self.products.reweighted(self.table, chosen.fit);
        let score = fit.loss + self.cost(&chosen.set) + self.misfit(&chosen.set, &fit);
        Selection { fit, score, ..chosen }
    }

    /// The cost of a simulated effect whose coefficient differs from one (nats).
    fn misfit(&self, set: &[usize], fit: &Fit) -> f64 {
        set.iter()
            .map(|&c| &self.candidates[c])
            .filter(|candidate| candidate.hypothesis.is_unit())
            .map(|candidate| {
                let coefficient = fit.coefficient(candidate.columns[0]).max(1e-3);
                0.5 * (coefficient.ln() / self.thresholds.unit_spread).powi(2)
            })
            .sum()
    }

    /// Whether `candidate` is possible in `fit`.
    pub fn is_possible(&self, candidate: usize, fit: &Fit) -> bool {
        is_possible(&self.candidates[candidate], self.table, fit, self.arm)
    }

    /// The best addition to `chosen` among `allowed`, if one pays. Candidates that `growth` refused before are not tried again.
    pub fn grow(&self, chosen: &Selection, allowed: &[usize], growth: &mut Growth) -> Option<Selection> {
        let free: Vec<usize> = allowed
            .iter()
            .copied()
            .filter(|&c| {
                !growth.refused.contains(&c)
                    && !chosen.set.contains(&c)
                    && !chosen.set.iter().any(|&other| self.exclude(c, other))
            })
            .collect();
        let mut promises = self.promises(chosen, &free);
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
                ((*before - 1) / AT_ONCE, candidate)
            })
            .collect();
        turns.sort_by_key(|&(turn, _)| turn);
        let mut waiting = turns.into_iter().map(|(_, candidate)| candidate);
        // The fit to which the candidates of a joint are added is computed once.
        let bases: Vec<OnceLock<LeftOut<'_>>> = (0..self.table.dof()).map(|_| OnceLock::new()).collect();
        for _ in 0..BATCHES {
            let mut batch = Vec::with_capacity(TRIED);
            while batch.len() < TRIED {
                let next: Vec<usize> = waiting.by_ref().take(TRIED - batch.len()).collect();
                if next.is_empty() {
                    break;
                }
                let predicts = next
                    .par_iter()
                    .map(|&candidate| self.predicts(chosen, candidate, &bases));
                let predicts: Vec<bool> = predicts.collect();
                for (candidate, predicts) in next.into_iter().zip(predicts) {
                    if predicts {
                        batch.push(candidate);
                    } else {
                        growth.refused.push(candidate);
                        growth.tried.push((
                            candidate,
                            chosen.score,
                            "does not improve the prediction of recordings it was not fitted to",
                        ));
                    }
                }
            }
            if batch.is_empty() {
                break;
            }
            let tried: Vec<Selection> = batch
                .par_iter()
                .map(|&candidate| self.choose(self.with(&chosen.set, candidate), &chosen.fit.weights))
                .collect();
            let best = tried
                .into_iter()
                .filter(|next| {
                    let added = next.set[next.set.len() - 1];
                    let (possible, pays) = (self.is_possible(added, &next.fit), next.score < chosen.score);
                    let rule = match (possible, pays) {
                        (false, _) => IMPOSSIBLE,
                        (true, false) => "costs more evidence than it brings",
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

    /// `set` and, last, `candidate`. Unmodelled structure comes with baseline friction: every drive has it, and a curve over
    /// position or time must not replace it.
    fn with(&self, set: &[usize], candidate: usize) -> Vec<usize> {
        let mut set = set.to_vec();
        if self.is_unmodelled(candidate) {
            let is_friction = |c: &usize| {
                let other = &self.candidates[*c];
                other.joint == self.candidates[candidate].joint && other.hypothesis.is_friction()
            };
            for friction in (0..self.candidates.len()).filter(is_friction) {
                if !set
                    .iter()
                    .any(|&other| other == friction || self.exclude(friction, other))
                {
                    set.push(friction);
                }
            }
        }
        set.push(candidate);
        set
    }

    fn is_unmodelled(&self, candidate: usize) -> bool {
        self.candidates[candidate].hypothesis.name().is_none()
    }

    /// Whether a member of `set` may be removed for its cost. Baseline friction may not be removed beside unmodelled forms.
    fn may_go(&self, set: &[usize], member: usize) -> bool {
        let this = &self.candidates[member];
        !this.hypothesis.is_friction()
            || !set
                .iter()
                .any(|&c| self.is_unmodelled(c) && self.candidates[c].joint == this.joint)
    }

    /// Whether an effect may be a part of the background. It then need not predict better than the background, but it costs
    /// less evidence.
    pub fn is_background_too(&self, candidate: &Candidate) -> bool {
        self.products.has_background() && candidate.hypothesis.is_certain_in_form()
    }

    /// Whether `candidate` improves the prediction of recordings that it was not fitted to. `bases` are the fits of `chosen` on
    /// the joints.
    fn predicts<'a>(&'a self, chosen: &'a Selection, candidate: usize, bases: &[OnceLock<LeftOut<'a>>]) -> bool {
        let candidate = &self.candidates[candidate];
        if candidate.hypothesis.is_passing() || candidate.hypothesis.is_baseline() || self.is_background_too(candidate)
        {
            return true;
        }
        let columns = &chosen.fit.columns;
        let Some(joint) = candidate.joint else {
            return self
                .products
                .arm_gain(self.table, columns, &candidate.columns, &chosen.fit.weights)
                > 0.0;
        };
        let fit = || self.products.left_out(self.table, joint, columns, &chosen.fit.weights);
        let base = bases[joint].get_or_init(fit);
        let (inside, outside) = self.products.gains(self.table, base, &candidate.columns);
        outside
            > if candidate.hypothesis.name().is_none() {
                self.thresholds.predicted * inside
            } else {
                0.0
            }
    }

    /// Removes members that do not pay, or that are impossible, one by one.
    pub fn prune(&self, mut chosen: Selection) -> Selection {
        loop {
            let best = (0..chosen.set.len())
                .into_par_iter()
                .filter_map(|k| {
                    let mut set = chosen.set.clone();
                    let removed = set.remove(k);
                    let must = !self.is_possible(removed, &chosen.fit);
                    let may = must || self.may_go(&set, removed);
                    may.then(|| (must, self.without(&chosen, removed)))
                })
                .collect::<Vec<_>>()
                .into_iter()
                .min_by(|a, b| b.0.cmp(&a.0).then(a.1.score.total_cmp(&b.1.score)));
            match best {
                Some((must, next)) if must || next.score <= chosen.score => chosen = self.reweighted(next),
                _ => return chosen,
            }
        }
    }

    /// Adds candidates of `allowed` that pay, then removes those that no longer do.
    pub fn forward(&self, mut chosen: Selection, allowed: &[usize]) -> Selection {
        let mut growth = Growth::default();
        while chosen.set.len() < MOST {
            match self.grow(&chosen, allowed, &mut growth) {
                Some(next) => chosen = self.reweighted(next),
                None => break,
            }
        }
        self.prune(chosen)
    }

    /// `chosen` without one of its members. A form of a simpler effect is replaced by that, if it pays.
    pub fn without(&self, chosen: &Selection, member: usize) -> Selection {
        let set = chosen.others(member);
        let bare = self.choose(set.clone(), &chosen.fit.weights);
        let candidate = &self.candidates[member];
        let onset = |c: &Candidate| self.onset(c);
        let is_contained = |plain: &Candidate| plain.columns.iter().all(|column| candidate.columns.contains(column));
        let is_plain = |&c: &usize| {
            let plain = &self.candidates[c];
            Some(plain.hypothesis) == candidate.hypothesis.plain()
                && plain.joint == candidate.joint
                && (is_contained(plain) || onset(plain).is_some() == onset(candidate).is_some())
        };
        // Among candidates with an onset, only those with nearly the same onset.
        let apart = |&c: &usize| match (onset(&self.candidates[c]), onset(candidate)) {
            (Some(a), Some(b)) => (a - b).abs(),
            _ => 0.0,
        };
        let plain = (0..self.candidates.len()).filter(is_plain);
        let Some(plain) = plain.min_by(|a, b| {
            let is_other = |c: &usize| !is_contained(&self.candidates[*c]);
            is_other(a).cmp(&is_other(b)).then(apart(a).total_cmp(&apart(b)))
        }) else {
            return bare;
        };
        if set.contains(&plain) {
            return bare;
        }
        let mut with = set;
        with.push(plain);
        let simpler = self.choose(with, &chosen.fit.weights);
        if simpler.score < bare.score && self.is_possible(plain, &simpler.fit) {
            simpler
        } else {
            bare
        }
    }
}
