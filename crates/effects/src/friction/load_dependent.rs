//! Gear friction that grows with the load.

use super::thermal::WARMING;
use crate::laws::{ABS_SIGN, SIGN};
use crate::{Against, Cone, Detectability, Dry, Fitted, Law, Parameter, Quantity, Range, Spec, Systematic, Term, Turn};

/// τ = (coulomb + gain |τ rigid|) sgn q̇; τ rigid is what the gear transmits to the links, without the rotor's own torque.
pub static LOAD_DEPENDENT_FRICTION: Spec = Spec {
    name: "load_dependent_friction",
    title: "load-dependent friction",
    meaning: "gear friction that grows with the torque transmitted by the gear",
    distinguished_by: "the same speed under several loads or postures",
    formula: "(F₀ + μ |τ rigid|) sgn q̇",
    sentence: "Coulomb friction of {coulomb}, plus {gain} times the load torque",
    parameters: &[
        Parameter::new("coulomb", Quantity::Torque).within(Range::NotNegative),
        Parameter::new("gain", Quantity::Ratio).within(Range::NotNegative).remarked("N m per N m of load"),
    ],
    main: &["gain"],
    generalises: Some("coulomb_friction"),
    // Every gear has some load dependence. In simulated cases with small effects on every joint (below 1.5 % of its torque), it
    // explains up to 1 % beyond Coulomb friction; injected load dependence explains 6.6 % and more.
    least_beyond_simpler: 0.012,
    against: Against::LoadAlong,
    detectability: Detectability::LINEAR,
    not_testable_turn: 9,
    forms: |grounds| {
        grounds.on_moving(Turn::Friction, |joint| vec![Term::on(&SIGN, joint), Term::on(&LOAD_SIGN, joint)])
    },
    is_possible: |fitted| {
        fitted.value(1) > 0.0
            && fitted.value(1) < LARGEST_GAIN
            && fitted.value(0) > -BELOW_ZERO * fitted.value(1) * load(fitted)
    },
    read: |effect, estimate| {
        let level = estimate.level_beside(&[&WARMING, &ABS_SIGN]);
        let coulomb = estimate.coefficient("coulomb", estimate.place(0), level);
        let place = estimate.place(1)?;
        let gain = estimate.note_within(Systematic::OfArm, "gain", &|draw| draw[place]);
        Some(effect.with("coulomb", coulomb).with("gain", gain))
    },
    // If another dry friction of the joint states the Coulomb level, this one states only the part that grows with the
    // load.
    own_sentence: |effect| (effect.number("coulomb") == 0.0).then_some("dry friction of {gain} times the load torque"),
    apply: |effect, at, machine| {
        let (coulomb, gain) = (effect.number("coulomb"), effect.number("gain"));
        let dry = Dry::new(move |_, at| coulomb + gain * at.load.abs()).loaded();
        machine.dry.push((at.joint, dry));
    },
    ..Spec::EMPTY
};

/// |τ rigid| sgn q̇, without the torque of a known rotor.
pub static LOAD_SIGN: Law = Law {
    name: "load_sign",
    column: |_, joint, motion| motion.map(|k| motion.load(joint, k).abs() * motion.sign(joint, k)),
    needs_model: true,
    cone: Cone::Level(|_, load, _| load.abs()),
    ..Law::PLAIN
};

/// The largest gain: with a larger one, friction would exceed the load. Source: definition.
const LARGEST_GAIN: f64 = 1.0;
/// Without load, friction may be zero, but not negative by more than this part of the load's friction. Source: first
/// diagnosis.
const BELOW_ZERO: f64 = 0.1;

/// The mean of the absolute load.
fn load(fitted: &dyn Fitted) -> f64 {
    fitted.column(1).map_or(0.0, |x| x.iter().map(|v| v.abs()).sum::<f64>() / x.len().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_columns_are_its_torque() {
        let effect = Effect::of(&LOAD_DEPENDENT_FRICTION).on("a");
        let effect = effect.with("coulomb", 0.5).with("gain", 0.1);
        agree(&effect, &[(Term::on(&SIGN, 0), 0.5), (Term::on(&LOAD_SIGN, 0), 0.1)]);
    }
}
