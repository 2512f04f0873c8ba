//! A factor between the torque that a drive reports and the true one.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "torque_scale",
    joints: EligibleJoints::LoadedJoints,
    may_have_onset: true,
    similar_faults: Some(SimilarFaults::Scales),
    draw: |bare, at, random| {
        let parts = if at.hard { 0.04..0.12 } else { 0.08..0.25 };
        bare.with("factor", at.factor(parts, 1.0, random))
    },
    read: |reader| Ok(vec![Property::Scale(reader.joint()?, reader.number_above("factor", 0.0)?).into()]),
    #[cfg(test)]
    example: |bare| bare.with("factor", 1.2),
    ..Fault::ON_A_JOINT
};
