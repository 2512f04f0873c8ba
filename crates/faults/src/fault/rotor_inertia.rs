//! The inertia of a drive, reflected to its joint, which the URDF omits.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "rotor_inertia",
    can_be_on: |robot| !robot.has_rotors(),
    draw: |bare, at, random| bare.with("inertia", at.link_inertia() * random.random_range(0.15..0.8)),
    size: Size::Times(&["inertia"]),
    read: |reader| {
        let body = Body::Rotor(reader.joint()?, reader.at_least_zero("inertia")?);
        Ok(vec![Property::Body(body).into()])
    },
    #[cfg(test)]
    example: |bare| bare.with("inertia", 0.2),
    ..Fault::ON_A_JOINT
};
