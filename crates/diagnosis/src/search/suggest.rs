//! Suggests candidates from the residual of a selection: contacts, ripples, sinusoids in time, onsets.

use effects::arm::{EXTERNAL_CONTACT, PAYLOAD, contact_columns, contact_window};
use effects::drive::{TORQUE_RIPPLE, ripple_columns};
use effects::unmodelled::{PERIODIC, periodic_columns};
use effects::{Size, Spec, Term};
use rayon::prelude::*;

use crate::search::candidate::Hypothesis;
use crate::search::problem::Selection;
use crate::search::scan;
use crate::search::study::Study;
use crate::thresholds::{
    LEAST_RIPPLE_PHASE, MOST_CONTACTS, MOST_OF_A_RECORDING, MOST_RIPPLES, MOST_WAVES, OF_THE_SAME_LOAD,
};

impl Study {
    /// Adds the candidates that the residual of `selected` suggests.
    pub fn suggest(&mut self, selected: &Selection) {
        let residual = scan::residuals(&self.table, &selected.fit);
        let times = self.data.motions.row_times();
        let dof = self.data.motions.dof;
        let windows = scan::contacts(
            &self.table,
            &times,
            &residual,
            &selected.fit.weights,
            self.force(),
            &self.data.fitted,
            MOST_CONTACTS,
        );
        let found: Vec<(Vec<f64>, Vec<f64>)> = (0..dof)
            .into_par_iter()
            .map(|joint| {
                if self.data.scales.speed[joint] <= self.data.scales.rest[joint] {
                    return (Vec::new(), Vec::new());
                }
                let (table, motions) = (&self.table, &self.data.motions);
                (
                    scan::ripples(
                        table,
                        motions,
                        &self.data.scales,
                        joint,
                        &residual[joint],
                        &self.data.fitted,
                        MOST_RIPPLES,
                    ),
                    scan::waves(table, motions, joint, &residual[joint], &self.data.fitted, MOST_WAVES),
                )
            })
            .collect();
        let of = |kind: &'static Spec| Hypothesis::of(kind);
        let mut new = scan::onsets(&self.data, &self.table, &selected.fit.weights, &times, &residual);
        // A part of a load that was put down, which the background has, would be a payload.
        let until = self.own_load.as_ref().and_then(|load| load.until);
        let is_of_it = |term: &Term| {
            let onset = term.onset();
            onset.zip(until).is_some_and(|(onset, until)| (onset - until).abs() < OF_THE_SAME_LOAD)
        };
        new.retain(|(hypothesis, _, terms)| !(hypothesis.is(&PAYLOAD) && terms.iter().any(is_of_it)));
        for (from, to) in windows {
            for round in [false, true] {
                new.push((of(&EXTERNAL_CONTACT), None, contact_columns(from, to, round)));
            }
        }
        for (joint, (ripples, waves)) in found.into_iter().enumerate() {
            for periods in ripples {
                let always = ripple_columns(joint, periods);
                // A tooth that broke since the recordings from before.
                let since = self.data.motions.changed_at.map(|at| always.iter().map(|term| term.since(at)).collect());
                let forms = std::iter::once(always).chain(since);
                new.extend(forms.map(|terms: Vec<Term>| (of(&TORQUE_RIPPLE), Some(joint), terms)));
            }
            for omega in waves {
                new.push((of(&PERIODIC), Some(joint), periodic_columns(joint, omega)));
            }
        }
        let missing: Vec<Term> = new
            .iter()
            .flat_map(|(_, _, terms)| terms.iter().copied())
            .filter(|term| !self.table.terms.contains(term))
            .collect();
        self.table.add(&self.data.motions, &self.data.rigid, &self.data.scales, missing, None);
        for (hypothesis, joint, terms) in new {
            self.add(hypothesis, joint, terms);
        }
    }

    /// Whether ripples among terms repeat several times within the joint's motion. One that does not is no ripple, but any function of the
    /// position.
    pub fn repeats(&self, terms: &[Term]) -> bool {
        terms.iter().all(|term| {
            let swept = term.joint.map_or(f64::INFINITY, |joint| self.data.scales.swept[joint]);
            let periods = term.law.sizes.iter().find(|(size, _)| *size == Size::Periods);
            periods.is_none_or(|&(_, at)| term.sizes[at] * swept >= LEAST_RIPPLE_PHASE)
        })
    }

    /// Whether terms are not a contact, or are a contact that is short in comparison with its recording.
    pub fn is_brief(&self, terms: &[Term]) -> bool {
        let Some(window) = terms.first().and_then(contact_window) else {
            return true;
        };
        self.data.contact_share(&[window]).is_none_or(|(_, share)| share <= MOST_OF_A_RECORDING)
    }
}
