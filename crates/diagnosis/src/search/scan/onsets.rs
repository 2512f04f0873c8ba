//! Effects with an onset, suggested by the residual.

use effects::{Kind, Scope, SetsIn, Term};
use nalgebra::{Matrix4, Vector4};
use rayon::prelude::*;

use crate::data::Data;
use crate::regression::small::explained;
use crate::regression::table::Table;
use crate::search::candidate::Hypothesis;
use crate::thresholds::{FINE_ONSETS, ONSET_FROM_END, TRIED_ONSETS};

/// For each form on each joint, and for a payload, the candidate whose onset explains most of `residual` (N m or N, all
/// rows). There are none if the recordings do not share one clock, because their order is unknown then.
pub fn onsets(
    data: &Data,
    table: &Table,
    weights: &[f64],
    times: &[f64],
    residual: &[Vec<f64>],
) -> Vec<(Hypothesis, Option<usize>, Vec<Term>)> {
    if !data.motions.one_clock {
        return Vec::new();
    }
    let mut rows = table.rows_of(|recording| data.fitted[recording]);
    rows.sort_by(|&a, &b| times[b].total_cmp(&times[a]));
    let reversed = ReversedResidual { table, weights, times, residual, rows };
    let dof = table.dof();
    let mut kinds: Vec<(Kind, SetsIn)> = Kind::all().filter_map(|kind| Some((kind, kind.spec().sets_in?))).collect();
    kinds.sort_by_key(|(_, form)| form.turn);
    let (on_arm, on_joint): (Vec<_>, Vec<_>) = kinds.into_iter().partition(|(kind, _)| kind.spec().scope == Scope::Arm);
    let all: Vec<usize> = (0..dof).collect();
    let places = all.iter().flat_map(|&joint| on_joint.iter().map(move |&(kind, form)| (Some(joint), kind, form)));
    let places: Vec<(Option<usize>, Kind, SetsIn)> =
        places.chain(on_arm.iter().map(|&(kind, form)| (None, kind, form))).collect();
    places
        .into_par_iter()
        .flat_map_iter(|(joint, kind, form)| {
            let forms = (form.forms)(joint.unwrap_or(0));
            let joints = joint.map_or_else(|| all.clone(), |joint| vec![joint]);
            let from = reversed.best(&joints, &forms[0][..form.looked_for_with]);
            let hypothesis = Hypothesis { kind, other: None };
            let since = |from: f64| {
                let candidate =
                    |terms: &Vec<Term>| (hypothesis, joint, terms.iter().map(|term| term.since(from)).collect());
                forms.iter().map(candidate).collect()
            };
            from.map_or_else(Vec::new, since)
        })
        .collect()
}

/// The residual of the training recordings, the latest row first.
struct ReversedResidual<'a> {
    table: &'a Table,
    weights: &'a [f64],
    times: &'a [f64],
    residual: &'a [Vec<f64>],
    rows: Vec<usize>,
}

impl ReversedResidual<'_> {
    /// The onset from which the columns `what` explain most of the residual of `joints` on their moving rows.
    fn best(&self, joints: &[usize], what: &[Term]) -> Option<f64> {
        let (table, times) = (self.table, self.times);
        let columns: Vec<Vec<Option<&Vec<f64>>>> = joints
            .iter()
            .map(|&joint| {
                let column = |what: &Term| {
                    let term = table.terms.iter().position(|term| term == what)?;
                    table.place[joint][term].map(|place| &*table.joints[joint].x[place])
                };
                what.iter().map(column).collect()
            })
            .collect();
        if columns.iter().flatten().all(Option::is_none) {
            return None;
        }
        let moves = |row: &&usize| joints.iter().any(|&joint| table.joints[joint].moving[**row]);
        let (latest, earliest) = (times[*self.rows.iter().find(moves)?], times[*self.rows.iter().rev().find(moves)?]);
        let about = |found: f64| {
            [(found - TRIED_ONSETS).max(earliest + ONSET_FROM_END), (found + TRIED_ONSETS).min(latest - ONSET_FROM_END)]
        };
        let coarse = self.scan(joints, &columns, [earliest + ONSET_FROM_END, latest - ONSET_FROM_END], TRIED_ONSETS)?;
        self.scan(joints, &columns, about(coarse), FINE_ONSETS)
    }

    /// The best of the onsets between two times, `step` from each other.
    fn scan(
        &self,
        joints: &[usize],
        columns: &[Vec<Option<&Vec<f64>>>],
        [from, to]: [f64; 2],
        step: f64,
    ) -> Option<f64> {
        let (table, times) = (self.table, self.times);
        let (mut matrix, mut right) = (Matrix4::zeros(), Vector4::zeros());
        let mut found: Option<(f64, f64)> = None;
        let mut next = to;
        // From the end to the beginning, so that the sums contain all rows since each time.
        for &row in &self.rows {
            let time = times[row];
            while time < next && next >= from {
                let gain = explained(matrix, &right, 1e-9);
                if found.is_none_or(|(most, _)| gain > most) {
                    found = Some((gain, next));
                }
                next -= step;
            }
            if next < from {
                break;
            }
            for (&joint, columns) in joints.iter().zip(columns) {
                if !table.joints[joint].moving[row] {
                    continue;
                }
                let mut x = Vector4::zeros();
                for (value, column) in x.iter_mut().zip(columns) {
                    *value = column.map_or(0.0, |column| column[row]);
                }
                matrix += self.weights[joint] * x * x.transpose();
                right += self.weights[joint] * self.residual[joint][row] * x;
            }
        }
        found.map(|(_, from)| from)
    }
}
