//! Constant torques that the background corrects and no finding names: small offsets of the sensors of most joints.

use std::collections::BTreeMap;

use arm::Joint;
use effects::background::OFFSET;
use effects::friction::FRICTION_ASYMMETRY;
use effects::sensor::TORQUE_OFFSET;
use effects::{Effect, Quantity, Term};

use crate::regression::strengths::PriorStrengths;
use crate::report::Parameter;
use crate::search::problem::Selection;
use crate::search::study::Study;
use crate::selection::bootstrap::Resampled;
use crate::thresholds::{FRICTION_PRIOR, LEAST_FINAL_SHARE, OFFSET_STRENGTHS, SYSTEMATIC, USUAL_CONSTANTS};

/// A constant below this share of the joint's typical torque is rounding, and not a correction.
const NEGLIGIBLE: f64 = 1e-6;

/// The joint whose constant torque a candidate names, for all times.
pub fn names(study: &Study, candidate: usize) -> Option<usize> {
    let hypothesis = study.candidates[candidate].hypothesis;
    let is_constant = hypothesis.is(&TORQUE_OFFSET) || hypothesis.is(&FRICTION_ASYMMETRY);
    let always = study.always_acts(candidate);
    study.candidates[candidate].joint.filter(|_| is_constant && always)
}

/// `selected` without those named constants that are better explained by small constants of all joints.
pub fn leave_to_background(study: &mut Study, mut selected: Selection) -> Selection {
    loop {
        let named: Vec<usize> = selected.set.iter().copied().filter(|&c| names(study, c).is_some()).collect();
        let mut best: Option<(PriorStrengths, Selection)> = None;
        for &member in &named {
            for offset in OFFSET_STRENGTHS.into_iter().filter(|&offset| offset > 0.0) {
                let others = selected.others(member);
                let strengths = PriorStrengths {
                    offset,
                    named_offsets: others.iter().filter_map(|&c| names(study, c)).collect(),
                    ..study.strengths.clone()
                };
                let products = study.products_at(&strengths);
                let problem = study.problem(&products);
                let next = problem.reweighted(problem.without(&selected, member));
                if is_unusual(study, member, offset, &next) {
                    continue;
                }
                let least = best.as_ref().map_or(selected.score, |(_, best)| best.score);
                if next.score < least - 1e-6 {
                    best = Some((strengths, next));
                }
            }
        }
        let Some((strengths, next)) = best else { return selected };
        study.strengths = strengths;
        study.note_strengths("constants of all joints in the place of a named one", &selected, &next);
        selected = next;
    }
}

/// Whether the constant torque that replaces the name of `member` in `next` is larger than those of a background at the strength
/// `offset`.
fn is_unusual(study: &Study, member: usize, offset: f64, next: &Selection) -> bool {
    let Some(joint) = names(study, member) else {
        return false;
    };
    let term = Term::on(&OFFSET, joint);
    let Some(column) = study.table.terms.iter().position(|other| *other == term) else {
        return false;
    };
    let usual = offset * FRICTION_PRIOR * study.data.scales.torque[joint];
    next.fit.coefficient(column).abs() > USUAL_CONSTANTS * usual
}

/// The constant torques in the fit `selected`, by the joints' names.
pub fn corrections(study: &Study, selected: &Selection, resampled: &Resampled) -> BTreeMap<String, Parameter> {
    let of = |(joint, described): (usize, &Joint)| {
        let offset = Term::on(&OFFSET, joint);
        let column = study.table.terms.iter().position(|term| *term == offset)?;
        if !selected.fit.columns.contains(&column) {
            return None;
        }
        let at = resampled.column(column)?;
        let (value, ci95) = resampled.interval_within(SYSTEMATIC, |draw| draw[at]);
        if value.abs() < NEGLIGIBLE * study.data.scales.torque[joint] {
            return None;
        }
        let unit = Quantity::Torque.unit(described.kind);
        Some((described.name.clone(), Parameter { value, ci95, unit }))
    };
    study.data.arm.joints().iter().enumerate().filter_map(of).collect()
}

/// The `corrections` that are large enough to be reported.
pub fn reported(study: &Study, corrections: &BTreeMap<String, Parameter>) -> BTreeMap<String, Parameter> {
    let of = |(joint, described): (usize, &Joint)| {
        let offset = corrections.get(&described.name)?;
        let is_reported = offset.value.abs() >= LEAST_FINAL_SHARE * study.data.scales.torque[joint];
        is_reported.then(|| (described.name.clone(), *offset))
    };
    study.data.arm.joints().iter().enumerate().filter_map(of).collect()
}

/// The effect that corrects the torque model by a constant.
pub fn effect((joint, offset): (&String, &Parameter)) -> Effect {
    Effect::of(&TORQUE_OFFSET).on(joint.clone()).with("offset", offset.value)
}
