//! The noise of the positions in the columns of simulated effects.

use effects::drive::JointElasticity;

use crate::data::statistics::mean;
use crate::search::candidate::Candidate;
use crate::search::study::Study;
use crate::thresholds::{BEYOND_NOISE, NOISE_BESIDE_LINKS, NOISE_OF_A_SPRING};

/// The variance of the noise in the first column of `candidate` on its joint, from that of the recorded positions (N² m² or N²).
pub fn noise(study: &Study, candidate: &Candidate, joint: usize) -> f64 {
    let data = &study.data;
    let mass = mean(data.rigid.iter().flat_map(|rigid| rigid.link_mass(joint)));
    let noises = data
        .motions
        .sources
        .iter()
        .zip(&data.fitted)
        .filter(|(_, fitted)| **fitted);
    let of_link = mean(noises.map(|(source, _)| (mass * source.acceleration_noise[joint]).powi(2)));
    let term = &study.table.terms[candidate.columns[0]];
    of_link
        * candidate
            .hypothesis
            .kind
            .get()
            .noise_gain(term, mass, data.motions.cutoff)
}

/// Whether `candidate`, with this evidence (nats), may be a spring that only filters the noise of the positions out of the link's inertial torque, in the held-out
/// recordings as well. A part of its column is then noise, and the evidence is not overwhelming.
pub fn may_be_noise(study: &Study, candidate: usize, evidence: f64) -> bool {
    let candidate = &study.candidates[candidate];
    let may_be = evidence < BEYOND_NOISE && candidate.hypothesis.is(&JointElasticity);
    let Some(joint) = candidate.joint.filter(|_| may_be) else {
        return false;
    };
    let place = study.table.place[joint][candidate.columns[0]];
    let column = place.map(|place| &study.table.joints[joint].x[place]);
    let variance = column.map_or(0.0, |column| {
        study.table.spread(joint, &study.data.fitted, column).powi(2)
    });
    let most = if study.strengths.common() > 0.0 {
        NOISE_BESIDE_LINKS
    } else {
        NOISE_OF_A_SPRING
    };
    noise(study, candidate, joint) > most * variance
}
