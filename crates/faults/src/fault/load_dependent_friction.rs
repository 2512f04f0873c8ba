//! Dry friction that grows with the load on the joint.

use super::coulomb_friction::Level;
use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "load_dependent_friction",
    forms: &["drive load"],
    // The first joint may carry no load, and the last link may have almost no mass.
    joints: EligibleJoints::InnerJoints,
    leaves: Leaves::DryFriction,
    draw: |bare, at, random| {
        let (coulomb, form) = at.dry_friction(random);
        let bare = if form == 1 { bare.formed("drive load") } else { bare };
        bare.with("coulomb", coulomb).with("gain", random.random_range(0.06..0.2))
    },
    size: Size::Changed(|injected, factor| {
        let gain = injected.number("gain").unwrap_or(0.0);
        vec![("gain", json!((factor * gain).min(0.35)))]
    }),
    read: |reader| {
        let joint = reader.joint()?;
        let loaded = Loaded { of: [Load::Rigid, Load::Drive][reader.form()?], gain: reader.at_least_zero("gain")? };
        Ok(vec![
            Level(reader.at_least_zero("coulomb")?).below_a_curve(joint),
            Property::Dry(joint, Box::new(loaded)).into(),
        ])
    },
    #[cfg(test)]
    example: |bare| bare.with("coulomb", 1.0).with("gain", 0.15),
    ..Fault::ON_A_JOINT
};

/// `gain` times the absolute load.
struct Loaded {
    gain: f64,
    of: Load,
}

/// The load on which friction depends.
#[derive(Clone, Copy, PartialEq)]
enum Load {
    /// The rigid torque.
    Rigid,
    /// The torque of the drive behind a low-pass filter of 20 ms.
    Drive,
}

impl DryLaw for Loaded {
    fn add_to(&self, sum: &mut DrySum, at: &DryAt) {
        let load = match self.of {
            Load::Rigid => at.rigid_load,
            Load::Drive => at.drive_load,
        };
        sum.level += self.gain * load.abs();
    }

    fn depends_on_rigid_load(&self) -> bool {
        self.of == Load::Rigid
    }
}
