//! A motion without a search, for comparison: one sine per joint.

use arm::Arm;
use torque::{Corrected, Reference};

use super::bounds::Allowed;
use crate::next::designs::{Design, Mix};
use crate::next::limits::Limits;

/// One sine per joint, all of different frequencies, as large and as fast as `allowed`; `None` if there is no such motion.
pub fn motion(arm: &Arm, allowed: &Allowed) -> Option<Reference> {
    let limits = Limits {
        names: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
        middle: allowed.middle.clone(),
        room: allowed.room.clone(),
        speed: allowed.velocity.clone(),
        torque: allowed.torque.clone(),
        model: Corrected::new(arm, &[]).ok()?,
    };
    let design = Design { mix: Mix::Steady, speed: 1.0, amplitude: 1.0, only: Vec::new(), others: 1.0 };
    design.within(&limits).map(|(reference, _)| reference)
}
