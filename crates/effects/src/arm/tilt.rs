//! A base that does not stand level.

use crate::{
    Effect, EffectKind, Estimate, Experiment, Fitted, Form, Grounds, Law, Machine, Parameter, Place, Quantity, Range,
    Scope, Shape, Spec, Term,
};

/// The base is turned by `angle` about `axis` (unit, in the base's frame): gravity points elsewhere.
#[derive(Debug)]
pub struct GravityMisalignment;

static SPEC: Spec = Spec {
    name: "gravity_misalignment",
    title: "tilted base",
    meaning: "the base is not level, so that the direction of gravity differs from the model's",
    told_by: "a spirit level on the base, or static poses all around the base",
    formula: "gravity rotated by the angle about the axis",
    sentence: "a base tilted by {angle}",
    scope: Scope::Arm,
    parameters: &[
        Parameter::new("angle", Quantity::Angle),
        Parameter::new("axis", Quantity::Ratio)
            .of(Shape::List(3, &["axis_x", "axis_y"]))
            .remarked("in the base's frame"),
    ],
    main: &["angle"],
    is_certain_in_form: true,
    is_behind_the_drive: true,
    experiment: Some(Experiment {
        rank: 7,
        text: "level the base with a spirit level and record again: an effect that remains is not a tilt",
    }),
    ..Spec::EMPTY
};

/// ∂τ/∂(turn of the base about x or y).
pub static TILT: Law = Law {
    name: "tilt",
    column: |term, joint, motion| Some(motion.rigid.tilt[joint][term.of[0]].clone()),
    needs_model: true,
    carry: Some(|term, value, carried| carried.tilt[term.of[0]] = value),
    ..Law::PLAIN
};

impl EffectKind for GravityMisalignment {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn forms(&self, _: &Grounds<'_>) -> Vec<Form> {
        vec![Form::of_arm(vec![Term::about(&TILT, 0), Term::about(&TILT, 1)])]
    }

    fn is_possible(&self, fitted: &dyn Fitted) -> bool {
        fitted.value(0).hypot(fitted.value(1)) < 0.4
    }

    fn read(&self, estimate: &mut dyn Estimate) -> Option<Effect> {
        let (a, b) = (estimate.place(0)?, estimate.place(1)?);
        let angle = estimate.note("angle", |draw| draw[a].hypot(draw[b]));
        let x = estimate.note("axis_x", |draw| draw[a] / draw[a].hypot(draw[b]));
        let y = estimate.note("axis_y", |draw| draw[b] / draw[a].hypot(draw[b]));
        Some(Effect::of(&Self).with("angle", angle).with("axis", [x, y, 0.0]))
    }

    fn refuse(&self, effect: &Effect) -> Option<(&'static str, f64, &'static str)> {
        let axis: [f64; 3] = effect.list("axis");
        let length = axis.iter().map(|value| value * value).sum::<f64>().sqrt();
        let range = Range::Positive;
        (!range.contains(length)).then_some(("axis' length", length, range.requirement()))
    }

    fn apply(&self, effect: &Effect, _: Place, machine: &mut Machine) {
        machine.change_arm(|arm| arm.with_turned_base(effect.vector("axis"), effect.number("angle")));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::agree;

    /// To first order.
    #[test]
    fn its_columns_are_its_torque() {
        let effect = Effect::of(&GravityMisalignment).with("angle", 1e-6);
        let effect = effect.with("axis", [0.6, 0.8, 0.0]);
        agree(
            &effect,
            &[(Term::about(&TILT, 0), 0.6e-6), (Term::about(&TILT, 1), 0.8e-6)],
        );
    }
}
