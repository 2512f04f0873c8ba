//! A base that is not mounted upright.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "gravity_misalignment",
    draw: |bare, at, random| {
        let (sin, cos) = random.random_range(0.0..TAU).sin_cos();
        let angles = if at.hard { 0.01..0.05 } else { 0.02..0.12 };
        bare.with("angle", random.random_range(angles)).with("axis", json!([cos, sin, 0.0]))
    },
    read: |reader| {
        let axis = Vector3::from(reader.numbers("axis")?);
        if axis.norm() == 0.0 {
            return Err(reader.fail("its axis has no length".into()));
        }
        let angle = reader.number("angle")?;
        Ok(vec![Body::changed(move |arm| arm.with_turned_base(axis, angle))])
    },
    #[cfg(test)]
    example: |bare| bare.with("angle", 0.1).with("axis", json!([0.0, 1.0, 0.0])),
    ..Fault::ON_THE_ARM
};
