//! Links whose mass, centre of mass and moments of inertia differ from the URDF's.

use ::arm::Inertia;

use super::tensor::{entries, second_moments, tensor};
use crate::{Effect, InUrdf, Law, Parameter, Quantity, Range, Shape, Spec};

/// The link that the joint carries has these inertial parameters.
pub static INERTIAL_PARAMETERS: Spec = Spec {
    name: "inertial_parameters",
    title: "inertial parameters",
    meaning: "masses, centres of mass and moments of inertia that differ from the URDF's in no particular way",
    distinguished_by: "a link weighed and balanced on an edge, or a motion that loads it in other poses",
    formula: "another mass, centre of mass and tensor of the link behind the joint",
    sentence: "link mass of {mass} with its centre of mass at ({com_x}, {com_y}, {com_z})",
    parameters: &[
        Parameter::new("mass", Quantity::Mass).within(Range::Positive),
        Parameter::new("com", Quantity::Length)
            .of(Shape::List(3, &["com_x", "com_y", "com_z"]))
            .remarked("m, in the link's frame"),
        Parameter::new("inertia", Quantity::Inertia)
            .of(Shape::List(6, &[]))
            .remarked("kg m²: Ixx Ixy Iyy Ixz Iyz Izz about the centre of mass, along the link's axes"),
    ],
    main: &["mass"],
    is_certain_in_form: true,
    is_wrong_mass: true,
    is_beyond_the_drive: true,
    in_urdf: InUrdf::Inertials,
    // None: inertial parameters are in the background of every fit, and named where the background is large.
    forms: |_| Vec::new(),
    refuse: |effect| {
        let moments = second_moments(&link_body(effect).tensor).symmetric_eigenvalues();
        let wrong = moments.min() < -ROUNDING * moments.amax();
        wrong.then_some(("inertia's smallest second moment of mass", moments.min(), Range::NotNegative.requirement()))
    },
    apply: |effect, at, machine| machine.change_arm(|arm| arm.with_link_inertia(at.joint, link_body(effect))),
    ..Spec::EMPTY
};

/// The torque for a unit of one of the ten inertial parameters (`of[1]`) of a link (`of[0]`). Its columns are formed for all
/// links at once, from the regressor.
pub static PARAMETER: Law = Law { name: "inertial parameter", needs_model: true, ..Law::PLAIN };

/// The share of the largest moment of inertia by which another may be negative, for rounding. Source: rounding.
const ROUNDING: f64 = 1e-6;

/// The effect that gives the link behind `joint` this body, in the link's frame.
pub fn link_effect(joint: impl Into<String>, body: &Inertia) -> Effect {
    let com = [body.com.x, body.com.y, body.com.z];
    let effect = Effect::of(&INERTIAL_PARAMETERS).on(joint).with("mass", body.mass);
    effect.with("com", com).with("inertia", entries(&body.tensor))
}

/// The body that an effect gives its link.
pub fn link_body(effect: &Effect) -> Inertia {
    Inertia { mass: effect.number("mass"), com: effect.vector("com"), tensor: tensor(effect.list("inertia")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body that is written as an effect and read again is the same; an impossible body is refused.
    #[test]
    fn a_body_is_an_effect_and_back() {
        let body = Inertia {
            mass: 2.0,
            com: ::arm::Vector3::new(0.1, 0.0, -0.2),
            tensor: ::arm::Matrix3::from_diagonal(&::arm::Vector3::new(0.02, 0.03, 0.04)),
        };
        let effect = link_effect("a", &body);
        assert_eq!(link_body(&effect), body);
        assert!((INERTIAL_PARAMETERS.refuse)(&effect).is_none());
        let thin = Inertia { tensor: ::arm::Matrix3::from_diagonal(&::arm::Vector3::new(0.02, 0.03, 0.09)), ..body };
        let effect = link_effect("a", &thin);
        assert!((INERTIAL_PARAMETERS.refuse)(&effect).is_some(), "no body has such moments");
    }
}
