//! Outside the catalogue: a torque that depends on another joint's velocity.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "other_velocity_unknown",
    forms: &["square", "saturating"],
    can_be_on: has_another_joint,
    draw: |bare, at, random| {
        let (other, _) = at.other_and_phase(random);
        let bare = match random.random_range(0..3) {
            0 => bare,
            1 => bare.formed("square"),
            _ => bare.formed("saturating").with("velocity", random.random_range(0.1..0.3)),
        };
        bare.with("amplitude", at.spread() * random.random_range(0.15..0.5)).with("other", other)
    },
    read: |reader| {
        reader.on_link(OtherVelocity {
            amplitude: reader.number("amplitude")?,
            other: reader.other()?,
            of: match reader.form()? {
                0 => Of::Signed,
                1 => Of::Square,
                _ => Of::Saturating(reader.number_above("velocity", 0.0)?),
            },
        })
    },
    #[cfg(test)]
    example: |bare| bare.with("amplitude", 2.0).with("velocity", 0.2).with("other", "axis5"),
    ..Fault::OUTSIDE_THE_CATALOGUE
};

struct OtherVelocity {
    amplitude: f64,
    other: usize,
    of: Of,
}

/// The function of the other joint's velocity.
#[derive(Clone, Copy)]
enum Of {
    /// v |v|.
    Signed,
    /// v².
    Square,
    /// tanh(v / width), with this width (rad/s or m/s).
    Saturating(f64),
}

impl LinkLaw for OtherVelocity {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        let w = at.qd[self.other];
        self.amplitude
            * match self.of {
                Of::Signed => w * w.abs(),
                Of::Square => w * w,
                Of::Saturating(width) => (w / width).tanh(),
            }
    }
}
