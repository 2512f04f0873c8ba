//! Effects that set in halfway: when, by what is left.

use rayon::prelude::*;

use super::explained;
use crate::candidate::Cause;
use crate::motion::Motions;
use crate::table::Table;
use crate::term::{Onset, Term};

/// What may set in, with the columns that it has.
const FORMS: [(Cause, &[Onset]); 4] = [
    (Cause::TorqueOffset, &[Onset::One]),
    (Cause::TorqueScale, &[Onset::Rigid]),
    (Cause::Spring, &[Onset::One, Onset::Position]),
    (Cause::Drag, &[Onset::Drag]),
];
/// From one time that is tried to the next, and from either end of the recordings to the first of them (s).
const STEP: f64 = 0.5;
const LEAST: f64 = 2.0;

/// For each form on each joint, the candidate whose onset explains most of `residual` (N m or N, all rows). None where the
/// recordings are not on one clock: before and after mean nothing then.
pub fn onsets(
    table: &Table,
    motions: &Motions,
    times: &[f64],
    residual: &[Vec<f64>],
    fitted: &[bool],
) -> Vec<(Cause, Option<usize>, Vec<Term>)> {
    if !motions.one_clock {
        return Vec::new();
    }
    let rows: Vec<usize> = table
        .rows
        .iter()
        .zip(fitted)
        .filter(|(_, fitted)| **fitted)
        .flat_map(|(rows, _)| rows.clone())
        .collect();
    let forms: Vec<(usize, Cause, &[Onset])> = (0..table.dof())
        .flat_map(|joint| FORMS.map(|(cause, what)| (joint, cause, what)))
        .collect();
    forms
        .into_par_iter()
        .filter_map(|(joint, cause, what)| {
            let from = best(table, times, &residual[joint], &rows, joint, what)?;
            let terms = what.iter().map(|&what| Term::Since { joint, what, from }).collect();
            Some((cause, Some(joint), terms))
        })
        .collect()
}

/// The onset from which on the columns `what` explain most of what is left of `joint` on its moving `rows`.
fn best(table: &Table, times: &[f64], residual: &[f64], rows: &[usize], joint: usize, what: &[Onset]) -> Option<f64> {
    let this = &table.joints[joint];
    let column = |what: Onset| -> Option<&Vec<f64>> {
        let term = table.terms.iter().position(|&term| term == what.always(joint))?;
        table.place[joint][term].map(|place| &this.x[place])
    };
    let first = column(*what.first()?)?;
    let second = match what.get(1) {
        Some(&what) => Some(column(what)?),
        None => None,
    };
    let mut moving: Vec<usize> = rows.iter().copied().filter(|&row| this.moving[row]).collect();
    moving.sort_by(|&a, &b| times[b].total_cmp(&times[a]));
    let (latest, earliest) = (times[*moving.first()?], times[*moving.last()?]);
    let mut sums = [0.0; 5];
    let mut found: Option<(f64, f64)> = None;
    let mut next = latest - LEAST;
    // From the end to the beginning, what the columns explain since each time.
    for row in moving {
        let time = times[row];
        if time < earliest + LEAST {
            break;
        }
        while time < next {
            let [aa, ab, bb, ar, br] = sums;
            let gain = match second {
                Some(_) => explained(aa, ab, bb, ar, br),
                None if aa > 0.0 => ar * ar / aa,
                None => 0.0,
            };
            if found.is_none_or(|(most, _)| gain > most) {
                found = Some((gain, next));
            }
            next -= STEP;
        }
        let (a, b, r) = (first[row], second.map_or(0.0, |x| x[row]), residual[row]);
        for (sum, product) in sums.iter_mut().zip([a * a, a * b, b * b, a * r, b * r]) {
            *sum += product;
        }
    }
    found.map(|(_, from)| from)
}
