//! Outside the catalogue: a torque that is periodic in time.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "time_periodic_unknown",
    forms: &["rounded square"],
    draw: |bare, at, random| {
        let (_, phase) = at.other_and_phase(random);
        perhaps_in_form(bare, "rounded square", random)
            .with("amplitude", at.spread() * random.random_range(0.15..0.5))
            .with("hz", random.random_range(0.6..3.5))
            .with("phase", phase)
    },
    read: |reader| {
        reader.on_link(Periodic {
            amplitude: reader.number("amplitude")?,
            hertz: reader.number("hz")?,
            phase: reader.number("phase")?,
            edge: [0.0, 3.0][reader.form()?],
        })
    },
    #[cfg(test)]
    example: |bare| bare.with("amplitude", 2.0).with("hz", 1.0).with("phase", 0.3),
    ..Fault::OUTSIDE_THE_CATALOGUE
};

/// A periodic torque; a sine for `edge` 0, and closer to a square wave for larger values.
struct Periodic {
    amplitude: f64,
    hertz: f64,
    phase: f64,
    edge: f64,
}

impl LinkLaw for Periodic {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        let wave = (TAU * self.hertz * at.time + self.phase).sin();
        self.amplitude * if self.edge > 0.0 { (self.edge * wave).tanh() } else { wave }
    }
}
