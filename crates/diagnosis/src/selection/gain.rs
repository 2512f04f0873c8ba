//! How much an effect reduces the error on recordings, or pieces of them, that it was not fitted to.

use effects::Acts;
use rayon::prelude::*;

use crate::regression::fit::{Fit, Products};
use crate::search::problem::Problem;
use crate::search::scan::contact_gain;
use crate::selection::held_out_friction::{best_factor, is_other};
use crate::selection::judge::{Judged, Member, is_idle};
use crate::thresholds::{AS_WELL, CLEAR_DRIVE, GAIN_PIECE, LEAST_OF_HALF, POWER_PIECES};

/// The member of `judged` that helps least on recordings that it was not fitted to, if it does not help at all.
pub fn useless(problem: &Problem<'_>, held: &Products, judged: &Judged) -> Option<usize> {
    let gains: Vec<(f64, usize)> = judged
        .members
        .par_iter()
        .filter_map(|member| {
            let gain = held_out_gain(problem, Some(held), judged, member)?;
            // The background predicts nearly as well without the effect, but costs more evidence.
            let allowed = if problem.is_background_too(&problem.candidates[member.candidate]) { AS_WELL } else { 0.0 };
            Some((gain + allowed, member.candidate))
        })
        .collect();
    let least = gains.into_iter().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
    (least.0 <= 0.0).then_some(least.1)
}

/// The relative reduction of the NRMSE by the finding on recordings that it was not fitted to, on the joint where it is
/// largest; `None` if that joint does not move in them. A contact is in one recording only: its force is fitted to every other
/// piece of its window and tested on the rest.
pub fn held_out_gain(problem: &Problem<'_>, held: Option<&Products>, judged: &Judged, member: &Member) -> Option<f64> {
    let (data, table) = (problem.data, problem.table);
    let without = problem.choose(judged.named.others(member.candidate), &judged.named.fit.weights);
    let candidate = &problem.candidates[member.candidate];
    if candidate.window(table).is_some() {
        return Some(contact_gain(data, table, &without.fit, &candidate.columns));
    }
    let joint = member.place();
    let held = held?;
    if is_idle(problem, &judged.named, member.candidate) {
        let fit = &judged.named.fit;
        let gain = |without: &Fit| gain_in_pieces(problem, fit, without, member.candidate, joint);
        let refitted = gain(&without.fit);
        // In a refit, each recording may have a friction of its own, which is no name for friction that fell since those from before.
        let is_past = matches!(problem.acts(candidate), Acts::Until(_));
        return Some(if is_past && candidate.hypothesis.spec().is_friction {
            let mut bare = fit.clone();
            let own = bare.columns.iter().zip(&mut bare.coefficients);
            own.filter(|(column, _)| candidate.columns.contains(column)).for_each(|(_, value)| *value = 0.0);
            refitted.max(gain(&bare))
        } else {
            refitted
        });
    }
    let fit = &judged.named.fit;
    let [with, of_others] = [fit, &without.fit].map(|fit| problem.held_out_rss(held, member.candidate, fit));
    let gain = |without: &[f64]| 1.0 - (with[joint].max(0.0) / without[joint].max(1e-300)).sqrt();
    let mut gains = vec![gain(&of_others)];
    let spec = candidate.hypothesis.spec();
    if spec.is_friction || spec.is_form_of_friction() {
        // If all friction of the joint is less in the held-out recordings, they are predicted better without a part of it.
        let (factor, with) = best_factor(problem, held, &judged.named.set, fit, joint);
        if is_other(factor) {
            let (_, without) = best_factor(problem, held, &without.set, &without.fit, joint);
            gains.push(1.0 - (with / without.max(1e-300)).sqrt());
        }
    }
    // Every drive has friction, and most have a rotor: they also count as useful if the fit without refitting predicts
    // worse without them. In a refit, the inertial parameters may change by more than the friction of a joint with a large
    // load.
    let hypothesis = candidate.hypothesis;
    if hypothesis.spec().is_friction || hypothesis.is_drive_inertia() && member.evidence >= CLEAR_DRIVE {
        let of_others = |column: &usize| !candidate.columns.contains(column);
        let (columns, values): (Vec<usize>, Vec<f64>) = fit
            .columns
            .iter()
            .copied()
            .zip(fit.coefficients.iter().copied())
            .filter(|(column, _)| of_others(column))
            .unzip();
        gains.push(gain(&held.rss(table, &columns, &values)));
    }
    (held.count[joint] > 0.0).then(|| gains.into_iter().fold(f64::MIN, f64::max))
}

/// The relative reduction of the error on `joint` by `candidate` where it was not fitted: its torque is scaled to the residual
/// `without` it in every other piece of the training recordings, and tested on the rest.
fn gain_in_pieces(problem: &Problem<'_>, fit: &Fit, without: &Fit, candidate: usize, joint: usize) -> f64 {
    let (data, table) = (problem.data, problem.table);
    let columns = &problem.candidates[candidate].columns;
    let torque = table.torque(joint, columns, &fit.values(columns));
    let residual = table.residual(joint, &without.columns, &without.coefficients);
    let rows = table.moving_rows(joint, &data.fitted);
    let is_odd = odd_pieces(&data.motions.row_times(), data.motions.begins, &rows, &torque);
    let (mut with, mut bare) = (0.0, 0.0);
    for fitted in [false, true] {
        let (mut power, mut product) = (0.0, 0.0);
        for (&row, _) in rows.iter().zip(&is_odd).filter(|(_, odd)| **odd == fitted) {
            power += torque[row] * torque[row];
            product += torque[row] * residual[row];
        }
        let scale = product / f64::max(power, 1e-300);
        for (&row, _) in rows.iter().zip(&is_odd).filter(|(_, odd)| **odd != fitted) {
            with += (residual[row] - scale * torque[row]).powi(2);
            bare += residual[row].powi(2);
        }
    }
    1.0 - (with / f64::max(bare, 1e-300)).sqrt()
}

/// Whether each of the `rows` is in an odd piece. Pieces are [`GAIN_PIECE`] long; where the effect with this `torque` acts for so
/// short a time that every other piece would hold hardly any of it, they hold equal parts of its power instead.
fn odd_pieces(times: &[f64], begins: f64, rows: &[usize], torque: &[f64]) -> Vec<bool> {
    let power = |row: usize| torque[row] * torque[row];
    let all: f64 = rows.iter().map(|&row| power(row)).sum();
    let in_time = |&row: &usize| ((times[row] - begins) / GAIN_PIECE).floor() as i64 % 2 != 0;
    let odd: f64 = rows.iter().filter(|row| in_time(row)).map(|&row| power(row)).sum();
    if odd.min(all - odd) >= LEAST_OF_HALF * all {
        return rows.iter().map(in_time).collect();
    }
    let mut before = 0.0;
    let in_power = |&row: &usize| {
        let piece = (POWER_PIECES * before / all).floor();
        before += power(row);
        piece as i64 % 2 != 0
    };
    rows.iter().map(in_power).collect()
}
