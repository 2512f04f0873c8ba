//! Masses and inertias that are all a constant multiple of the model's.

use crate::sensor::{TORQUE_SCALE, is_beyond_tolerance};
use crate::{Detectability, Form, InUrdf, Law, Parameter, Quantity, Range, Scope, Spec, Term};

/// All masses and inertias are `factor` times the model's.
pub static INERTIAL_SCALE: Spec = Spec {
    name: "inertial_scale",
    title: "inertial scale",
    meaning: "all masses and inertias are a constant multiple of the model's",
    distinguished_by: "a known payload: a torque scale changes its apparent mass, an inertial scale does not",
    formula: "all masses and inertias × k",
    sentence: "masses and inertias of {factor} times the model's",
    scope: Scope::Arm,
    parameters: &[Parameter::new("factor", Quantity::Ratio)
        .within(Range::Positive)
        .neutral_at(1.0)
        .remarked("true over model")],
    main: &["factor"],
    is_certain_in_form: true,
    may_be_inertial: true,
    least_beside_inertials: Some(8.0),
    // In simulated cases with URDFs wrong by 10 and 30 %, three false factors were 0.47, 0.49 and 0.56, and the true ones 0.75 to 1.3.
    most_beside_inertials: Some(0.4),
    same_on_all_joints: Some("torque_scale"),
    // As for a torque constant, of which it is the alias on all joints.
    least_beside_residual: Some(1.5),
    is_wrong_mass: true,
    is_beyond_the_drive: true,
    detectability: Detectability::OfArm { columns: 1 },
    not_testable_turn: 14,
    in_urdf: InUrdf::Inertials,
    forms: |_| vec![Form::of_arm(vec![Term::about(&SCALE, 0)])],
    is_possible: |fitted| RELATIVE.contains(&fitted.value(0)),
    // Torque constants that are all wrong have the same torque, so that the factor must be beyond what is usual of them.
    is_certain: |effect, _, accuracy| is_beyond_tolerance(effect, accuracy),
    // Beside several torque constants that are named, the factor may be a part of theirs: only the products of both are determined.
    is_contradicted: |_, beside| beside.iter().filter(|other| other.is(&TORQUE_SCALE)).count() >= SEVERAL_CONSTANTS,
    read: |effect, estimate| {
        let at = estimate.place(0)?;
        let factor = estimate.note("factor", |draw| 1.0 + draw[at]);
        Some(effect.with("factor", factor))
    },
    sum: |a, b| Some(a.clone().with("factor", a.number("factor") * b.number("factor"))),
    apply: |effect, _, machine| machine.change_arm(|arm| arm.with_scaled_inertias(effect.number("factor"))),
    ..Spec::EMPTY
};

/// The rigid torque of all links, without that of the drives.
pub static SCALE: Law = Law {
    name: "scale",
    column: |_, joint, motion| {
        let links = &motion.rigid.links[joint];
        motion.map(|k| links.iter().map(|link| link[k]).sum())
    },
    needs_model: true,
    carry: Some(|_, value, carried| carried.arm = carried.arm.clone().with_scaled_inertias(1.0 + value)),
    ..Law::PLAIN
};

/// The relative deviation from one that a common factor of all masses may have. Source: first diagnosis.
const RELATIVE: std::ops::Range<f64> = -0.6..1.5;

/// The number of torque constants beside which a factor on all masses is not named. Source: of nine such factors in 400 simulated cases,
/// one was false, beside two constants; the eight true ones have at most one.
const SEVERAL_CONSTANTS: usize = 2;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_column_is_its_torque() {
        let effect = Effect::of(&INERTIAL_SCALE).with("factor", 1.2);
        agree(&effect, &[(Term::about(&SCALE, 0), 0.2)]);
    }

    #[test]
    fn a_factor_beside_several_torque_constants_is_contradicted() {
        let scale = |joint: &str| Effect::of(&TORQUE_SCALE).on(joint).with("factor", 1.2);
        let factor = Effect::of(&INERTIAL_SCALE).with("factor", 0.87);
        assert!(!(INERTIAL_SCALE.is_contradicted)(&factor, &[factor.clone(), scale("a")]));
        assert!((INERTIAL_SCALE.is_contradicted)(&factor, &[factor.clone(), scale("a"), scale("b")]));
    }

    #[test]
    fn a_factor_within_the_tolerance_of_torque_constants_is_not_certain() {
        let certain = |factor: f64, accuracy: f64| {
            let effect = Effect::of(&INERTIAL_SCALE).with("factor", factor);
            (INERTIAL_SCALE.is_certain)(&effect, &|_| None, accuracy)
        };
        assert!(certain(0.965, 0.015) && certain(1.2, 0.05));
        assert!(!certain(0.965, 0.05) && !certain(1.06, 0.05));
    }
}
