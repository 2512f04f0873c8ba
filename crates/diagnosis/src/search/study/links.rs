//! What explains the recordings in the place of links that differ from the URDF.

use rayon::prelude::*;

use super::Study;
use crate::regression::strengths::Strengths;
use crate::search::problem::Selection;
use crate::thresholds::GAIN_STRENGTHS;

impl Study {
    /// The loss of score and likelihood of `selected` (nats) if `link` differs from the URDF no more than most links.
    pub fn evidence_of_link(&self, selected: &Selection, link: usize) -> [f64; 2] {
        let mut links = self.strengths.links.clone();
        links[link] = self.strengths.common();
        let (_, without) = self.with_links(selected, links);
        [without.score - selected.score, without.fit.loss - selected.fit.loss]
    }

    /// The loss of score of `selected` (nats) if torque constants deviate in the place of `link`, and `link` differs from the URDF no more
    /// than most links. Without a link, no link differs from the URDF.
    pub fn in_torque_constants(&self, selected: &Selection, link: Option<usize>) -> f64 {
        let mut links = self.strengths.links.clone();
        match link {
            Some(link) => links[link] = self.strengths.common(),
            None => links.fill(0.0),
        }
        let loss = |gain: f64| {
            let strengths = Strengths {
                links: links.clone(),
                gain,
                ..self.strengths.clone()
            };
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
        let as_most = |&other: &usize| self.strengths.links[other] == common;
        let others: Vec<usize> = (0..self.data.arm.dof()).filter(as_most).collect();
        others
            .into_par_iter()
            .map(|other| {
                let mut links = self.strengths.links.clone();
                links.swap(link, other);
                let (_, instead) = self.with_links(selected, links);
                (
                    other,
                    [instead.score - selected.score, instead.fit.loss - selected.fit.loss],
                )
            })
            .collect()
    }
}
