//! A drive that turns with two joints.

use crate::{Against, Form, Law, Parameter, Quantity, Spec, State, Term, Turn, sign};

/// The largest distance in the chain between two joints that share a drive: in a wrist, the shaft of a drive passes
/// through one other joint. Source: `prove`, seeds 1, 2, 3, 7, 2026 and 2027.
pub const FARTHEST_COUPLED: usize = 2;

/// A drive that turns with two joints, and its reaction. On each of the two, with o the other of them,
/// τ = viscous q̇ₒ + coulomb sgn(q̇ + sense q̇ₒ) + inertia q̈ₒ.
pub static TRANSMISSION_COUPLING: Spec = Spec {
    name: "transmission_coupling",
    title: "transmission coupling",
    meaning: "the motion of another joint turns the drive of this joint (geared wrist)",
    distinguished_by: "motions of each of the two joints alone",
    formula: "the drive of each of two joints also turns with the other one, o: viscous q̇ₒ + \
              coulomb sgn(q̇ + sense q̇ₒ) + inertia q̈ₒ on both. What it adds by the joint's own motion is a part of \
              the joint's own friction and rotor inertia. Tested for joints that are neighbours or have one joint between them",
    sentence: "a drive that also turns with {other}, with a viscous friction of {viscous} and an inertia of {inertia}",
    parameters: &[
        Parameter::new("viscous", Quantity::Damping),
        Parameter::new("coulomb", Quantity::Torque).or(0.0),
        Parameter::new("inertia", Quantity::Inertia).or(0.0),
        // 1 if the drive turns with the sum of the joints, −1 if with their difference.
        Parameter::new("sense", Quantity::Ratio).or(1.0).remarked(""),
    ],
    main: &["viscous", "inertia", "coulomb"],
    // In the same cases as those of `external_contact`, the 15 couplings that were not there had 0.6 to 1.9, and the others 2.2 and more.
    // Those that were not stood for drag on the tool.
    least_over_error: Some(2.0),
    is_beyond_the_drive: true,
    against: Against::OtherSpeed,
    has_other: true,
    // Pairs of joints that are near each other in the chain.
    forms: |grounds| {
        let mut forms = Vec::new();
        for joint in grounds.moving() {
            let near = joint.saturating_sub(FARTHEST_COUPLED)..joint;
            for other in near.filter(|&other| grounds.scales.moves(other)) {
                let pair = [&PAIR_VELOCITY, &PAIR_ACCELERATION].map(|law| Term::about(law, joint).of(other));
                let mut add = |terms| forms.push(Form::on(Turn::Pair, joint, terms).with(other));
                add(pair.to_vec());
                for sense in [1.0, -1.0] {
                    let dry = Term::about(&PAIR_SIGN, joint).of(other).sized([sense]);
                    add(vec![pair[0], pair[1], dry]);
                }
            }
        }
        forms
    },
    // The viscous friction must be clearly positive and the inertia not both clearly and notably negative, because a drive that turns
    // with both joints has both, in the sense in which it turns with them. The search allows other values.
    is_certain: |effect, interval, _| {
        let sense = effect.number("viscous").signum();
        let is_clear = |[low, high]: [f64; 2]| (sense * low).min(sense * high) > 0.0;
        let is_against = |[low, high]: [f64; 2]| (sense * low).max(sense * high) < 0.0;
        // Dry friction, if there is any, determines the sense in which the drive turns with both joints.
        let dry_agrees = interval("coulomb").is_none() || sense == effect.number("sense").signum();
        let is_notable = effect.number("inertia").abs() > NOTABLE_INERTIA * effect.number("viscous").abs();
        let is_refuted = is_notable && interval("inertia").is_some_and(is_against);
        interval("viscous").is_some_and(is_clear) && dry_agrees && !is_refuted
    },
    read: |effect, estimate| {
        let other = estimate.arm().joints()[estimate.other()?].name.clone();
        let dry = estimate.terms().into_iter().find(|term| term.is(&PAIR_SIGN));
        let mut effect = effect.with_other(other);
        let parts = [("viscous", &PAIR_VELOCITY), ("coulomb", &PAIR_SIGN), ("inertia", &PAIR_ACCELERATION)];
        for (key, law) in parts {
            let value = estimate.coefficient(key, estimate.at(law), 1.0);
            effect = effect.with(key, value);
        }
        Some(effect.with("sense", dry.map_or(1.0, |dry| dry.sizes[0])))
    },
    is_twin: |a, b| a.other() == b.other(),
    apply: |effect, at, machine| {
        let [viscous, coulomb, inertia, sense] =
            ["viscous", "coulomb", "inertia", "sense"].map(|key| effect.number(key));
        let torque = move |other: usize| {
            move |joint: usize, State { qd, qdd, .. }: State<'_>| {
                viscous * qd[other] + coulomb * sign(qd[joint] + sense * qd[other]) + inertia * qdd[other]
            }
        };
        // The reaction on the other joint has the same form, with the joints exchanged.
        machine.add_torque(at.other, None, torque(at.joint));
        machine.add_torque(at.joint, effect.onset(), torque(at.other));
    },
    ..Spec::EMPTY
};

/// Each of two joints feels the other's q̇, because a drive turns with both.
pub static PAIR_VELOCITY: Law = Law {
    name: "pair_velocity",
    column: |term, joint, motion| partner(term, joint).map(|other| motion.qd[other].clone()),
    ..Law::PLAIN
};

/// Each of two joints feels the other's q̈.
pub static PAIR_ACCELERATION: Law = Law {
    name: "pair_acceleration",
    column: |term, joint, motion| partner(term, joint).map(|other| motion.qdd[other].clone()),
    ..Law::PLAIN
};

/// The dry friction of a drive that two joints share: sgn of the sum of their q̇ (size 1) or of the difference (size −1).
pub static PAIR_SIGN: Law = Law {
    name: "pair_sign",
    column: |term, joint, motion| {
        let ([a, b], sense) = (term.of, term.sizes[0]);
        let turn = if joint == a { 1.0 } else { sense };
        partner(term, joint)
            .and_then(|_| motion.map(|k| turn * motion.scales.sign(a, motion.qd[a][k] + sense * motion.qd[b][k])))
    },
    ..Law::PLAIN
};

/// The other of two joints; `None` for a third joint.
fn partner(term: &Term, joint: usize) -> Option<usize> {
    let [a, b] = term.of;
    match joint {
        _ if joint == a => Some(b),
        _ if joint == b => Some(a),
        _ => None,
    }
}

/// A negative inertia that is larger than this multiple of the viscous friction (s) refutes a coupling. Smaller ones come from corrected
/// inertias of the links. Source: four simulated couplings without inertia have −0.0045 to 0.0016 s.
const NOTABLE_INERTIA: f64 = 0.01;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_columns_are_its_torques() {
        let effect = Effect::of(&TRANSMISSION_COUPLING).on("b").with_other("a");
        let effect = effect.with("viscous", 2.0).with("coulomb", 0.5).with("inertia", 3.0);
        let term = |law| Term::about(law, 1).of(0);
        let dry = term(&PAIR_SIGN).sized([1.0]);
        agree(&effect, &[(term(&PAIR_VELOCITY), 2.0), (dry, 0.5), (term(&PAIR_ACCELERATION), 3.0)]);
    }

    #[test]
    fn a_drive_has_friction_and_no_negative_inertia() {
        let is_certain = |viscous: [f64; 2], inertia: [f64; 2]| {
            let middle = |[low, high]: [f64; 2]| 0.5 * (low + high);
            let effect = Effect::of(&TRANSMISSION_COUPLING).on("b").with_other("a");
            let effect = effect.with("viscous", middle(viscous)).with("inertia", middle(inertia));
            let interval = |key: &str| match key {
                "viscous" => Some(viscous),
                "inertia" => Some(inertia),
                _ => None,
            };
            (TRANSMISSION_COUPLING.is_certain)(&effect, &interval, 0.05)
        };
        assert!(is_certain([1.0, 2.0], [0.1, 0.2]));
        assert!(is_certain([1.0, 2.0], [-0.1, 0.2]));
        // A drive that turns with the difference of the two joints.
        assert!(is_certain([-2.0, -1.0], [-0.2, -0.1]));
        assert!(!is_certain([-0.73, 1.17], [-1.3, -1.1]));
        assert!(!is_certain([-0.73, 1.17], [0.1, 0.2]));
        assert!(!is_certain([1.0, 2.0], [-1.3, -1.1]));
        // The inertias of corrected links leave a small one.
        assert!(is_certain([1.0, 2.0], [-0.01, -0.005]));
    }
}
