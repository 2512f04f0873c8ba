//! Selects the strengths of the background together with the effects, by the gain of the score.

use arm::JointKind;
use effects::Scales;
use effects::background::LAG;
use effects::drive::ROTOR_INERTIA;
use rayon::prelude::*;

use super::Study;
use crate::data::motion::{Chunk, Motions};
use crate::regression::bodies::PER_LINK;
use crate::regression::fit::{Fit, Products};
use crate::regression::strengths::{Part, PriorStrengths};
use crate::search::candidate::Candidate;
use crate::search::problem::{Growth, Selection};
use crate::thresholds::{
    AS_LIKELY_BESIDE_EXACT, BESIDE_FEW_LINKS, FEW_JOINTS, HOPELESS_EXCHANGE, LINK_STRENGTHS, LONGEST_SHORT_LAG,
    MOST_LATER_GAIN, MOST_SELECTED, MOVED, NEARLY_AS_LIKELY, OWN_STRENGTHS, PER_IMITATION, SLIDING_STRENGTH,
};

/// The largest number of effects that may together replace a part of the background.
const IN_PLACE: usize = 3;

/// The largest number of consecutive changes of the strengths. Recomputed weights may raise a score again, so that two
/// strengths could alternate forever.
const MOST_MOVES: usize = 24;

/// The training recordings that move each joint: the first one of each group.
pub fn moved(motions: &Motions, scales: &Scales) -> Vec<Vec<usize>> {
    let of = |joint: usize| {
        let moves = |chunk: &&Chunk| {
            let fitted = !motions.sources[chunk.recording].held_out;
            fitted && chunk.qd[joint].iter().any(|qd| qd.abs() > MOVED * scales.rest[joint])
        };
        let mut list: Vec<usize> = motions.chunks.iter().filter(moves).map(|chunk| chunk.group).collect();
        list.sort_unstable();
        list.dedup();
        list
    };
    (0..motions.dof).map(of).collect()
}

impl Study {
    /// The column of a joint's torque constant in the background; `None` if the joint does not move.
    pub fn torque_constant(&self, joint: usize) -> Option<usize> {
        self.prior.torque_constant(joint)
    }

    /// The prior variances of a link's ten inertial parameters, at the strength selected by evidence.
    pub fn prior_variances(&self, link: usize) -> [f64; PER_LINK] {
        self.prior.variances(link, self.strengths.of_link(link))
    }

    /// The loss of the score of `selected`, and of the likelihood of the held-out recordings, if all links have the URDF's
    /// inertial parameters (nats).
    pub fn evidence_of_inertials(&self, held: Option<&Products>, selected: &Selection) -> (f64, Option<f64>) {
        let (products, without) = self.beside(selected, &self.strengths.with_exact_links());
        let without = self.problem(&products).reweighted(without);
        let outside =
            held.map(|held| held.loss_of(&self.table, &without.fit) - held.loss_of(&self.table, &selected.fit));
        (without.score - selected.score, outside)
    }

    /// The products and the fit of `selected` beside a background of these strengths.
    pub(super) fn beside(&self, selected: &Selection, strengths: &PriorStrengths) -> (Products, Selection) {
        let products = self.products_at(strengths);
        let next = self.problem(&products).choose(selected.set.clone(), &selected.fit.weights);
        (products, next)
    }

    /// `selected` beside the present background, and beside those in which all links may differ from the URDF by more.
    pub fn with_stronger_links(&self, selected: &Selection) -> Vec<(Products, Selection)> {
        let stronger = LINK_STRENGTHS.into_iter().filter(|&rho| rho > self.strengths.common());
        let all = stronger.map(|rho| self.strengths.at_least(rho)).filter(|strengths| self.stated.allows(strengths));
        [self.strengths.clone()].into_iter().chain(all).map(|strengths| self.beside(selected, &strengths)).collect()
    }

    /// The best strengths of a background without the other members of `set`, among those that are stronger somewhere than the
    /// present ones: alternatives of an effect that may be a part of the background. Each has its link and its fit.
    pub fn in_the_background(&self, set: &[usize], near: &Selection) -> Vec<(Option<usize>, Selection)> {
        let common = self.strengths.common();
        let stronger = |strengths: &PriorStrengths| {
            let pairs = strengths.links.iter().zip(&self.strengths.links);
            strengths.friction == self.strengths.friction
                && strengths.varied == self.strengths.varied
                && strengths.between == self.strengths.between
                && strengths.uncorrected_friction == self.strengths.uncorrected_friction
                && strengths.offset == self.strengths.offset
                && strengths.gain == self.strengths.gain
                && pairs.clone().all(|(new, old)| new >= old)
                && pairs.clone().any(|(new, old)| new > old)
        };
        let all = self.strengths.neighbours().into_iter().chain(self.strengths.with_other_links());
        let trials: Vec<PriorStrengths> = all.filter(stronger).filter(|trial| self.stated.allows(trial)).collect();
        trials
            .into_par_iter()
            .map(|strengths| {
                let link = (0..strengths.links.len())
                    .find(|&link| strengths.common() == common && strengths.links[link] > self.strengths.links[link]);
                let products = self.products_at(&strengths);
                (link, self.problem(&products).choose(set.to_vec(), &near.fit.weights))
            })
            .collect()
    }

    /// `selected` beside other bodies of the requested links (of all links, if one of them is `None`), with the strength that the evidence
    /// prefers, which becomes that of the study; `None` if it prefers the URDF's bodies.
    pub fn with_requested_bodies(&mut self, links: &[Option<usize>], selected: &Selection) -> Option<Selection> {
        let of_all = links.contains(&None);
        let strengths: &[f64] = if of_all { &LINK_STRENGTHS } else { &OWN_STRENGTHS };
        let trial = |&rho: &f64| {
            let is_wanted = |link: usize| of_all || links.contains(&Some(link));
            let links = self.strengths.links.iter().enumerate();
            let links = links.map(|(link, &own)| if is_wanted(link) { own.max(rho) } else { own });
            PriorStrengths { links: links.collect(), ..self.strengths.clone() }
        };
        let (strengths, next) = self.strengthened(selected, strengths.iter().map(trial).collect())?;
        self.strengths = strengths;
        Some(next)
    }

    /// The strongest background in which all links differ from the URDF and which is nearly as likely as that of `selected` by its score,
    /// and `selected` fitted again beside it; for a payload on an arm of few joints, the most likely one, and for the inertia of a drive on
    /// a prismatic joint, which is a mass of the link as well, one of the usual strength. `None` if there is none, if all of the links
    /// differ already, if none do and no such effect is selected, or if the user states the strengths.
    pub fn with_all_links(&self, selected: &Selection) -> Option<(PriorStrengths, Selection)> {
        let links = &self.strengths.links;
        let has_payload = selected.set.iter().any(|&c| self.is_payload(c));
        let is_mass = |&c: &usize| {
            let Candidate { hypothesis, joint, .. } = &self.candidates[c];
            let is_sliding = joint.is_some_and(|joint| self.data.arm.joints()[joint].kind == JointKind::Prismatic);
            is_sliding && hypothesis.is(&ROTOR_INERTIA)
        };
        let has_mass = !has_payload && selected.set.iter().any(is_mass);
        let are_few = has_payload && links.len() <= FEW_JOINTS;
        let margin = if are_few || has_mass {
            BESIDE_FEW_LINKS
        } else if links.iter().any(|&rho| rho > 0.0) {
            NEARLY_AS_LIKELY
        } else if has_payload {
            AS_LIKELY_BESIDE_EXACT
        } else {
            return None;
        };
        if self.strengths.common() > 0.0 || self.stated.links.is_some() {
            return None;
        }
        let at_least = |least: f64| {
            let strengths = self.strengths.at_least(least);
            let (_, next) = self.beside(selected, &strengths);
            (strengths, next)
        };
        let strengths = if has_mass { &[SLIDING_STRENGTH][..] } else { &LINK_STRENGTHS };
        let strongest_first = strengths.iter().rev().copied().filter(|&rho| rho > 0.0);
        let mut nearly = strongest_first.map(at_least).filter(|(_, next)| next.score < selected.score + margin);
        if are_few {
            // So wide a margin holds links that nobody would expect.
            nearly.min_by(|a, b| a.1.score.total_cmp(&b.1.score))
        } else {
            nearly.next()
        }
    }

    /// `selected` with more of the candidates `allowed`, and with the strengths of the background that the evidence prefers.
    /// Each step takes the candidate or the change of strengths that gains more. Members that no longer pay are removed.
    pub fn grown(&mut self, mut selected: Selection, allowed: &[usize]) -> Selection {
        let mut products = self.training_products();
        let mut growth = Growth::default();
        let mut moves = 0;
        let mut before_payload: Option<(PriorStrengths, Selection)> = None;
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
                        let is_new = |c: &usize| self.is_payload(*c) && !selected.set.contains(c);
                        if next.set.iter().any(is_new) {
                            before_payload = Some((self.strengths.clone(), selected.clone()));
                        }
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
        // A payload in the place of the last link's error may need parameters that no body has, once the background is smaller still.
        // Without the payload, nothing would stand for that error.
        let problem = self.problem(&products);
        let is_impossible = |c: &usize| self.is_payload(*c) && !problem.is_possible(*c, &selected.fit);
        if let Some((strengths, before)) = before_payload
            && selected.set.iter().any(|c| !before.set.contains(c) && is_impossible(c))
            && problem.prune(selected.clone()).score > before.score
        {
            self.strengths = strengths;
            self.note_strengths("a payload in the place of the background is not physical", &selected, &before);
            products = self.training_products();
            selected = before;
        }
        self.pruned(&products, selected)
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
        let stays = |&c: &usize| problem.is_possible(c, &next.fit) || !problem.is_possible(c, &selected.fit);
        selected.set.iter().all(stays).then_some(next)
    }

    /// `selected` with the strengths of the background that the evidence prefers.
    pub fn with_best_strengths(&mut self, mut selected: Selection) -> Selection {
        for _ in 0..MOST_MOVES {
            let now = &self.strengths;
            let kinds = [
                now.neighbours(),
                self.in_one_place(&selected),
                now.in_one_link(),
                now.with_other_offsets(),
                now.finer(),
            ];
            let next = kinds.into_iter().find_map(|others| self.strengthened(&selected, others));
            match next {
                Some((strengths, next)) => {
                    self.strengths = strengths;
                    self.note_strengths("more evidence for this background", &selected, &next);
                    selected = next;
                }
                None => break,
            }
        }
        selected
    }

    /// The evidence for `members` of `selected` together (nats): the difference of the scores without and with them, each with its own
    /// best background. An effect that resembles wrong inertials allows a smaller background, which must not count as
    /// evidence for the effect.
    pub fn evidence_beside_best_background(&mut self, selected: &Selection, members: &[usize]) -> f64 {
        let kept = self.strengths.clone();
        let products = self.training_products();
        let problem = self.problem(&products);
        let without = members.iter().fold(selected.clone(), |rest, &member| problem.without(&rest, member));
        // The present background may be smaller than the evidence prefers, because of the held-out recordings.
        let mut best = |mut fit: Selection| {
            for _ in 0..MOST_MOVES {
                let mut neighbours = self.strengths.neighbours();
                // The strength of friction that differs between recordings is kept: it has no relation to the effect.
                neighbours.retain(|next| next.friction == kept.friction);
                let Some((strengths, next)) = self.strengthened(&fit, neighbours) else {
                    break;
                };
                self.strengths = strengths;
                fit = next;
            }
            self.strengths = kept.clone();
            fit.score
        };
        best(without) - best(selected.clone())
    }

    /// `selected` with another body of a link in the place of the effects on its joint that may together imitate it: a scale
    /// of the link and a spring on a lever resemble a shifted centre of mass. Effects that are clearly better are kept.
    pub fn without_imitations(&mut self, mut selected: Selection) -> Selection {
        for link in 0..self.data.arm.dof() {
            let imitates = |&c: &usize| {
                let candidate = &self.candidates[c];
                candidate.joint == Some(link) && candidate.hypothesis.spec().may_be_inertial
            };
            let (imitations, rest): (Vec<usize>, Vec<usize>) = selected.set.iter().copied().partition(imitates);
            if imitations.len() < 2 {
                continue;
            }
            let own = self.strengths.links[link];
            let trials = OWN_STRENGTHS.into_iter().filter(|&rho| rho > own).map(|rho| {
                let mut strengths = self.strengths.clone();
                strengths.links[link] = rho;
                strengths
            });
            let trials = trials.filter(|strengths| self.stated.allows(strengths));
            let bodies = trials.map(|strengths| {
                let products = self.products_at(&strengths);
                let next = self.problem(&products).choose(rest.clone(), &selected.fit.weights);
                (strengths, next)
            });
            let best = bodies.min_by(|a, b| a.1.score.total_cmp(&b.1.score));
            if let Some((strengths, next)) = best
                && next.score < selected.score + PER_IMITATION
            {
                self.strengths = strengths;
                self.note_strengths("one link in the place of effects that imitate it", &selected, &next);
                selected = next;
            }
        }
        selected
    }

    /// Whether the lag of the torques in a fit is one that such torques may have, if there is one.
    fn has_short_lag(&self, fit: &Fit) -> bool {
        let background = fit.columns.iter().zip(&fit.coefficients).take(fit.background);
        let is_lag = |&(&column, _): &(&usize, &f64)| self.table.terms[column].is(&LAG);
        background.filter(is_lag).all(|(_, lag)| lag.abs() <= LONGEST_SHORT_LAG)
    }

    /// The best of the strengths `others`, with `selected` fitted again, if they are better.
    fn strengthened(&self, selected: &Selection, others: Vec<PriorStrengths>) -> Option<(PriorStrengths, Selection)> {
        let trials: Vec<(PriorStrengths, Selection)> = others
            .into_par_iter()
            .filter(|strengths| self.stated.allows(strengths))
            .map(|strengths| {
                let products = self.products_at(&strengths);
                let problem = self.problem(&products);
                let next = problem.choose(selected.set.clone(), &selected.fit.weights);
                // Without a background, the weights may be far from the final ones.
                let next = if self.strengths.is_none() { problem.reweighted(next) } else { next };
                (strengths, next)
            })
            .filter(|(_, next)| self.has_short_lag(&next.fit))
            .collect();
        let (strengths, next) = trials.into_iter().min_by(|a, b| a.1.score.total_cmp(&b.1.score))?;
        if next.score >= selected.score - 1e-6 {
            return None;
        }
        let before = strengths.impossible_constants.len();
        let (strengths, next) = self.with_possible_constants(strengths, next);
        let pays = strengths.impossible_constants.len() == before || next.score < selected.score - 1e-6;
        pays.then_some((strengths, next))
    }
}
