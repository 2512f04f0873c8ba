//! Viscous friction: a torque against the motion that is proportional to the speed or to another power of it. It is a
//! baseline effect, drawn for the background of a case and not as its fault.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "viscous_friction",
    forms: &["power"],
    form_parameters: &["exponent"],
    draw: |bare, at, random| bare.with("coefficient", coefficient(at.spread(), random)),
    read: |reader| {
        let exponent = reader.number_or("exponent", [1.0, 0.7][reader.form()?])?;
        let coefficient = reader.number("coefficient")?;
        reader.on_drive(Power { coefficient, exponent })
    },
    #[cfg(test)]
    example: |bare| bare.with("coefficient", 3.0),
    ..Fault::ON_A_JOINT
};

/// The baseline coefficient of a joint whose torque has the standard deviation `spread` (N m or N).
pub(crate) fn coefficient(spread: f64, random: &mut ChaCha8Rng) -> f64 {
    spread * log_uniform(0.1, 0.5, random)
}

/// The torque coefficient sgn(v) |v|^exponent.
pub(super) struct Power {
    pub coefficient: f64,
    pub exponent: f64,
}

impl DriveLaw for Power {
    fn torque(&self, _: f64, v: f64) -> f64 {
        let size = if self.exponent == 1.0 { v.abs() } else { v.abs().powf(self.exponent) };
        self.coefficient * v.signum() * size
    }
}
