//! A mass at the tool that the URDF does not know.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "payload",
    sets_in: true,
    draw: |bare, at, random| {
        let mass = at.load() * random.random_range(0.25..if at.hard { 0.8 } else { 1.6 });
        let mut across = || random.random_range(-0.03..0.03);
        let com = [across(), across(), random.random_range(0.03..0.16)];
        let moment = 0.4 * mass * 0.04 * 0.04;
        bare.with("mass", mass)
            .with("com", json!(com))
            .with("inertia", json!([moment, 0.0, moment, 0.0, 0.0, moment]))
    },
    read: |reader| {
        let inertia = if reader.given("inertia") {
            reader.numbers("inertia")?
        } else {
            [0.0; 6]
        };
        let [xx, xy, yy, xz, yz, zz] = inertia;
        let payload = Inertia {
            mass: reader.at_least_zero("mass")?,
            com: Vector3::from(reader.numbers("com")?),
            tensor: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        };
        Ok(vec![What::Body(Body::Payload(payload)).into()])
    },
    #[cfg(test)]
    example: |bare| bare.with("mass", 1.5).with("com", json!([0.01, 0.0, 0.08])),
    ..Fault::ON_THE_ARM
};
