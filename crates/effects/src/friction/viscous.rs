//! Viscous friction.

use crate::laws::VELOCITY;
use crate::{
    Against, Effect, EffectKind, Estimate, Fitted, Form, Grounds, InUrdf, Machine, Parameter, Place, Quantity, Range,
    Spec, Term, Turn,
};

/// τ = coefficient q̇.
#[derive(Debug)]
pub struct ViscousFriction;

static SPEC: Spec = Spec {
    name: "viscous_friction",
    title: "viscous friction",
    meaning: "a torque against the motion, proportional to its speed",
    distinguished_by: "motions at several constant speeds, from slow to fast",
    formula: "Fv q̇",
    sentence: "viscous friction of {coefficient}",
    parameters: &[Parameter::new("coefficient", Quantity::Damping).within(Range::NotNegative)],
    main: &["coefficient"],
    may_end: true,
    prior: 2.0,
    is_baseline: true,
    is_friction: true,
    is_baseline_or_constant: true,
    in_urdf: InUrdf::Damping,
    against: Against::Speed,
    not_testable_turn: 1,
    ..Spec::EMPTY
};

impl EffectKind for ViscousFriction {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn forms(&self, grounds: &Grounds<'_>) -> Vec<Form> {
        let form = |joint| Form::on(Turn::Friction, joint, vec![Term::on(&VELOCITY, joint)]);
        grounds.moving().map(form).collect()
    }

    fn is_possible(&self, fitted: &dyn Fitted) -> bool {
        fitted.value(0) > 0.0
    }

    fn read(&self, estimate: &mut dyn Estimate) -> Option<Effect> {
        let coefficient = estimate.coefficient("coefficient", estimate.place(0), 1.0);
        let effect = Effect::of(&Self).on(estimate.joint_name());
        Some(effect.with("coefficient", coefficient))
    }

    fn sum(&self, a: &Effect, b: &Effect) -> Option<Effect> {
        Some(a.clone().with("coefficient", a.number("coefficient") + b.number("coefficient")))
    }

    fn apply(&self, effect: &Effect, at: Place, machine: &mut Machine) {
        machine.add_viscous(at.joint, effect.number("coefficient"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::agree;

    #[test]
    fn its_column_is_its_torque() {
        let effect = Effect::of(&ViscousFriction).on("a").with("coefficient", 4.0);
        agree(&effect, &[(Term::on(&VELOCITY, 0), 4.0)]);
    }
}
