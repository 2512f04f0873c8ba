//! Drag: friction that grows faster than the speed.

use crate::{
    Against, Detectability, Form, Law, Parameter, Quantity, Range, SetsIn, Size, Spec, State, Systematic, Term, Turn,
};

/// τ = coefficient |q̇|^exponent sgn q̇.
pub static QUADRATIC_DRAG: Spec = Spec {
    name: "quadratic_drag",
    title: "quadratic drag",
    meaning: "a torque against the motion that grows with the square of its speed",
    distinguished_by: "a wider range of speeds",
    formula: "c |q̇|ᵖ sgn q̇; the exponent p is about 2 and is fitted between 1.4 and 3.2",
    sentence: "drag that grows with the speed to the power of {exponent}, with a coefficient of {coefficient}",
    parameters: &[
        Parameter::new("coefficient", Quantity::Drag).within(Range::NotNegative),
        Parameter::new("exponent", Quantity::Ratio).or(2.0).remarked(""),
    ],
    main: &["coefficient"],
    may_end: true,
    may_set_in: true,
    against: Against::Speed,
    detectability: Detectability::LINEAR,
    not_testable_turn: 6,
    forms: |grounds| {
        let forms = |joint| {
            [TURBULENT, 1.6, 2.5].map(|exponent| {
                let terms = vec![Term::on(&DRAG, joint).sized([exponent])];
                Form::on(Turn::Friction, joint, terms)
            })
        };
        grounds.moving().flat_map(forms).collect()
    },
    sets_in: Some(SetsIn {
        turn: 3,
        forms: |joint| vec![vec![Term::on(&DRAG, joint).sized([TURBULENT])]],
        looked_for_with: 1,
    }),
    is_possible: |fitted| {
        let is_drag = |term: Term| !term.is(&DRAG) || EXPONENTS.contains(&term.sizes[0]);
        fitted.value(0) > 0.0 && (0..fitted.len()).all(|k| is_drag(fitted.term(k)))
    },
    read: |effect, estimate| {
        let exponent = estimate.terms().first()?.sizes[0];
        let coefficient = estimate.coefficient("coefficient", estimate.place(0), 1.0);
        let exponent = estimate.size(Systematic::OfForm, "exponent", Size::Exponent, exponent);
        let onset = estimate.onset();
        let effect = effect.since(onset);
        Some(effect.with("coefficient", coefficient).with("exponent", exponent))
    },
    sum: |a, b| {
        let is_one_law = a.number("exponent") == b.number("exponent");
        let sum = a.number("coefficient") + b.number("coefficient");
        is_one_law.then(|| a.clone().with("coefficient", sum))
    },
    is_twin: |a, b| a.number("exponent") == b.number("exponent"),
    apply: |effect, at, machine| {
        let (coefficient, exponent) = (effect.number("coefficient"), effect.number("exponent"));
        let torque = move |joint: usize, state: State<'_>| coefficient * drag(state.qd[joint], exponent);
        machine.add_torque(at.joint, effect.onset(), torque);
    },
    ..Spec::EMPTY
};

/// |q̇|^exponent sgn q̇; the size is the exponent.
pub static DRAG: Law = Law {
    name: "drag",
    column: |term, joint, motion| motion.map(|k| drag(motion.qd[joint][k], term.sizes[0])),
    sizes: &[(Size::Exponent, 0)],
    ..Law::PLAIN
};

fn drag(qd: f64, exponent: f64) -> f64 {
    qd.abs().powf(exponent).copysign(qd)
}

/// The exponent of the drag of a turbulent flow.
pub const TURBULENT: f64 = 2.0;

/// The exponents that a drag may have. Source: `prove`, seeds 1 and 2, and two sets made with MuJoCo.
const EXPONENTS: std::ops::RangeInclusive<f64> = 1.4..=3.2;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_column_is_its_torque() {
        let effect = Effect::of(&QUADRATIC_DRAG).on("a").with("coefficient", 4.0);
        agree(&effect, &[(Term::on(&DRAG, 0).sized([2.0]), 4.0)]);
    }
}
