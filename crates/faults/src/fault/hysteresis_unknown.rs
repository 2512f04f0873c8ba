//! Outside the catalogue: hysteresis in position.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "hysteresis_unknown",
    forms: &["sharp"],
    draw: |bare, at, random| {
        at.other_and_phase(random);
        perhaps_in_form(bare, "sharp", random)
            .with("amplitude", at.spread() * random.random_range(0.15..0.4))
            .with("scale", random.random_range(0.08..0.25))
            .with("shape", random.random_range(0.5..0.9))
    },
    read: |reader| {
        reader.on_link(Hysteresis {
            amplitude: reader.number("amplitude")?,
            scale: reader.number_above("scale", 0.0)?,
            shape: reader.number("shape")?,
            sharpness: [1, 2][reader.form()?],
        })
    },
    #[cfg(test)]
    example: |bare| bare.with("amplitude", 2.0).with("scale", 0.1).with("shape", 0.6),
    ..Fault::OUTSIDE_THE_CATALOGUE
};

/// Hysteresis in position (Bouc 1967, Wen 1976): slope 1/scale, `shape` 0.5 to 1, sharpness 1 or 2.
struct Hysteresis {
    amplitude: f64,
    scale: f64,
    shape: f64,
    sharpness: i32,
}

impl LinkLaw for Hysteresis {
    fn torque(&self, at: At<'_>, state: &mut f64, step: f64) -> f64 {
        let (z, v) = (*state, at.velocity());
        let bound = z.abs().powi(self.sharpness) * (self.shape * (v * z).signum() + (1.0 - self.shape));
        *state = (z + step * v / self.scale * (1.0 - bound)).clamp(-1.5, 1.5);
        self.amplitude * *state
    }
}
