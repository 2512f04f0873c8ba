//! A constant added to the measured torque.

use crate::laws::ONE;
use crate::{Against, Experiment, Parameter, Quantity, SetsIn, Spec, Term, Turn};

/// The experiment that distinguishes offset and scale of a torque where no motion does.
pub(super) const KNOWN_LOAD: Experiment = Experiment {
    rank: 5,
    text: "read the torque under a known load at rest, in two poses in which gravity acts in opposite senses: their mean shows the offset, their difference the scale",
};

/// τ = offset.
pub static TORQUE_OFFSET: Spec = Spec {
    name: "torque_offset",
    title: "torque offset",
    meaning: "a constant added to the measured torque",
    distinguished_by: "static poses in several postures",
    formula: "constant",
    sentence: "a constant torque of {offset}",
    parameters: &[Parameter::new("offset", Quantity::Torque)],
    main: &["offset"],
    may_end: true,
    may_set_in: true,
    excludes: &["friction_asymmetry", "spring"],
    prior: 10.0,
    is_baseline_or_constant: true,
    is_certain_in_form: true,
    may_be_inertial: true,
    // A false one had 12 nats in simulated cases with URDFs wrong by 30 %, the smallest injected ones 29.
    least_beside_inertials: Some(25.0),
    // None of four in the cases of `torque_scale` was right, at up to 4.3 times the residual. Asymmetric friction, which is called an
    // offset until the recordings decide, may be 4.5 to 6 times the residual where friction differs between recordings.
    least_beside_residual: Some(4.5),
    against: Against::Position,
    experiment: Some(KNOWN_LOAD),
    forms: |grounds| grounds.on_moving(Turn::Drive, |joint| vec![Term::on(&ONE, joint)]),
    sets_in: Some(SetsIn { turn: 0, forms: |joint| vec![vec![Term::on(&ONE, joint)]], looked_for_with: 1 }),
    read: |effect, estimate| {
        let offset = estimate.coefficient("offset", estimate.place(0), 1.0);
        let onset = estimate.onset();
        Some(effect.since(onset).with("offset", offset))
    },
    sum: |a, b| Some(a.clone().with("offset", a.number("offset") + b.number("offset"))),
    apply: |effect, at, machine| {
        let offset = effect.number("offset");
        machine.add_torque(at.joint, effect.onset(), move |_, _| offset);
    },
    ..Spec::EMPTY
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_column_is_its_torque() {
        let effect = Effect::of(&TORQUE_OFFSET).on("a").with("offset", -0.7);
        agree(&effect, &[(Term::on(&ONE, 0), -0.7)]);
    }
}
