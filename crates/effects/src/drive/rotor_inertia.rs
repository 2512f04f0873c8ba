//! The inertia of the drive's rotor, reflected to the joint by the gear.

use crate::laws::ACCELERATION;
use crate::{Against, Detectability, Experiment, Parameter, Quantity, Range, Spec, Term, Turn};

/// τ = inertia q̈.
pub static ROTOR_INERTIA: Spec = Spec {
    name: "rotor_inertia",
    title: "rotor inertia",
    meaning: "the inertia of the drive's rotor, reflected to the joint by the gear",
    distinguished_by: "the same accelerations in other postures, with and without a payload",
    formula: "Ia q̈",
    sentence: "a reflected rotor inertia of {inertia}",
    parameters: &[Parameter::new("inertia", Quantity::Inertia).within(Range::NotNegative)],
    main: &["inertia"],
    may_end: true,
    prior: 4.0,
    is_baseline: true,
    is_baseline_or_constant: true,
    least_beside_residual: Some(1.25),
    against: Against::Acceleration,
    experiment: Some(Experiment {
        rank: 8,
        text: "attach a body of known inertia to the tool: the rotor inertia is independent of posture and load, \
               the inertia of a link is not; or take the rotor inertia from the data sheet (--known)",
    }),
    detectability: Detectability::LINEAR,
    not_testable_turn: 7,
    forms: |grounds| grounds.on_moving(Turn::Drive, |joint| vec![Term::on(&ACCELERATION, joint)]),
    is_possible: |fitted| fitted.value(0) > 0.0,
    // With a spring or a gap in the drive, the rotor's column is not the only one that depends on the acceleration.
    read: |effect, estimate| {
        let at = estimate.at(&ACCELERATION)?;
        let inertia = estimate.coefficient("inertia", Some(at), 1.0);
        Some(effect.with("inertia", inertia))
    },
    sum: |a, b| Some(a.clone().with("inertia", a.number("inertia") + b.number("inertia"))),
    apply: |effect, at, machine| machine.rotors[at.joint] += effect.number("inertia"),
    ..Spec::EMPTY
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_column_is_its_torque() {
        let effect = Effect::of(&ROTOR_INERTIA).on("a").with("inertia", 0.4);
        agree(&effect, &[(Term::on(&ACCELERATION, 0), 0.4)]);
    }
}
