//! A gap in the gear.

use super::delay::SECOND_ENCODER;
use crate::compliance::{Compliant, LinkSide, gap, noise_behind, sprung};
use crate::fitted::is_near_one;
use crate::laws::ACCELERATION;
use crate::{Detectability, Form, Law, Parameter, Quantity, Range, Signals, Size, Spec, Systematic, Term, Turn};

/// The rotor drives the link through a gap of ± `halfgap`; q is the rotor's position.
pub static BACKLASH: Spec = Spec {
    name: "backlash",
    title: "backlash",
    meaning: "a gap in the gear that is crossed at each reversal",
    distinguished_by: "the same reversals while gravity loads the gear, which keeps the gap closed",
    formula: "a gap between drive and link with compliant ends",
    sentence: "a gap of ± {halfgap} in the gear",
    parameters: &[Parameter::new("halfgap", Quantity::Position).within(Range::NotNegative)],
    main: &["halfgap"],
    generalises: Some("rotor_inertia"),
    brings: Some("rotor_inertia"),
    prior: 8.0,
    is_simulated: true,
    experiment: Some(SECOND_ENCODER),
    detectability: Detectability::Sized {
        because: "a smaller gap may be crossed too quickly to be detected",
        if_none: "the load on the joint hardly changes its sign, so that a gap may never be crossed",
        is_seen_below: false,
    },
    not_testable_turn: 3,
    // Forms with rigid and with compliant ends.
    forms: |grounds| {
        let mut forms = Vec::new();
        for joint in grounds.moving() {
            let mut add = |turn, sizes: [f64; 3]| {
                let terms = vec![Term::about(&GAP, joint).sized(sizes), Term::on(&ACCELERATION, joint)];
                forms.push(Form::on(turn, joint, terms));
            };
            let mass = grounds.mass[joint];
            let halfgaps = GAPS.map(|share| share * grounds.scales.range[joint].min(1.5));
            for halfgap in halfgaps {
                add(Turn::Late, [halfgap, f64::INFINITY, 1.0]);
            }
            for halfgap in halfgaps.into_iter().filter(|_| mass > 0.0) {
                for ratio in STOP_RATIOS {
                    add(Turn::Compliance, [halfgap, stop(mass, STOP_FREQUENCY), ratio]);
                }
            }
        }
        forms
    },
    is_possible: |fitted| is_near_one(fitted),
    read: |effect, estimate| {
        let halfgap = estimate.terms().first()?.sizes[0];
        let halfgap = estimate.simulated(Systematic::OfForm, "halfgap", |drawn, size| {
            // Beside effects that do not fit, the coefficient of a gap may be negative; the gap is not.
            (halfgap * (drawn + size)).max(0.0)
        });
        Some(effect.with("halfgap", halfgap))
    },
    // Where the gap is closed, compliant ends are a spring.
    noise_gain: |term, mass, cutoff| {
        let [_, stop, ratio, ..] = term.sizes;
        if stop.is_finite() { noise_behind(stop, damping(stop, ratio, mass), mass, cutoff) } else { 0.0 }
    },
    // A coefficient below zero, beside effects that do not fit, is no gap.
    is_certain: |effect, _, _| effect.number("halfgap") > 0.0,
    apply: |effect, at, machine| machine.gaps[at.joint] += effect.number("halfgap"),
    ..Spec::EMPTY
};

/// The torque of the link's motion behind a gap, for a coefficient of one. Sizes are half the gap (rad), the stiffness of its
/// ends (N m/rad; infinite for rigid ends) and their damping ratio with the link's inertia (from 1 on, the link does not
/// bounce).
pub static GAP: Law = Law {
    name: "gap",
    column: |term, joint, motion| Some(link_side(term, motion).torque(joint, motion.rigid)),
    needs_model: true,
    needs_derivatives: true,
    sizes: &[(Size::Main, 0), (Size::Stop, 1)],
    other_form: Some(|term, factor| {
        let mut other = *term;
        if !term.sizes[1].is_finite() {
            return (other, false);
        }
        other.sizes[2] *= factor.powi(2);
        (other, factor != 1.0)
    }),
    softened,
    link_side: Some(link_side),
    ..Law::PLAIN
};

fn link_side(term: &Term, motion: &Signals<'_>) -> LinkSide {
    let (joint, [halfgap, stop, ratio, _]) = (term.of[0], term.sizes);
    let ticks = if stop.is_finite() {
        sprung(joint, halfgap, stop, |mass| damping(stop, ratio, mass), motion)
    } else {
        gap(joint, halfgap, motion)
    };
    LinkSide::new(Compliant::Joint(joint), ticks)
}

/// The damping ratios of a gap's ends that are tried first: one without bouncing, one with it. Source: `prove`, seeds
/// 1, 2, 3, 7, 2026 and 2027, where ends of gaps bounce.
const STOP_RATIOS: [f64; 2] = [1.0, 0.2];

/// The gaps that are tried first, as shares of the range of the motion. Source: the smaller ones from twelve simulated
/// gaps of 0.9 to 23 mrad made with MuJoCo, of which eleven are found (eight without them).
const GAPS: [f64; 9] = [0.0007, 0.0013, 0.0025, 0.004, 0.008, 0.014, 0.022, 0.035, 0.06];

/// The frequency at which the link swings against compliant ends of a gap, before it is refined (Hz). Source: `prove`,
/// seeds 7 and 2026, whose gaps were 8 to 20 % too large with rigid ends.
const STOP_FREQUENCY: f64 = 20.0;

/// The frequencies that are tried first where a gap was found with rigid ends (Hz). Source: as for [`STOP_FREQUENCY`].
const FIRST_STOPS: [f64; 3] = [12.0, 20.0, 32.0];

/// The stiffness of ends (N m/rad) on which a link with an inertia swings at a frequency (Hz).
fn stop(mass: f64, hertz: f64) -> f64 {
    mass * (2.0 * std::f64::consts::PI * hertz).powi(2)
}

/// The damping (N m s/rad) of ends with this stiffness (N m/rad) and damping ratio for a link of inertia `mass`.
fn damping(stop: f64, ratio: f64, mass: f64) -> f64 {
    2.0 * ratio * (stop * mass.max(0.0)).sqrt()
}

/// The forms of a gap with compliant ends that are tried in place of a gap with rigid ends, for a link of inertia `mass`
/// (kg m² or kg).
fn softened(term: &Term, mass: f64) -> Vec<Term> {
    let [halfgap, rigid, ..] = term.sizes;
    if rigid.is_finite() {
        return Vec::new();
    }
    let first = FIRST_STOPS.iter().flat_map(|&hertz| STOP_RATIOS.map(|ratio| (hertz, ratio)));
    first.map(|(hertz, ratio)| term.sized([halfgap, stop(mass, hertz), ratio])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::{column, machine};

    #[test]
    fn gaps_add_up() {
        let effect = Effect::of(&BACKLASH).on("a").with("halfgap", 0.001);
        assert_eq!(machine(&effect).gaps, [0.001, 0.0]);
    }

    /// Noise of the positions passes compliant ends as it passes a spring, and a coefficient below zero is read as a gap of zero.
    #[test]
    fn noise_behind_compliant_ends_is_no_gap() {
        let gain = |stop: f64| (BACKLASH.noise_gain)(&Term::about(&GAP, 0).sized([0.001, stop, 0.2]), 2.0, 12.0);
        assert!(gain(f64::INFINITY) == 0.0);
        assert!(gain(stop(2.0, 8.0)) > 0.3, "{}", gain(stop(2.0, 8.0)));
        let is_certain = |halfgap: f64| {
            let effect = Effect::of(&BACKLASH).on("a").with("halfgap", halfgap);
            (BACKLASH.is_certain)(&effect, &|_| None, 0.0)
        };
        assert!(is_certain(0.001) && !is_certain(0.0));
    }

    #[test]
    fn a_gap_of_zero_adds_nothing() {
        let (none, _) = column(&Term::about(&GAP, 0).sized([0.0, f64::INFINITY, 1.0]), 0);
        assert!(none.iter().all(|torque| *torque == 0.0), "{none:?}");
    }
}
