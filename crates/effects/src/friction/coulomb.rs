//! Coulomb friction.

use crate::laws::SIGN;
use crate::{
    Against, Dry, Effect, EffectKind, Estimate, Fitted, Form, Grounds, InUrdf, Machine, Parameter, Place, Quantity,
    Range, Spec, Term, Turn,
};

/// τ = level sgn q̇.
#[derive(Debug)]
pub struct CoulombFriction;

static SPEC: Spec = Spec {
    name: "coulomb_friction",
    title: "Coulomb friction",
    meaning: "dry friction: a torque of constant magnitude against the motion",
    distinguished_by: "slow reversals of this joint alone",
    formula: "Fc sgn q̇",
    sentence: "Coulomb friction of {level}",
    parameters: &[Parameter::new("level", Quantity::Torque).within(Range::NotNegative)],
    main: &["level"],
    may_end: true,
    prior: 2.0,
    is_baseline: true,
    is_friction: true,
    is_baseline_or_constant: true,
    in_urdf: InUrdf::Friction,
    against: Against::Speed,
    not_testable_turn: 0,
    ..Spec::EMPTY
};

impl EffectKind for CoulombFriction {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn forms(&self, grounds: &Grounds<'_>) -> Vec<Form> {
        let form = |joint| Form::on(Turn::Friction, joint, vec![Term::on(&SIGN, joint)]);
        grounds.moving().map(form).collect()
    }

    fn is_possible(&self, fitted: &dyn Fitted) -> bool {
        fitted.value(0) > 0.0
    }

    fn read(&self, estimate: &mut dyn Estimate) -> Option<Effect> {
        let level = estimate.coefficient("level", estimate.place(0), 1.0);
        Some(Effect::of(&Self).on(estimate.joint_name()).with("level", level))
    }

    fn dry_friction(&self, effect: &Effect) -> Option<f64> {
        Some(effect.number("level"))
    }

    fn sum(&self, a: &Effect, b: &Effect) -> Option<Effect> {
        Some(a.clone().with("level", a.number("level") + b.number("level")))
    }

    fn apply(&self, effect: &Effect, at: Place, machine: &mut Machine) {
        let level = effect.number("level");
        machine.dry.push((at.joint, Dry::new(move |_, _| level)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::agree;

    #[test]
    fn its_column_is_its_torque() {
        let effect = Effect::of(&CoulombFriction).on("a").with("level", 2.0);
        agree(&effect, &[(Term::on(&SIGN, 0), 2.0)]);
    }
}
