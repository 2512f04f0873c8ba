//! An encoder whose zero differs from that of the joint.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "encoder_offset",
    joints: EligibleJoints::InnerJoints,
    draw: |bare, at, random| {
        let size = random.random_range(if at.hard { 0.008..0.05 } else { 0.015..0.06 });
        bare.with("offset", size * sign(random))
    },
    read: |reader| Ok(vec![Property::Encoder(reader.joint()?, reader.number("offset")?).into()]),
    #[cfg(test)]
    example: |bare| bare.with("offset", 0.05),
    ..Fault::ON_A_JOINT
};
