//! Removal of effects that do not predict recordings they were not fitted to.

use effects::Acts;
use rayon::prelude::*;

use super::{HARMS, harms, is_idle};
use crate::regression::fit::Products;
use crate::search::problem::{Problem, Selection};

/// `selected` without the unmodelled forms that do not predict recordings they were not fitted to. They may have replaced simple
/// effects, which are then searched again.
pub fn predicting(problem: &Problem<'_>, held: &Products, mut selected: Selection) -> Selection {
    let hypothesis = |c: usize| problem.candidates[c].hypothesis;
    let loss = |selected: &Selection| held.loss_of(problem.table, &selected.fit);
    let simple: Vec<usize> = (0..problem.candidates.len())
        .filter(|&c| {
            hypothesis(c).spec().is_baseline_or_constant && problem.acts(&problem.candidates[c]) == Acts::Always
        })
        .collect();
    loop {
        let with = loss(&selected);
        let worst = selected
            .set
            .par_iter()
            .filter(|&&c| hypothesis(c).name().is_none() && !hypothesis(c).spec().may_be_in_one_recording)
            .map(|&c| {
                let set: Vec<usize> = selected.others(c);
                let rest = problem.forward(problem.choose(set, &selected.fit.weights), &simple);
                let (outside, inside) = (loss(&rest) - with, rest.fit.loss - selected.fit.loss);
                let on = problem.candidates[c].joint.map_or(0..held.evidence.len(), |joint| joint..joint + 1);
                let evidence = |products: &Products| products.evidence[on.clone()].iter().sum::<f64>();
                let length = evidence(held) / evidence(problem.products).max(1e-9);
                (outside - problem.thresholds.held_out * length * inside, rest)
            })
            .collect::<Vec<_>>()
            .into_iter()
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match worst {
            Some((gain, rest)) if gain < 0.0 => selected = rest,
            _ => return selected,
        }
    }
}

/// The effect whose removal improves the prediction of the held-out recordings most, with the rule that removes it. `None` if no removal
/// improves it, and no joint is predicted worse than by the nominal model.
pub fn harmful(problem: &Problem<'_>, held: &Products, selected: &Selection) -> Option<(&'static str, usize)> {
    let table = problem.table;
    let rss = |selected: &Selection| held.rss(table, &selected.fit.columns, &selected.fit.coefficients);
    let with = rss(selected);
    // The increase of the held-out loss without each.
    let gains: Vec<(usize, f64, Vec<f64>)> = (0..selected.set.len())
        .into_par_iter()
        .map(|k| {
            let mut set = selected.set.clone();
            let removed = set.remove(k);
            let rest = problem.choose(set, &selected.fit.weights);
            let [with, without] = [&selected.fit, &rest.fit].map(|fit| problem.held_out_rss(held, removed, fit));
            // An effect passes if it improves the prediction of all joints together, or of the joints on which it acts. On the other
            // joints, only the background changes.
            let this = &problem.candidates[removed];
            let acts = |joint: usize| this.columns.iter().any(|&column| table.place[joint][column].is_some());
            let lost = |joint| held.joint_loss(joint, without[joint]) - held.joint_loss(joint, with[joint]);
            let there: f64 = (0..with.len()).filter(|&joint| acts(joint)).map(lost).sum();
            let mut gain = there.max(held.loss(&without) - held.loss(&with));
            // What moves the link against its drive also moves the links beyond it. On their small torques, a slight error of its size
            // may weigh more than what it explains on its own joint.
            if let Some(joint) = this.joint.filter(|_| this.hypothesis.spec().is_simulated) {
                gain = gain.max(lost(joint));
            }
            // The background in its place predicts as well, but costs more evidence. Friction and the inertia of the drive are present in
            // every joint, so that all recordings decide on them.
            let is_everywhere = this.hypothesis.spec().is_friction || this.hypothesis.is_drive_inertia();
            if problem.is_background_too(this) || is_everywhere {
                gain += rest.score - selected.score;
            }
            (removed, gain, rss(&rest))
        })
        .collect();
    let exempt = |candidate: usize| {
        problem.candidates[candidate].window(table).is_some() || is_idle(problem, selected, candidate)
    };
    let useless = gains
        .iter()
        .filter(|(candidate, gain, _)| !exempt(*candidate) && *gain < 0.0)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let increasing = || {
        let joint = (0..with.len()).find(|&joint| {
            let n = held.count[joint].max(1.0);
            let spread = problem.data.scales.torque[joint].max(1e-300);
            let (nominal, with) = (held.power(joint).sqrt() / spread, (with[joint] / n).sqrt() / spread);
            held.count[joint] > 0.0 && harms(nominal, with)
        })?;
        gains
            .iter()
            .filter(|(candidate, _, without)| {
                // An effect on all joints is judged by the likelihood of all joints. An effect that does not act on this joint is
                // not judged by this joint's error: its reason may be the background, which the final fit reduces.
                let this = &problem.candidates[*candidate];
                let acts = this.columns.iter().any(|&column| table.place[joint][column].is_some());
                this.joint.is_some() && acts && without[joint] < with[joint]
            })
            .min_by(|a, b| a.2[joint].total_cmp(&b.2[joint]))
    };
    match useless {
        Some(&(bad, ..)) => Some(("held-out recordings are more likely without it", bad)),
        None => increasing().map(|&(bad, ..)| (HARMS, bad)),
    }
}
