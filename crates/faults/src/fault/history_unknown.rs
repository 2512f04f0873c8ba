//! Outside the catalogue: a torque that depends on the joint's own past.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "history_unknown",
    forms: &["signed square", "position"],
    draw: |bare, at, random| {
        at.other_and_phase(random);
        let bare = match random.random_range(0..3) {
            0 => bare,
            1 => bare.formed("signed square"),
            _ => bare.formed("position"),
        };
        bare.with("amplitude", at.spread() * random.random_range(0.3..1.0))
            .with("time_constant", random.random_range(1.0..4.0))
    },
    read: |reader| {
        reader.on_link(History {
            amplitude: reader.number("amplitude")?,
            time_constant: reader.number_above("time_constant", 0.0)?,
            of: [Past::Speed, Past::SignedSquare, Past::Position][reader.form()?],
        })
    },
    #[cfg(test)]
    example: |bare| bare.with("amplitude", 2.0).with("time_constant", 1.0),
    ..Fault::OUTSIDE_THE_CATALOGUE
};

/// A low-pass filtered function of the joint's motion.
struct History {
    amplitude: f64,
    time_constant: f64,
    of: Past,
}

/// The function of the motion.
#[derive(Clone, Copy, PartialEq)]
enum Past {
    /// |v|, low-passed.
    Speed,
    /// v |v|, low-passed.
    SignedSquare,
    /// Position, low-passed, less position.
    Position,
}

impl LinkLaw for History {
    fn torque(&self, at: At<'_>, state: &mut f64, step: f64) -> f64 {
        let (q, v) = (at.position(), at.velocity());
        let input = match self.of {
            Past::Speed => v.abs(),
            Past::SignedSquare => v * v.abs(),
            Past::Position => q,
        };
        *state += step / self.time_constant * (input - *state);
        self.amplitude * if self.of == Past::Position { *state - q } else { *state }
    }
}
