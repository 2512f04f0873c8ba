//! Constant torques that the background corrects and no finding names: small offsets of the sensors of most joints.

use std::collections::BTreeMap;

use effects::background::OFFSET;
use effects::friction::FrictionAsymmetry;
use effects::sensor::TorqueOffset;
use effects::{Effect, Quantity, Term};

use crate::regression::strengths::Strengths;
use crate::report::Parameter;
use crate::search::problem::Selection;
use crate::search::study::Study;
use crate::selection::bootstrap::Resampled;
use crate::thresholds::{LEAST_FINAL_SHARE, OFFSET_STRENGTHS, SYSTEMATIC};

/// The joint whose constant torque a candidate names, for all times.
pub fn names(study: &Study, candidate: usize) -> Option<usize> {
    let hypothesis = study.candidates[candidate].hypothesis;
    let is_constant = hypothesis.is(&TorqueOffset) || hypothesis.is(&FrictionAsymmetry);
    let always = study.terms(candidate).iter().all(|term| term.onset().is_none());
    study.candidates[candidate].joint.filter(|_| is_constant && always)
}

/// `chosen` without those named constants that are better explained by small constants of all joints.
pub fn leave_to_background(study: &mut Study, mut chosen: Selection) -> Selection {
    loop {
        let named: Vec<usize> = chosen
            .set
            .iter()
            .copied()
            .filter(|&c| names(study, c).is_some())
            .collect();
        let mut best: Option<(Strengths, Selection)> = None;
        for &member in &named {
            for offset in OFFSET_STRENGTHS.into_iter().filter(|&offset| offset > 0.0) {
                let set = chosen.others(member);
                let strengths = Strengths {
                    offset,
                    named_offsets: set.iter().filter_map(|&c| names(study, c)).collect(),
                    ..study.strengths.clone()
                };
                let products = study.products_at(&strengths);
                let problem = study.problem(&products);
                let next = problem.reweighted(problem.choose(set, &chosen.fit.weights));
                let least = best.as_ref().map_or(chosen.score, |(_, best)| best.score);
                if next.score < least - 1e-6 {
                    best = Some((strengths, next));
                }
            }
        }
        let Some((strengths, next)) = best else { return chosen };
        study.strengths = strengths;
        study.note_strengths("constants of all joints in the place of a named one", &chosen, &next);
        chosen = next;
    }
}

/// The constant torques in the fit `chosen`, each with the joint on which it acts.
pub fn corrections(study: &Study, chosen: &Selection, resampled: &Resampled) -> Vec<(usize, Parameter)> {
    let of = |joint: usize| {
        let offset = Term::on(&OFFSET, joint);
        let column = study.table.terms.iter().position(|term| *term == offset)?;
        if !chosen.fit.columns.contains(&column) {
            return None;
        }
        let at = resampled.column(column)?;
        let (value, ci95) = resampled.interval_within(SYSTEMATIC, |draw| draw[at]);
        let unit = Quantity::Torque.unit(study.arm.joints()[joint].kind);
        Some((joint, Parameter { value, ci95, unit }))
    };
    (0..study.motions.dof).filter_map(of).collect()
}

/// Those that are large enough to be told.
pub fn told(study: &Study, corrections: &[(usize, Parameter)]) -> Vec<(usize, Parameter)> {
    let is_told =
        |(joint, offset): &&(usize, Parameter)| offset.value.abs() >= LEAST_FINAL_SHARE * study.scales.torque[*joint];
    corrections.iter().filter(is_told).copied().collect()
}

/// The effects that correct the torque model by these constants.
pub fn effects(study: &Study, corrections: &[(usize, Parameter)]) -> Vec<Effect> {
    let effect = |(joint, offset): &(usize, Parameter)| {
        let name = study.arm.joints()[*joint].name.clone();
        Effect::of(&TorqueOffset).on(name).with("offset", offset.value)
    };
    corrections.iter().map(effect).collect()
}

/// These constants by the joints' names.
pub fn by_joint(study: &Study, corrections: Vec<(usize, Parameter)>) -> BTreeMap<String, Parameter> {
    let name = |joint: usize| study.arm.joints()[joint].name.clone();
    corrections
        .into_iter()
        .map(|(joint, offset)| (name(joint), offset))
        .collect()
}
