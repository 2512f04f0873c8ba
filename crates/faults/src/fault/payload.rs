//! A mass at the tool that the URDF does not have; or, if negative, one that only the URDF has.

use super::inertial_parameters::tensor;
use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "payload",
    // A known one and one that a diagnosis has found in addition are two.
    may_repeat: true,
    may_have_onset: true,
    draw: |bare, at, random| {
        let mass = at.load() * random.random_range(0.25..if at.hard { 0.8 } else { 1.6 });
        let mut across = || random.random_range(-0.03..0.03);
        let com = [across(), across(), random.random_range(0.03..0.16)];
        let moment = 0.4 * mass * 0.04 * 0.04;
        // A tool that is drawn in the URDF and not mounted is a negative payload.
        let sign = if at.lifelike && random.random_bool(0.5) { -1.0 } else { 1.0 };
        bare.with("mass", sign * mass)
            .with("com", json!(com))
            .with("inertia", json!([moment, 0.0, moment, 0.0, 0.0, moment].map(|moment| sign * moment)))
    },
    read: |reader| {
        let mass = reader.number("mass")?;
        let sign = if mass < 0.0 { -1.0 } else { 1.0 };
        let payload =
            Inertia { mass: sign * mass, com: Vector3::from(reader.numbers("com")?), tensor: tensor(reader)? * sign };
        let body = Property::Body(Body::Payload(payload));
        if mass >= 0.0 {
            return Ok(vec![body.into()]);
        }
        if reader.injected.onset.is_some() {
            return Err(reader.fail("a tool that is not mounted has no onset; leave that line out".into()));
        }
        Ok(vec![body.only_without_fault()])
    },
    #[cfg(test)]
    example: |bare| bare.with("mass", 1.5).with("com", json!([0.01, 0.0, 0.08])),
    ..Fault::ON_THE_ARM
};
