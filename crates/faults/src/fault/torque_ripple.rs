//! A periodic function of the joint's position, such as cogging and gear errors.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "torque_ripple",
    forms: &["second harmonic"],
    form_parameters: &["second"],
    may_repeat: true,
    draw: |bare, at, random| {
        let second = random.random_range(0.3..0.6);
        let ripple = bare
            .with("amplitude", at.spread() * random.random_range(0.05..0.3))
            .with("periods", f64::from(random.random_range(14_u8..41)))
            .with("phase", random.random_range(0.0..TAU));
        if at.hard { ripple.formed("second harmonic").with("second", second) } else { ripple }
    },
    size: Size::Times(&["amplitude"]),
    read: |reader| {
        reader.on_drive(Ripple {
            amplitude: reader.number("amplitude")?,
            periods: reader.number("periods")?,
            phase: reader.number("phase")?,
            second: reader.number_or("second", [0.0, 0.4][reader.form()?])?,
        })
    },
    #[cfg(test)]
    example: |bare| bare.with("amplitude", 1.0).with("periods", 20.0).with("phase", 1.0),
    ..Fault::ON_A_JOINT
};

/// amplitude (sin x + second sin(2 x + 1.3 phase)), x = periods q + phase.
struct Ripple {
    amplitude: f64,
    periods: f64,
    phase: f64,
    second: f64,
}

impl DriveLaw for Ripple {
    fn torque(&self, q: f64, _: f64) -> f64 {
        let x = self.periods * q + self.phase;
        self.amplitude * (x.sin() + self.second * (2.0 * x + 1.3 * self.phase).sin())
    }
}
