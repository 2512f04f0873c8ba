//! Constant torques that the background corrects and no finding names: small offsets of the sensors of most joints.

use std::collections::BTreeMap;

use effects::background::OFFSET;
use effects::friction::FrictionAsymmetry;
use effects::sensor::TorqueOffset;
use effects::{Effect, Quantity, Term};

use crate::report::Parameter;
use crate::search::problem::Selection;
use crate::search::study::Study;
use crate::selection::bootstrap::Resampled;
use crate::thresholds::{LEAST_FINAL_SHARE, SYSTEMATIC};

/// The joint whose constant torque a candidate names, for all times.
pub fn names(study: &Study, candidate: usize) -> Option<usize> {
    let hypothesis = study.candidates[candidate].hypothesis;
    let is_constant = hypothesis.is(&TorqueOffset) || hypothesis.is(&FrictionAsymmetry);
    let always = study.terms(candidate).iter().all(|term| term.onset().is_none());
    study.candidates[candidate].joint.filter(|_| is_constant && always)
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
