//! Effects that set in halfway: when, by what is left.

use nalgebra::{Matrix4, Vector4};
use rayon::prelude::*;

use crate::regression::table::Table;
use crate::regression::term::{Onset, Term};
use crate::search::candidate::Cause;
use crate::search::study::Study;

/// What may set in, with the columns that it has.
const FORMS: [(Cause, &[Onset]); 4] = [
    (Cause::TorqueOffset, &[Onset::One]),
    (Cause::TorqueScale, &[Onset::Rigid]),
    (Cause::Spring, &[Onset::One, Onset::Position]),
    (Cause::Drag, &[Onset::Drag]),
];
/// From one time that is tried to the next, and about the best of them (s).
const STEP: f64 = 0.5;
const FINE: f64 = 0.05;
/// From either end of the recordings to the first time that is tried (s).
const LEAST: f64 = 2.0;

/// For each form on each joint, and for a payload, the candidate whose onset explains most of `residual` (N m or N, all rows).
/// None where the recordings are not on one clock: before and after mean nothing then.
pub fn onsets(
    study: &Study,
    weights: &[f64],
    times: &[f64],
    residual: &[Vec<f64>],
) -> Vec<(Cause, Option<usize>, Vec<Term>)> {
    if !study.motions.one_clock {
        return Vec::new();
    }
    let mut rows: Vec<usize> = study.training().collect();
    rows.sort_by(|&a, &b| times[b].total_cmp(&times[a]));
    let past = Past {
        table: &study.table,
        weights,
        times,
        residual,
        rows,
    };
    let dof = study.table.dof();
    let forms: Vec<(usize, Cause, &[Onset])> = (0..dof)
        .flat_map(|joint| FORMS.map(|(cause, what)| (joint, cause, what)))
        .collect();
    let mut list: Vec<(Cause, Option<usize>, Vec<Term>)> = forms
        .into_par_iter()
        .filter_map(|(joint, cause, what)| {
            let from = past.best(&[joint], what)?;
            let terms = what.iter().map(|&what| Term::Since { joint, what, from }).collect();
            Some((cause, Some(joint), terms))
        })
        .collect();
    let joints: Vec<usize> = (0..dof).collect();
    let body = [0, 1, 2, 3].map(Onset::Payload);
    if let Some(from) = past.best(&joints, &body) {
        // With its moments of inertia and, where they do not show, without.
        for count in [10, 4] {
            let what = (0..count).map(Onset::Payload);
            let terms = what.map(|what| Term::Since { joint: 0, what, from }).collect();
            list.push((Cause::Payload, None, terms));
        }
    }
    list
}

/// What is left of the training recordings, the latest row first.
struct Past<'a> {
    table: &'a Table,
    weights: &'a [f64],
    times: &'a [f64],
    residual: &'a [Vec<f64>],
    rows: Vec<usize>,
}

impl Past<'_> {
    /// The onset from which on the columns `what` explain most of what is left of `joints` on their moving rows.
    fn best(&self, joints: &[usize], what: &[Onset]) -> Option<f64> {
        let (table, times) = (self.table, self.times);
        let columns: Vec<Vec<Option<&Vec<f64>>>> = joints
            .iter()
            .map(|&joint| {
                let column = |what: &Onset| {
                    let term = table.terms.iter().position(|&term| term == what.always(joint))?;
                    table.place[joint][term].map(|place| &table.joints[joint].x[place])
                };
                what.iter().map(column).collect()
            })
            .collect();
        if columns.iter().flatten().all(Option::is_none) {
            return None;
        }
        let moves = |row: &&usize| joints.iter().any(|&joint| table.joints[joint].moving[**row]);
        let (latest, earliest) = (
            times[*self.rows.iter().find(moves)?],
            times[*self.rows.iter().rev().find(moves)?],
        );
        let about = |found: f64| [(found - STEP).max(earliest + LEAST), (found + STEP).min(latest - LEAST)];
        let coarse = self.scan(joints, &columns, [earliest + LEAST, latest - LEAST], STEP)?;
        self.scan(joints, &columns, about(coarse), FINE)
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
        // From the end to the beginning, what the columns explain since each time.
        for &row in &self.rows {
            let time = times[row];
            while time < next && next >= from {
                let gain = explained(&matrix, &right);
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

/// What columns of these inner products explain.
fn explained(matrix: &Matrix4<f64>, right: &Vector4<f64>) -> f64 {
    let mut matrix = *matrix;
    let ridge = 1e-9 * matrix.trace();
    for k in 0..4 {
        matrix[(k, k)] += ridge.max(1e-300);
    }
    matrix.cholesky().map_or(0.0, |factor| right.dot(&factor.solve(right)))
}
