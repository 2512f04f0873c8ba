//! What explains the recordings in the place of links that differ from the URDF.

use rayon::prelude::*;

use super::Study;
use crate::regression::strengths::PriorStrengths;
use crate::search::problem::Selection;
use crate::thresholds::GAIN_STRENGTHS;

impl Study {
    /// The loss of score and likelihood of `selected` (nats) if `link` differs from the URDF no more than most links.
    pub fn evidence_of_link(&self, selected: &Selection, link: usize) -> [f64; 2] {
        let (_, without) = self.beside(selected, &self.strengths.with_link_as_most(link));
        [without.score - selected.score, without.fit.loss - selected.fit.loss]
    }

    /// The loss of score of `selected` (nats) if torque constants deviate in the place of `link`, and `link` differs from the URDF no more
    /// than most links. Without a link, no link differs from the URDF.
    pub fn in_torque_constants(&self, selected: &Selection, link: Option<usize>) -> f64 {
        let without =
            link.map_or_else(|| self.strengths.with_exact_links(), |link| self.strengths.with_link_as_most(link));
        let loss = |gain: f64| {
            let strengths = PriorStrengths { gain, ..without.clone() };
            let products = self.products_at(&strengths);
            let problem = self.problem(&products);
            let next = problem.choose(selected.set.clone(), &selected.fit.weights);
            problem.reweighted(next).score - selected.score
        };
        let gains = GAIN_STRENGTHS.into_iter().filter(|&gain| gain > self.strengths.gain);
        gains.map(loss).fold(f64::INFINITY, f64::min)
    }

    /// The links that may differ from the URDF in the place of `link`, each with the loss of score and likelihood of `selected`
    /// (nats).
    pub fn in_other_links(&self, selected: &Selection, link: usize) -> Vec<(usize, [f64; 2])> {
        let common = self.strengths.common();
        let as_most = |&other: &usize| self.strengths.of_link(other) == common;
        let others: Vec<usize> = (0..self.data.arm.dof()).filter(as_most).collect();
        others
            .into_par_iter()
            .map(|other| {
                let mut strengths = self.strengths.with_link_as_most(link);
                strengths.links[other] = self.strengths.of_link(link);
                let (_, instead) = self.beside(selected, &strengths);
                (other, [instead.score - selected.score, instead.fit.loss - selected.fit.loss])
            })
            .collect()
    }
}
