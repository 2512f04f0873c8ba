//! Stribeck friction: more dry friction at low speed.

use super::coulomb_friction::Level;
use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "stribeck_friction",
    forms: &["another exponent"],
    leaves: Leaves::DryFriction,
    draw: |bare, at, random| {
        let (coulomb, _) = at.dry_friction(random);
        let exponent = if at.hard { *[0.7, 1.0, 1.5, 3.0].choose(random).unwrap_or(&1.0) } else { 2.0 };
        let bare = if at.hard { bare.formed("another exponent") } else { bare };
        bare.with("coulomb", coulomb)
            .with("breakaway", coulomb * random.random_range(1.4..2.4))
            .with("velocity", random.random_range(0.06..0.28))
            .with("exponent", exponent)
    },
    size: Size::Changed(|injected, factor| {
        let [coulomb, breakaway] = ["coulomb", "breakaway"].map(|name| injected.number(name).unwrap_or(0.0));
        let extra = (factor * (breakaway - coulomb)).min(2.5 * coulomb);
        vec![("breakaway", json!(coulomb + extra))]
    }),
    read: |reader| {
        let (joint, coulomb) = (reader.joint()?, reader.at_least_zero("coulomb")?);
        let fading = Fading {
            velocity: reader.number_above("velocity", 0.0)?,
            extra: reader.at_least_zero("breakaway")? - coulomb,
            exponent: reader.number_or("exponent", 2.0)?,
        };
        Ok(vec![Level(coulomb).below_a_curve(joint), Property::Dry(joint, Box::new(fading)).into()])
    },
    #[cfg(test)]
    example: |bare| bare.with("coulomb", 1.0).with("breakaway", 3.0).with("velocity", 0.2),
    ..Fault::ON_A_JOINT
};

/// The additional friction at low speed: extra e^(−|v/velocity|^exponent).
struct Fading {
    extra: f64,
    velocity: f64,
    exponent: f64,
}

impl DryLaw for Fading {
    fn add_to(&self, sum: &mut DrySum, at: &DryAt) {
        sum.level += self.extra * (-(at.velocity.abs() / self.velocity).powf(self.exponent)).exp();
    }
}
