//! A drive that is also moved by another joint.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "transmission_coupling",
    joints: EligibleJoints::OuterJoints,
    can_be_on: has_another_joint,
    draw: |bare, at, random| {
        // The law is symmetric in the two joints; it is listed for the outer one, as in the catalogue.
        let robot = at.robot;
        let o = at.joint.saturating_sub(1);
        let both = (robot.inertia(at.joint) * robot.inertia(o)).sqrt();
        bare.with("other", robot.arm().joints()[o].name.as_str())
            .with("viscous", at.spread() * random.random_range(0.05..0.35))
            .with("inertia", both * random.random_range(0.15..0.55))
    },
    // Beyond 1.4 times this size, the inertia of the drive would be negative.
    size: Size::Changed(|injected, factor| {
        let times = |name| (name, json!(factor.min(1.4) * injected.number(name).unwrap_or(0.0)));
        vec![times("viscous"), times("inertia")]
    }),
    read: |reader| {
        let (joint, other) = (reader.joint()?, reader.other()?);
        let (viscous, coulomb) = (reader.number("viscous")?, reader.number_or("coulomb", 0.0)?);
        let sense = reader.number_or("sense", 1.0)?;
        let half = |joint, other| {
            let law = Coupling { other, viscous, coulomb, sense };
            Property::Link(joint, Box::new(law)).into()
        };
        let inertia = Property::CouplingInertia(joint, other, reader.number_or("inertia", 0.0)?);
        Ok(vec![half(joint, other), half(other, joint), inertia.into()])
    },
    #[cfg(test)]
    example: |bare| bare.with("viscous", 0.2).with("inertia", 0.005).with("other", "axis5"),
    ..Fault::ON_A_JOINT
};

/// Another joint's motion moves this joint's drive; the machine handles the drive's inertia.
struct Coupling {
    other: usize,
    viscous: f64,
    coulomb: f64,
    sense: f64,
}

impl LinkLaw for Coupling {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        let slip = at.velocity() + self.sense * at.qd[self.other];
        // A width far below the speeds of a motion, with which an explicit step remains stable at rest.
        self.viscous * at.qd[self.other] + self.coulomb * (slip / 0.01).tanh()
    }
}
