//! Viscous friction.

use crate::laws::VELOCITY;
use crate::{Against, InUrdf, Parameter, Quantity, Range, Spec, Term, Turn};

/// τ = coefficient q̇.
pub static VISCOUS_FRICTION: Spec = Spec {
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
    forms: |grounds| grounds.on_moving(Turn::Friction, |joint| vec![Term::on(&VELOCITY, joint)]),
    is_possible: |fitted| fitted.value(0) > 0.0,
    read: |effect, estimate| {
        let coefficient = estimate.coefficient("coefficient", estimate.place(0), 1.0);
        Some(effect.with("coefficient", coefficient))
    },
    sum: |a, b| Some(a.clone().with("coefficient", a.number("coefficient") + b.number("coefficient"))),
    apply: |effect, at, machine| machine.add_viscous(at.joint, effect.number("coefficient")),
    ..Spec::EMPTY
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_column_is_its_torque() {
        let effect = Effect::of(&VISCOUS_FRICTION).on("a").with("coefficient", 4.0);
        agree(&effect, &[(Term::on(&VELOCITY, 0), 4.0)]);
    }
}
