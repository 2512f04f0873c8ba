//! Coulomb friction, which is equal at every speed. It is a baseline effect, drawn for the background of a case and not as
//! its fault.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "coulomb_friction",
    draw: |bare, at, random| bare.with("level", level(at.spread(), random)),
    read: |reader| reader.on_dry(Level(reader.at_least_zero("level")?)),
    #[cfg(test)]
    example: |bare| bare.with("level", 2.0),
    ..Fault::ON_A_JOINT
};

/// The baseline level of a joint whose torque has the standard deviation `spread` (N m or N).
pub(crate) fn level(spread: f64, random: &mut ChaCha8Rng) -> f64 {
    spread * log_uniform(0.06, 0.35, random)
}

/// Dry friction that is equal at every speed (N m or N).
pub(super) struct Level(pub f64);

impl DryLaw for Level {
    fn add_to(&self, sum: &mut DrySum, _: &DryAt) {
        sum.level += self.0;
    }
}

impl Level {
    /// The plain friction of a joint, which remains when a fault that changes its curve is removed.
    pub(super) fn below_a_curve(self, joint: usize) -> Piece {
        Property::Dry(joint, Box::new(self)).in_both_machines()
    }
}
