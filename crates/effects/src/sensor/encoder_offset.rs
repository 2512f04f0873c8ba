//! An encoder whose zero differs from the model's.

use crate::{Detectability, Experiment, Law, Parameter, Quantity, Spec, Term, Turn};

/// The encoder reports the true position plus `offset`.
pub static ENCODER_OFFSET: Spec = Spec {
    name: "encoder_offset",
    title: "encoder offset",
    meaning: "the zero of the joint's encoder differs from the model's",
    distinguished_by: "a mechanical reference for the zero, or static poses in many postures",
    formula: "measured position = true position + offset",
    sentence: "an encoder offset of {offset}",
    parameters: &[Parameter::new("offset", Quantity::Position)],
    main: &["offset"],
    // In the same cases as those of `external_contact`, six zeros that were not wrong had 0.8 to 1.3, and the others 1.4 and more. Those that
    // were not stood for a wrong gear ratio of the encoder, and for a load that moves.
    least_over_error: Some(1.35),
    is_certain_in_form: true,
    may_be_inertial: true,
    acts_before_its_joint: true,
    // Shifted centres of mass resemble it. In simulated cases with URDFs wrong by up to 30 %, false ones had 21 to 48 nats, injected
    // ones 77 and more.
    least_beside_inertials: Some(60.0),
    experiment: Some(Experiment {
        rank: 6,
        text: "move the joint to a mechanical reference, or measure its angle: the comparison shows an encoder offset",
    }),
    detectability: Detectability::LINEAR,
    not_testable_turn: 12,
    forms: |grounds| grounds.on_moving(Turn::Zero, |joint| vec![Term::about(&SLOPE, joint)]),
    is_possible: |fitted| fitted.value(0).abs() < LARGEST_OFFSET,
    read: |effect, estimate| {
        // The column is the derivative with respect to the true position; the encoder's offset has the opposite sign.
        let offset = estimate.coefficient("offset", estimate.place(0), -1.0);
        Some(effect.with("offset", offset))
    },
    sum: |a, b| Some(a.clone().with("offset", a.number("offset") + b.number("offset"))),
    apply: |effect, at, machine| machine.encoder_offsets[at.joint] -= effect.number("offset"),
    ..Spec::EMPTY
};

/// ∂τ/∂q of one joint: the torque that a position error of one (rad or m) adds.
pub static SLOPE: Law = Law {
    name: "slope",
    column: |term, joint, motion| Some(motion.rigid.by_position[joint][term.of[0]].clone()),
    needs_model: true,
    needs_derivatives: true,
    carry: Some(|term, value, carried| carried.offset[term.of[0]] += value),
    ..Law::PLAIN
};

/// The largest offset (rad or m): the column is linearised about zero. Source: first diagnosis.
const LARGEST_OFFSET: f64 = 0.2;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    /// The column agrees with the machine to first order, with the opposite sign.
    #[test]
    fn its_column_is_its_torque() {
        let effect = Effect::of(&ENCODER_OFFSET).on("a").with("offset", -1e-6);
        agree(&effect, &[(Term::about(&SLOPE, 0), 1e-6)]);
    }
}
