//! Outside the catalogue: a torque within a band of positions only.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "dead_band_unknown",
    forms: &["gaussian"],
    draw: |bare, at, random| {
        at.other_and_phase(random);
        perhaps_in_form(bare, "gaussian", random)
            .with("amplitude", at.spread() * random.random_range(0.1..0.4) * sign(random))
            .with("center", at.home() + random.random_range(-0.1..0.1))
            .with("width", random.random_range(0.12..0.32))
    },
    read: |reader| {
        reader.on_link(Band {
            amplitude: reader.number("amplitude")?,
            center: reader.number("center")?,
            width: reader.number_above("width", 0.0)?,
            round: reader.form()? == 1,
        })
    },
    #[cfg(test)]
    example: |bare| bare.with("amplitude", 2.0).with("center", 0.2).with("width", 0.2),
    ..Fault::OUTSIDE_THE_CATALOGUE
};

/// A torque within a band of positions; `round` is a Gaussian instead of a plateau.
struct Band {
    amplitude: f64,
    center: f64,
    width: f64,
    round: bool,
}

impl LinkLaw for Band {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        let (q, center, width) = (at.position(), self.center, self.width);
        if self.round {
            return 2.0 * self.amplitude * (-0.5 * ((q - center) / (0.8 * width)).powi(2)).exp();
        }
        let edge = |x: f64| (x / 0.12).tanh();
        self.amplitude * (edge(q - center + width) - edge(q - center - width))
    }
}
