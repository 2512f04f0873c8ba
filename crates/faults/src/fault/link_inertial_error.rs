//! A link whose mass and inertia are another part of what the URDF says.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "link_inertial_error",
    place: Place::OuterJoints,
    draw: |bare, at, random| {
        let part = random.random_range(if at.hard { 0.08..0.4 } else { 0.12..0.4 });
        bare.with("relative", part * sign(random))
    },
    read: |reader| {
        let (joint, factor) = (reader.joint()?, 1.0 + reader.above("relative", -1.0)?);
        Ok(vec![Body::changed(move |arm| arm.with_scaled_link(joint, factor))])
    },
    #[cfg(test)]
    example: |bare| bare.with("relative", 0.3),
    ..Fault::ON_A_JOINT
};
