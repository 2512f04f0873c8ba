//! Outside the catalogue: a torque that depends on another joint's position.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "cross_coupling_unknown",
    forms: &["step"],
    can_be_on: has_another_joint,
    draw: |bare, at, random| {
        let (other, phase) = at.other_and_phase(random);
        let robot = at.robot;
        let near = robot.arm().joints().iter().position(|joint| joint.name == other);
        let center = near.map_or(0.0, |o| robot.home()[o]) + random.random_range(-0.3..0.3);
        let bare = perhaps_in_form(bare, "step", random);
        let phase = if bare.form.is_some() { center } else { phase };
        bare.with("amplitude", at.spread() * random.random_range(0.2..0.5))
            .with("other", other)
            .with("rate", random.random_range(3.0..7.0))
            .with("phase", phase)
    },
    read: |reader| {
        let (amplitude, other) = (reader.number("amplitude")?, reader.other()?);
        let (rate, phase) = (reader.number("rate")?, reader.number("phase")?);
        match reader.form()? {
            0 => reader.on_link(Wave { amplitude, other, rate, phase }),
            _ => reader.on_link(Step { amplitude, other, rate, center: phase }),
        }
    },
    #[cfg(test)]
    example: |bare| bare.with("amplitude", 2.0).with("rate", 4.0).with("phase", 0.3).with("other", "axis5"),
    ..Fault::OUTSIDE_THE_CATALOGUE
};

/// A wave along another joint's position.
struct Wave {
    amplitude: f64,
    other: usize,
    rate: f64,
    phase: f64,
}

impl LinkLaw for Wave {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        self.amplitude * (self.rate * at.q[self.other] + self.phase).sin()
    }
}

/// A step along another joint's position, which acts where this joint is near zero.
struct Step {
    amplitude: f64,
    other: usize,
    rate: f64,
    center: f64,
}

impl LinkLaw for Step {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        self.amplitude * (self.rate * (at.q[self.other] - self.center)).tanh() * at.position().cos()
    }
}
