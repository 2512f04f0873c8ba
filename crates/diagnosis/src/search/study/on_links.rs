//! The loads of gaps and springs between drive and link: the torque of the arm, and that of effects on the links' side of the gear.

use effects::{OnLinks, Term};
use rayon::prelude::*;

use super::Study;
use crate::data::rigid::Rigid;
use crate::data::statistics::rms;
use crate::regression::fit::Fit;
use crate::thresholds::SIMULATED_ANEW;

impl Study {
    /// The torques on the links' side of the gears, such as those of springs and transmission couplings, that the candidates `kept` have in
    /// `fit` beside the arm's, along each chunk.
    pub(super) fn on_links(&self, fit: &Fit, kept: &[usize]) -> Vec<OnLinks> {
        let data = &self.data;
        let beyond = kept.iter().map(|&c| &self.candidates[c]);
        let columns = beyond.filter(|c| c.hypothesis.spec().is_beyond_the_drive).flat_map(|c| &c.columns);
        let terms = columns.map(|&column| (self.table.terms[column], fit.coefficient(column)));
        let terms: Vec<(Term, f64)> = terms.filter(|(term, value)| term.law.carry.is_none() && *value != 0.0).collect();
        let along = data.rigid.par_iter().zip(&data.motions.chunks);
        along.map(|(rigid, chunk)| OnLinks::new(&terms, &rigid.along(chunk, &data.scales))).collect()
    }

    /// Whether the torques `on_links` are nearly those of the present table.
    pub(super) fn are_near(&self, on_links: &[OnLinks]) -> bool {
        (0..self.data.motions.dof).all(|joint| {
            let pairs = on_links.iter().zip(&self.data.rigid);
            let differences = pairs.flat_map(|(now, rigid)| {
                let before = rigid.on_links.torque.get(joint).map(Vec::as_slice).unwrap_or_default();
                let before = before.iter().copied().chain(std::iter::repeat(0.0));
                now.torque[joint].iter().zip(before).map(|(now, before)| now - before)
            });
            rms(differences).unwrap_or(0.0) <= SIMULATED_ANEW * self.data.scales.torque[joint]
        })
    }

    /// Whether the torque of the arm on `joint` is nearly the one along which its springs and gaps were simulated: `[chunk][tick]` (N m
    /// or N).
    pub(super) fn is_near(&self, joint: usize, simulated_along: &[Vec<f64>]) -> bool {
        let pairs = self.data.rigid.iter().zip(simulated_along);
        let differences = pairs.flat_map(|(rigid, before)| {
            through_gear(rigid, joint).into_iter().zip(before).map(|(now, before)| now - before)
        });
        let change = rms(differences).unwrap_or(0.0);
        change <= SIMULATED_ANEW * self.data.scales.torque[joint]
    }
}

/// The torque of the arm on `joint` with that on the links' side of its gear (N m or N): one value per tick.
pub(super) fn through_gear(rigid: &Rigid, joint: usize) -> Vec<f64> {
    let mut torque = rigid.tau[joint].clone();
    if let Some(on_links) = rigid.on_links.torque.get(joint) {
        torque.iter_mut().zip(on_links).for_each(|(sum, more)| *sum += more);
    }
    torque
}
