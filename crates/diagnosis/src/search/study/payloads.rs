//! Decides between payloads and bodies of links, which explain the same torque.

use effects::arm::{PAYLOAD, PAYLOAD_PARAMETER, PAYLOAD_WITHOUT_MOMENTS};

use super::Study;
use crate::regression::bodies::PER_LINK;
use crate::search::problem::Selection;
use crate::thresholds::{FELT, PAYLOAD_JOINTS, PER_LINK_APART};

impl Study {
    /// Whether a candidate is a payload, with or without moments of inertia.
    pub fn is_payload(&self, candidate: usize) -> bool {
        self.candidates[candidate].hypothesis.is(&PAYLOAD)
    }

    /// Whether a candidate is a payload with moments of inertia of its own.
    pub fn has_free_moments(&self, candidate: usize) -> bool {
        let columns = &self.candidates[candidate].columns;
        self.is_payload(candidate)
            && columns.len() == PER_LINK
            && self.table.terms[columns[0]].always().is(&PAYLOAD_PARAMETER)
    }

    /// The payload without moments that acts when `payload` does.
    pub fn without_moments(&self, payload: usize) -> Option<usize> {
        let first = |c: usize| &self.table.terms[self.candidates[c].columns[0]];
        (0..self.candidates.len()).find(|&c| {
            let is_without = first(c).always().is(&PAYLOAD_WITHOUT_MOMENTS);
            self.is_payload(c) && is_without && first(c).acts == first(payload).acts
        })
    }

    /// The mass of the URDF's last link (kg).
    pub fn mass_of_last_link(&self) -> f64 {
        self.data.arm.joints().last().map_or(0.0, |joint| joint.inertia.mass)
    }

    /// `selected` with a payload in the place of another body of the last link, if that is better. A search that takes the link
    /// first does not find the payload, because both explain the same torque.
    pub fn with_payload_for_last_link(&mut self, selected: Selection) -> Selection {
        let common = self.strengths.common();
        let is_payload = |&c: &usize| self.is_payload(c);
        let Some(last) = self.data.arm.dof().checked_sub(1) else {
            return selected;
        };
        if self.strengths.links[last] <= common || selected.set.iter().any(is_payload) {
            return selected;
        }
        let mut strengths = self.strengths.clone();
        strengths.links[last] = common;
        let products = self.products_at(&strengths);
        let problem = self.problem(&products);
        let trials = self.allowed().into_iter().filter(is_payload).filter_map(|payload| {
            let mut set = selected.set.clone();
            set.push(payload);
            let next = problem.choose(set, &selected.fit.weights);
            problem.is_possible(payload, &next.fit).then_some(next)
        });
        let best = trials.min_by(|a, b| a.score.total_cmp(&b.score));
        match best {
            Some(next) if next.score < selected.score => {
                self.strengths = strengths;
                self.note_strengths("a payload in the place of the last link", &selected, &next);
                next
            }
            _ => selected,
        }
    }

    /// `selected` without a payload that has hardly any torque on the last joints, if the URDF's links are wrong as well. The
    /// centre of mass of such a payload lies where these axes meet, and a heavier link before them explains the same
    /// torque. It is kept if the links explain clearly less, and if it has an onset, because a link cannot have one.
    pub fn without_payload_of_a_link(&mut self, selected: Selection) -> Selection {
        let is_unfelt = |&c: &usize| {
            let sets_in = || !self.always_acts(c);
            let columns = &self.candidates[c].columns;
            let is_felt = || self.are_felt_at_the_end(columns, &selected.fit.values(columns));
            self.is_payload(c) && !sets_in() && !is_felt()
        };
        let unfelt: Vec<usize> = selected.set.iter().copied().filter(is_unfelt).collect();
        let (Some(&payload), true) = (unfelt.first(), self.strengths.common() > 0.0) else {
            return selected;
        };
        let before = (self.strengths.clone(), self.prior.clone(), self.refused.clone());
        // Each of the two is compared with the prior about its own bodies.
        let with_payload = self.about_own_bodies(selected.clone());
        (self.strengths, self.prior) = (before.0.clone(), before.1.clone());
        self.refuse(payload);
        let rest = selected.set.iter().copied().filter(|c| !unfelt.contains(c)).collect();
        let next = self.chosen(rest, &selected.fit.weights);
        self.note("the last joints hardly feel it, so that a link may carry it", &selected, &next);
        let next = self.with_best_strengths(next);
        let allowed = self.allowed();
        let next = self.grown(next, &allowed);
        let next = self.about_own_bodies(next);
        if next.score < with_payload.score + PER_LINK_APART {
            return next;
        }
        (self.strengths, self.prior, self.refused) = before;
        self.note("no link explains as much as the payload", &next, &selected);
        selected
    }

    /// Whether the share of these columns in the torque of one of the last joints is comparable to their largest share in any
    /// joint.
    pub fn are_felt_at_the_end(&self, columns: &[usize], values: &[f64]) -> bool {
        let share = |joint: usize| {
            let torque = self.table.torque(joint, columns, values);
            self.data.share(joint, self.table.spread(joint, &self.data.fitted, &torque))
        };
        let shares: Vec<f64> = (0..self.data.arm.dof()).map(share).collect();
        let most = |shares: &[f64]| shares.iter().fold(0.0, |most: f64, &share| most.max(share));
        most(&shares[shares.len().saturating_sub(PAYLOAD_JOINTS)..]) >= FELT * most(&shares)
    }
}
