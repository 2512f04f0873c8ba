//! Dry friction that differs between the two directions.

use super::thermal::WARMING;
use crate::laws::{ABS_SIGN, SIGN};
use crate::{Against, Dry, Parameter, Quantity, Spec, Term, Turn};

/// The experiment that distinguishes a torque offset from friction where no motion does.
const BRAKE: &str = "read the torque with the brake closed and no current: a torque offset persists, friction does not";

/// τ = positive while q̇ > 0, −negative while q̇ < 0.
pub static FRICTION_ASYMMETRY: Spec = Spec {
    name: "friction_asymmetry",
    title: "asymmetric friction",
    meaning: "Coulomb friction that differs between the two directions of motion",
    distinguished_by: BRAKE,
    formula: "F₊ forwards, −F₋ backwards",
    sentence: "Coulomb friction that depends on the direction, {positive} forwards and {negative} backwards",
    parameters: &[Parameter::new("positive", Quantity::Torque), Parameter::new("negative", Quantity::Torque)],
    main: &["positive", "negative"],
    generalises: Some("coulomb_friction"),
    excludes: &["torque_offset", "spring"],
    // Every drive has a small asymmetry. In simulated cases with small effects on every joint (below 1.5 % of its torque),
    // it explains 0.3 % to 2 % beyond Coulomb friction; injected asymmetry explains 0.8 % and more, because the background
    // of the fit may explain a part of it.
    least_beyond_simpler: 0.007,
    is_baseline_or_constant: true,
    against: Against::Speed,
    experiments_against: &[("torque_offset", BRAKE), ("spring", BRAKE)],
    forms: |grounds| {
        grounds.on_moving(Turn::Friction, |joint| vec![Term::on(&SIGN, joint), Term::on(&ABS_SIGN, joint)])
    },
    is_possible: |fitted| {
        // No motion distinguishes an asymmetry from a torque offset, which every sensor has, so that the relative size
        // decides between them.
        let part = fitted.value(1).abs() / fitted.value(0);
        fitted.value(0) > 0.0 && (LEAST_PART..MOST_PART).contains(&part)
    },
    read: |effect, estimate| {
        let (a, b) = (estimate.place(0)?, estimate.place(1)?);
        // If another effect states the Coulomb level, the parameters give only the difference between the directions.
        let is_whole = estimate.level_beside(&[&WARMING]) > 0.0;
        let level = |draw: &[f64]| if is_whole { draw[a] } else { draw[b].abs() };
        let positive = estimate.note("positive", |draw| level(draw) + draw[b]);
        let negative = estimate.note("negative", |draw| level(draw) - draw[b]);
        Some(effect.with("positive", positive).with("negative", negative))
    },
    refuse: |effect| {
        let sum = effect.number("positive") + effect.number("negative");
        (sum < 0.0).then_some(("positive + negative", sum, "finite and not negative"))
    },
    // If another dry friction of the joint states the Coulomb level, this one states only by how much one direction
    // exceeds the other.
    own_sentence: |effect| {
        if effect.number("negative") == 0.0 {
            Some("dry friction that is larger by {positive} forwards than backwards")
        } else if effect.number("positive") == 0.0 {
            Some("dry friction that is larger by {negative} backwards than forwards")
        } else {
            None
        }
    },
    dry_friction: |effect| Some(0.5 * (effect.number("positive") + effect.number("negative"))),
    apply: |effect, at, machine| {
        let (positive, negative) = (effect.number("positive"), effect.number("negative"));
        let dry = Dry::new(move |_, _| 0.5 * (positive + negative)).biased(0.5 * (positive - negative));
        machine.dry.push((at.joint, dry));
    },
    ..Spec::EMPTY
};

/// The least asymmetry, half the difference between the directions over their mean, that is named: a smaller one is named as a
/// torque offset, which has the same torque in motion.
const LEAST_PART: f64 = 0.12;
/// The largest asymmetry that is named: friction four times as large in one direction as in the other. Beyond, the
/// drive's current or torque sensor has an offset. Source: `prove` injects up to 0.5; it had injected 40 to one, which
/// no bearing has.
const MOST_PART: f64 = 0.6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_columns_are_its_torque() {
        let effect = Effect::of(&FRICTION_ASYMMETRY).on("a");
        let effect = effect.with("positive", 3.0).with("negative", 1.0);
        agree(&effect, &[(Term::on(&SIGN, 0), 2.0), (Term::on(&ABS_SIGN, 0), 1.0)]);
    }
}
