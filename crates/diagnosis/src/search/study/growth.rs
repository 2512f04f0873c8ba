//! Selects the effects together with the strengths of the background, step by step.

use super::strengths::MOST_MOVES;
use super::{Claim, Study};
use crate::regression::fit::{Fit, Products};
use crate::regression::strengths::{Part, PriorStrengths};
use crate::search::physics::is_possible;
use crate::search::problem::{Growth, IMPOSSIBLE, Selection};
use crate::thresholds::{HOPELESS_EXCHANGE, LOST_WITH_IMPOSSIBLE, MOST_LATER_GAIN, MOST_SELECTED};

/// The largest number of effects that may together replace a part of the background.
const IN_PLACE: usize = 3;

impl Study {
    /// `selected` with more of the candidates `allowed`, and with the strengths of the background that the evidence prefers.
    /// Each step takes the candidate or the change of strengths that gains more. Members that no longer pay are removed.
    /// If one of them is impossible in the end, and the rest far worse without it, the steps are repeated without it: they would not have led
    /// there.
    pub fn grown(&mut self, selected: Selection, allowed: &[usize]) -> Selection {
        let (products, grown) = self.grown_once(selected, allowed);
        let pruned = self.pruned(&products, grown.clone());
        if pruned.score < grown.score + LOST_WITH_IMPOSSIBLE {
            return pruned;
        }
        let problem = self.problem(&products);
        let settled = problem.reweighted(grown);
        let (possible, impossible): (Vec<usize>, Vec<usize>) =
            settled.set.iter().partition(|&&c| problem.is_possible(c, &settled.fit));
        if impossible.is_empty() {
            return pruned;
        }
        let rest = problem.choose(possible, &settled.fit.weights);
        self.note(IMPOSSIBLE, &settled, &rest);
        let claims: Vec<Claim> = impossible.iter().map(|&c| self.claim(c)).collect();
        let others: Vec<usize> = allowed.iter().copied().filter(|&c| !claims.contains(&self.claim(c))).collect();
        let (products, grown) = self.grown_once(rest, &others);
        self.pruned(&products, grown)
    }

    /// The same without the removal of members that no longer pay; also the products of the training recordings beside its background.
    fn grown_once(&mut self, mut selected: Selection, allowed: &[usize]) -> (Products, Selection) {
        let mut products = self.training_products();
        let mut growth = Growth::default();
        let mut moves = 0;
        while moves < MOST_MOVES {
            let problem = self.problem(&products);
            let grown = problem.grow(&selected, allowed, &mut growth);
            self.note_tried(&selected, &std::mem::take(&mut growth.tried));
            let mut stronger = self.strengthened(&selected, self.strengths.neighbours());
            if grown.is_none() && stronger.is_none() {
                let others = self.in_one_place(&selected).into_iter();
                let others = others.chain(self.strengths.in_one_link()).collect();
                stronger = self.strengthened(&selected, others);
            }
            let (rule, strengths, next) = match (grown, stronger) {
                (Some(next), None) => ("largest gain", None, problem.reweighted(next)),
                (Some(next), Some((_, other))) if next.score <= other.score => {
                    ("largest gain", None, problem.reweighted(next))
                }
                (_, Some((strengths, other))) => ("more evidence for this background", Some(strengths), other),
                // An effect that is a part of the background does not pay in addition to it, but may do so with a smaller
                // background.
                (None, None) => match self.exchanged(&selected, allowed) {
                    Some((strengths, next)) => {
                        let products = self.products_at(&strengths);
                        let next = self.problem(&products).reweighted(next);
                        ("effects in the place of the background", Some(strengths), next)
                    }
                    None => break,
                },
            };
            if let Some(strengths) = strengths {
                moves += 1;
                products = self.products_at(&strengths);
                self.strengths = strengths;
                growth.begin_anew();
                self.note_strengths(rule, &selected, &next);
                selected = next;
            } else {
                self.note(rule, &selected, &next);
                selected = next;
            }
            if selected.set.len() > MOST_SELECTED {
                break;
            }
        }
        (products, selected)
    }

    /// `selected` with a smaller background and a few more of the candidates `allowed`, if that is better.
    fn exchanged(&self, selected: &Selection, allowed: &[usize]) -> Option<(PriorStrengths, Selection)> {
        let mut best: Option<(PriorStrengths, Selection)> = None;
        let mut hopeless: Vec<Part> = Vec::new();
        let weaker: Vec<PriorStrengths> = self.stated.weaker(&self.strengths).collect();
        // The strongest first: if effects cannot replace a small part of the background, they cannot replace a larger one.
        for strengths in weaker.into_iter().rev() {
            let part = self.strengths.part_that_differs(&strengths);
            if hopeless.contains(&part) {
                continue;
            }
            let Some(next) = self.with_few_more(&strengths, selected, allowed) else {
                continue;
            };
            let beyond = next.score - selected.score;
            if beyond > HOPELESS_EXCHANGE {
                hopeless.push(part);
            }
            if beyond < -1e-6 && best.as_ref().is_none_or(|(_, best)| next.score < best.score) {
                best = Some((strengths, next));
            }
        }
        best
    }

    /// `selected` with a background of other `strengths`, and with those of the candidates `allowed` that gain most: as many as make it
    /// better than `selected`, or a few, unless it is too far from that. `None` if a member of `selected` becomes impossible: it would be
    /// removed later, and without it the smaller background may be far worse.
    fn with_few_more(&self, strengths: &PriorStrengths, selected: &Selection, allowed: &[usize]) -> Option<Selection> {
        let products = self.products_at(strengths);
        let problem = self.problem(&products);
        let mut next = problem.reweighted(problem.choose(selected.set.clone(), &selected.fit.weights));
        let mut growth = Growth::default();
        for more in (0..IN_PLACE).rev() {
            if next.score < selected.score - 1e-6 {
                break;
            }
            let Some(grown) = problem.grow(&next, allowed, &mut growth) else {
                break;
            };
            let before = next.score;
            next = problem.reweighted(grown);
            if next.score - selected.score > MOST_LATER_GAIN * more as f64 * (before - next.score) {
                break;
            }
        }
        self.stay_possible(selected, &next).then_some(next)
    }

    /// Whether the members of `next` are possible that `selected` does not have, or that are possible there.
    pub(super) fn stay_possible(&self, selected: &Selection, next: &Selection) -> bool {
        let is_possible = |c: usize, fit: &Fit| is_possible(&self.candidates[c], &self.table, fit, &self.data.arm);
        let was_impossible = |c: usize| selected.set.contains(&c) && !is_possible(c, &selected.fit);
        next.set.iter().all(|&c| is_possible(c, &next.fit) || was_impossible(c))
    }
}
