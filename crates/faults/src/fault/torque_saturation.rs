//! The largest torque that a drive applies, below the commanded one.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "torque_saturation",
    forms: &["soft"],
    joints: EligibleJoints::InnerJoints,
    similar_faults: Some(SimilarFaults::BetweenCommandAndLink),
    draw: |bare, at, random| {
        let reached = random.random_range(if at.hard { 0.9..0.98 } else { 0.8..0.95 });
        let soft = at.hard && random.random_bool(0.5);
        let torques = at.torques();
        let place = (reached * torques.len() as f64) as usize;
        let limit = torques.get(place.min(torques.len().saturating_sub(1)));
        let bare = if soft { bare.formed("soft") } else { bare };
        bare.with("limit", limit.copied().unwrap_or(at.spread()))
    },
    read: |reader| {
        let (joint, limit) = (reader.joint()?, reader.number_above("limit", 0.0)?);
        Ok(vec![Property::Limit(joint, limit, reader.form()? == 1).into()])
    },
    #[cfg(test)]
    example: |mut bare| {
        bare.joint = Some("axis1".to_owned());
        bare.with("limit", 2.5)
    },
    ..Fault::ON_A_JOINT
};
