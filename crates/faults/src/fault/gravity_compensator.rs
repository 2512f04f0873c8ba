//! The counterbalance of a heavy joint: a spring between a fixed anchor and the end of a lever on the link. Campaigns do
//! not draw it; it is injected by name.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "gravity_compensator",
    forms: &["free length"],
    form_parameters: &["free_length"],
    size: Size::Times(&["amplitude"]),
    is_drawn: false,
    read: |reader| {
        reader.on_link(Counterbalance {
            stiffness: reader.number("amplitude")? / LEVER,
            angle: reader.number("angle")?,
            free_length: reader.number_or("free_length", [0.0, 0.5][reader.form()?])?,
        })
    },
    #[cfg(test)]
    example: |bare| bare.with("amplitude", 10.0).with("angle", 0.2),
    ..Fault::ON_A_JOINT
};

/// The length of the lever, relative to the distance of the anchor from the axis.
const LEVER: f64 = 0.3;

/// The amplitude is that of a spring with zero free length: stiffness times lever times the anchor's distance.
struct Counterbalance {
    stiffness: f64,
    angle: f64,
    free_length: f64,
}

impl LinkLaw for Counterbalance {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        let (sin, cos) = (at.position() - self.angle).sin_cos();
        let end = Vector3::new(LEVER * cos, LEVER * sin, 0.0);
        let spring = Vector3::x() - end;
        let length = spring.norm();
        let pull = spring * (self.stiffness * (length - self.free_length) / length);
        // The torque of the spring relieves the drive.
        -end.cross(&pull).z
    }
}
