//! Outside the catalogue: a torque that is a product of velocity and position.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "multiplicative_unknown",
    forms: &["speed times position"],
    draw: |bare, at, random| {
        let (_, phase) = at.other_and_phase(random);
        let bare = perhaps_in_form(bare, "speed times position", random);
        let center = at.home() + random.random_range(-0.3..0.3);
        let phase = if bare.form.is_some() { center } else { phase };
        bare.with("amplitude", at.spread() * random.random_range(0.2..0.6))
            .with("rate", random.random_range(2.5..6.0))
            .with("phase", phase)
    },
    read: |reader| {
        let (amplitude, phase) = (reader.number("amplitude")?, reader.number("phase")?);
        match reader.form()? {
            0 => reader.on_link(VelocityWave { amplitude, rate: reader.number("rate")?, phase }),
            _ => reader.on_link(SpeedPosition { amplitude, center: phase }),
        }
    },
    #[cfg(test)]
    example: |bare| bare.with("amplitude", 2.0).with("rate", 4.0).with("phase", 0.3),
    ..Fault::OUTSIDE_THE_CATALOGUE
};

/// Velocity times a wave of position.
struct VelocityWave {
    amplitude: f64,
    rate: f64,
    phase: f64,
}

impl LinkLaw for VelocityWave {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        self.amplitude * at.velocity() * (self.rate * at.position() + self.phase).sin()
    }
}

/// Speed times position.
struct SpeedPosition {
    amplitude: f64,
    center: f64,
}

impl LinkLaw for SpeedPosition {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        self.amplitude * at.velocity().abs() * (at.position() - self.center)
    }
}
