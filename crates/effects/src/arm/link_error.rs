//! A link whose mass and inertia differ from the model's.

use crate::{Form, InUrdf, Law, Parameter, Quantity, Range, Spec, Term, Turn};

/// The mass and inertia of the link that the joint carries are (1 + `relative`) times the model's.
pub static LINK_INERTIAL_ERROR: Spec = Spec {
    name: "link_inertial_error",
    title: "link inertia error",
    meaning: "a link's mass or inertia differs from the model's",
    distinguished_by: "more postures, and faster motions of the neighbouring joints",
    formula: "mass and inertia of the link behind the joint × (1 + relative)",
    sentence: "a link whose mass and inertia differ from the model's by {relative%} %",
    parameters: &[Parameter::new("relative", Quantity::Ratio)
        .within(Range::AboveMinusOne)
        .remarked("true over model, less one")],
    main: &["relative"],
    is_certain_in_form: true,
    may_be_inertial: true,
    is_wrong_mass: true,
    acts_before_its_joint: true,
    is_beyond_the_drive: true,
    in_urdf: InUrdf::Inertials,
    // Forms for all links, whether their joints move or not.
    forms: |grounds| {
        let form = |link| Form::on(Turn::Link, link, vec![Term::about(&LINK, link)]);
        (0..grounds.dof()).map(form).collect()
    },
    is_possible: |fitted| RELATIVE.contains(&fitted.value(0)),
    read: |effect, estimate| {
        let relative = estimate.coefficient("relative", estimate.place(0), 1.0);
        Some(effect.with("relative", relative))
    },
    // Their factors are multiplied.
    sum: |a, b| {
        let [a_factor, b_factor] = [a, b].map(|effect| 1.0 + effect.number("relative"));
        Some(a.clone().with("relative", a_factor * b_factor - 1.0))
    },
    apply: |effect, at, machine| {
        machine.change_arm(|arm| arm.with_scaled_link(at.joint, 1.0 + effect.number("relative")));
    },
    ..Spec::EMPTY
};

/// The part of the rigid torque that one link causes on the joints before it.
pub static LINK: Law = Law {
    name: "link",
    column: |term, joint, motion| {
        let link = term.of[0];
        (joint <= link).then(|| motion.rigid.links[joint][link].clone())
    },
    needs_model: true,
    carry: Some(|term, value, carried| carried.arm = carried.arm.clone().with_scaled_link(term.of[0], 1.0 + value)),
    ..Law::PLAIN
};

/// The relative error that the mass of a link may have. Source: first diagnosis.
const RELATIVE: std::ops::Range<f64> = -0.8..2.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_column_is_its_torque() {
        let effect = Effect::of(&LINK_INERTIAL_ERROR).on("b").with("relative", -0.1);
        agree(&effect, &[(Term::about(&LINK, 1), -0.1)]);
    }
}
