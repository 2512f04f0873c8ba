//! Coulomb friction.

use crate::laws::SIGN;
use crate::{Against, Dry, InUrdf, Parameter, Quantity, Range, Spec, Term, Turn};

/// τ = level sgn q̇.
pub static COULOMB_FRICTION: Spec = Spec {
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
    forms: |grounds| grounds.on_moving(Turn::Friction, |joint| vec![Term::on(&SIGN, joint)]),
    is_possible: |fitted| fitted.value(0) > 0.0,
    read: |effect, estimate| {
        let level = estimate.coefficient("level", estimate.place(0), 1.0);
        Some(effect.with("level", level))
    },
    dry_friction: |effect| Some(effect.number("level")),
    sum: |a, b| Some(a.clone().with("level", a.number("level") + b.number("level"))),
    apply: |effect, at, machine| {
        let level = effect.number("level");
        machine.dry.push((at.joint, Dry::new(move |_, _| level)));
    },
    ..Spec::EMPTY
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_column_is_its_torque() {
        let effect = Effect::of(&COULOMB_FRICTION).on("a").with("level", 2.0);
        agree(&effect, &[(Term::on(&SIGN, 0), 2.0)]);
    }
}
