//! A drive that turns its link through a spring.

use super::delay::SECOND_ENCODER;
use crate::compliance::{Compliant, LinkSide, noise_behind, sprung};
use crate::fitted::is_near_one;
use crate::laws::ACCELERATION;
use crate::{Detectability, Form, Law, Parameter, Quantity, Range, Size, Spec, Sprung, Systematic, Term, Turn};

/// The rotor drives the link through a spring and a damper; q is the rotor's position.
pub static JOINT_ELASTICITY: Spec = Spec {
    name: "joint_elasticity",
    title: "joint elasticity",
    meaning: "the drive moves the link through an elastic transmission (belt, harmonic drive)",
    distinguished_by: "a second encoder on the link, or a resonance that changes with the load",
    formula: "a spring and damper between drive and link",
    sentence: "a transmission stiffness of {stiffness} between drive and link",
    parameters: &[
        Parameter::new("stiffness", Quantity::Stiffness).within(Range::Positive),
        Parameter::new("damping", Quantity::Damping).within(Range::NotNegative),
    ],
    main: &["stiffness"],
    // In the same cases as those of `external_contact`, two springs that were liquid in the tool had 1.0, and the others 2.2 and more.
    least_over_error: Some(1.5),
    generalises: Some("rotor_inertia"),
    brings: Some("rotor_inertia"),
    prior: 8.0,
    is_simulated: true,
    experiment: Some(SECOND_ENCODER),
    detectability: Detectability::Sized {
        because: "a stiffer joint may deflect too little to be detected",
        if_none: "a joint of any usual stiffness may deflect too little to be detected",
        is_seen_below: true,
    },
    not_testable_turn: 4,
    // Stiffnesses at which the link resonates at a list of frequencies.
    forms: |grounds| {
        let mut forms = Vec::new();
        for joint in grounds.moving() {
            let mass = grounds.mass[joint];
            if mass <= 0.0 {
                continue;
            }
            for hertz in RESONANCES {
                let omega = 2.0 * std::f64::consts::PI * hertz;
                let sizes = [mass * omega * omega, 2.0 * DAMPING_RATIO * mass * omega];
                let terms = vec![Term::about(&ELASTIC, joint).sized(sizes), Term::on(&ACCELERATION, joint)];
                forms.push(Form::on(Turn::Compliance, joint, terms));
            }
        }
        forms
    },
    is_possible: |fitted| is_near_one(fitted),
    read: |effect, estimate| {
        let [stiffness, damping, ..] = estimate.terms().first()?.sizes;
        let stiffness = estimate
            .simulated(Systematic::OfArm, "stiffness", |drawn, size| stiffness / (drawn - size).clamp(0.4, 2.5));
        let damping = estimate.size(Systematic::FromAbove, "damping", Size::Damping, damping);
        Some(effect.with("stiffness", stiffness).with("damping", damping))
    },
    noise_gain: |term, mass, cutoff| {
        let [stiffness, damping, ..] = term.sizes;
        noise_behind(stiffness, damping, mass, cutoff)
    },
    apply: |effect, at, machine| {
        machine.springs[at.joint] =
            Some(Sprung { stiffness: effect.number("stiffness"), damping: effect.number("damping") });
    },
    ..Spec::EMPTY
};

/// The torque of the link's motion behind an elastic joint, for a coefficient of one; sizes are stiffness (N m/rad) and damping
/// (N m s/rad).
pub static ELASTIC: Law = Law {
    name: "elastic",
    column: |term, joint, motion| Some(link_side(term, motion).torque(joint, motion.rigid)),
    needs_model: true,
    needs_derivatives: true,
    sizes: &[(Size::Main, 0), (Size::Damping, 1)],
    link_side: Some(link_side),
    ..Law::PLAIN
};

fn link_side(term: &Term, motion: &crate::Signals<'_>) -> LinkSide {
    let (joint, [stiffness, damping, ..]) = (term.of[0], term.sizes);
    LinkSide::new(Compliant::Joint(joint), sprung(joint, 0.0, stiffness, |_| damping, motion))
}

/// The frequencies at which the link swings on the springs that are tried first (Hz).
const RESONANCES: [f64; 8] = [2.5, 3.5, 5.0, 7.0, 10.0, 14.0, 20.0, 28.0];
/// The damping ratio that is tried first. Source: first diagnosis.
const DAMPING_RATIO: f64 = 0.06;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::{column, machine};

    #[test]
    fn it_is_the_drives_spring() {
        let effect = Effect::of(&JOINT_ELASTICITY).on("a");
        let effect = effect.with("stiffness", 1e4).with("damping", 3.0);
        let spring = machine(&effect).springs[0].expect("there is a spring");
        assert_eq!((spring.stiffness, spring.damping), (1e4, 3.0));
    }

    /// A stiff joint adds no noise, a resonance within the filter's band adds a multiple of the rigid link's.
    #[test]
    fn a_resonance_amplifies_noise() {
        let gain = |hertz: f64, ratio: f64| {
            let omega = std::f64::consts::TAU * hertz;
            let term = Term::about(&ELASTIC, 0).sized([2.0 * omega * omega, 2.0 * ratio * 2.0 * omega]);
            (JOINT_ELASTICITY.noise_gain)(&term, 2.0, 12.0)
        };
        assert!(gain(1000.0, 0.06) < 1e-3, "{}", gain(1000.0, 0.06));
        assert!(gain(12.0, 0.06) > 5.0, "{}", gain(12.0, 0.06));
        assert!(gain(12.0, 0.03) > 1.5 * gain(12.0, 0.06));
    }

    /// With a very stiff spring, the torque is that of the rigid arm.
    #[test]
    fn a_stiff_joint_is_rigid() {
        let (soft, _) = column(&Term::about(&ELASTIC, 0).sized([1e3, 3.0]), 0);
        let (stiff, _) = column(&Term::about(&ELASTIC, 0).sized([1e9, 3e3]), 0);
        let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        assert!(most(&stiff) < 1e-3 * most(&soft), "{} {}", most(&stiff), most(&soft));
    }
}
