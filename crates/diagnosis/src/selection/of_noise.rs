//! The noise of the positions in the columns of simulated effects.

use crate::data::statistics::{mean, mean_square};
use crate::search::candidate::Candidate;
use crate::search::study::Study;
use crate::thresholds::{BEYOND_NOISE, MUCH_NOISE, NOISE_OF_A_BASE, NOISE_OF_A_SPRING};

/// The variance of the noise in the first column of `candidate` on its joint, from that of the recorded positions (N² m² or N²). The spring
/// carries the whole torque of the link, to which the accelerations of all joints contribute.
pub fn noise(study: &Study, candidate: &Candidate, joint: usize) -> f64 {
    let data = &study.data;
    let mass = mean(data.rigid.iter().flat_map(|rigid| rigid.link_mass(joint)));
    let term = &study.table.terms[candidate.columns[0]];
    let gain = (candidate.hypothesis.spec().noise_gain)(term, mass, data.motions.cutoff);
    if gain == 0.0 { 0.0 } else { gain * of_link(study, joint) }
}

/// The variance of the noise in the torque of the link of `joint` (N² m² or N²), to which the accelerations of all joints contribute.
fn of_link(study: &Study, joint: usize) -> f64 {
    let data = &study.data;
    let fitted = data.motions.sources.iter().zip(&data.fitted);
    let sources: Vec<_> = fitted.filter(|(_, fitted)| **fitted).map(|(source, _)| source).collect();
    let by = |by: usize| {
        let acceleration = mean_square(sources.iter().map(|source| source.acceleration_noise[by]));
        acceleration * mean_square(data.rigid.iter().flat_map(|rigid| rigid.coupled_mass(joint, by)))
    };
    (0..data.motions.dof).map(by).sum()
}

/// Whether a swaying base, with these `shares` of the joints' torques, may only filter the noise of the positions out of the torques of the
/// links: on no joint, it is clearly larger than that noise.
pub fn may_be_noise_of_base(study: &Study, candidate: usize, shares: &[f64]) -> bool {
    let is_of_base = |&column: &usize| study.table.terms[column].law.is_of_base;
    let stands_out = |(joint, share): (usize, &f64)| {
        share * study.data.scales.torque[joint] > NOISE_OF_A_BASE * of_link(study, joint).sqrt()
    };
    study.candidates[candidate].columns.iter().all(is_of_base) && !shares.iter().enumerate().any(stands_out)
}

/// Whether `candidate`, with this evidence (nats), may only filter the noise of the positions out of the torque of the link, as a spring and
/// the compliant ends of a gap do. Held-out recordings do not show it, because they have the same noise. Overwhelming evidence suffices
/// nevertheless, unless much of its column is noise.
pub fn may_be_noise(study: &Study, candidate: usize, evidence: f64) -> bool {
    let candidate = &study.candidates[candidate];
    let Some(joint) = candidate.joint.filter(|_| candidate.hypothesis.spec().is_simulated) else {
        return false;
    };
    let place = study.table.place[joint][candidate.columns[0]];
    let column = place.map(|place| &study.table.joints[joint].x[place]);
    let variance = column.map_or(0.0, |column| study.table.spread(joint, &study.data.fitted, column).powi(2));
    let most = if evidence < BEYOND_NOISE { NOISE_OF_A_SPRING } else { MUCH_NOISE };
    noise(study, candidate, joint) > most * variance
}
