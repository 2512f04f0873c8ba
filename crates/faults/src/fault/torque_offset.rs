//! A constant torque on a joint, such as a sensor's zero offset or the spring of a brake.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "torque_offset",
    is_constant: true,
    may_have_onset: true,
    draw: |bare, at, random| bare.with("offset", at.spread() * random.random_range(0.1..0.5) * sign(random)),
    size: Size::Times(&["offset"]),
    read: |reader| reader.on_drive(Offset(reader.number("offset")?)),
    #[cfg(test)]
    example: |bare| bare.with("offset", 2.0),
    ..Fault::ON_A_JOINT
};

/// A constant torque (N m or N).
struct Offset(f64);

impl DriveLaw for Offset {
    fn torque(&self, _: f64, _: f64) -> f64 {
        self.0
    }
}
