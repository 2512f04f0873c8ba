//! A drive whose torque is limited.

use crate::{Detectability, Effect, Fitted, Form, Law, Parameter, Quantity, Range, Size, Spec, Systematic, Term, Turn};

/// The torque applied is the commanded one, clipped at ± limit.
pub static TORQUE_SATURATION: Spec = Spec {
    name: "torque_saturation",
    title: "torque saturation",
    meaning: "the drive's torque is limited, whatever is commanded",
    distinguished_by: "one motion that requires more than the limit, and one that does not",
    formula: "applied = commanded, clipped to ± limit",
    sentence: "a torque limit of {limit}",
    parameters: &[Parameter::new("limit", Quantity::Torque).within(Range::Positive)],
    main: &["limit"],
    // In the same cases as those of `external_contact`, three limits that the recorded torque exceeds had 1.9 to 4.5, and the others 23 and
    // more.
    least_over_error: Some(6.0),
    // The torque that a contact needs may be the largest of a recording, so that an error of the contact's form looks like a limit.
    least_beside: &[("external_contact", 1.0)],
    // Neither of two in the cases of `torque_scale` was right; they were up to 0.9 times as large.
    least_beside_residual: Some(1.5),
    is_simulated: true,
    detectability: Detectability::Limit {
        because: "no torque limit shows",
        if_none: "no limit that this motion allows would remove enough torque to show",
    },
    not_testable_turn: 2,
    forms: |grounds| {
        let mut forms = Vec::new();
        for joint in grounds.moving() {
            for share in WOUND_UP.into_iter().chain(LIMITS) {
                let limit = share * grounds.largest[joint];
                // A drive that gave this torque is not limited far below it.
                if limit < BELOW_NEED * grounds.needed[joint] {
                    continue;
                }
                let terms = vec![Term::on(&EXCESS, joint).sized([limit])];
                forms.push(Form::on(Turn::Limit, joint, terms));
            }
        }
        forms
    },
    is_possible: |fitted| {
        // A drive is at its limit for a part of the time only.
        CUT_OFF.contains(&fitted.value(0)) && acting(fitted) < MOST_CLIPPED && cuts(fitted)
    },
    is_contradicted: |effect, beside| {
        let is_here = |other: &&Effect| other.joint() == effect.joint();
        let friction = beside.iter().filter(is_here);
        let friction: f64 = friction.filter_map(|other| (other.spec().dry_friction)(other)).sum();
        effect.number("limit") < LEAST_OVER_FRICTION * friction
    },
    read: |effect, estimate| {
        let limit = estimate.terms().first()?.sizes[0];
        let limit = estimate.size(Systematic::Usual, "limit", Size::Main, limit);
        Some(effect.with("limit", limit))
    },
    // The lower limit counts.
    is_twin: |_, _| false,
    of_command: |effect, joint| Some(Term::on(&EXCESS, joint).sized([effect.number("limit")])),
    apply: |effect, at, machine| machine.limits[at.joint] = machine.limits[at.joint].min(effect.number("limit")),
    region: |terms, joint| {
        let limit = terms.first()?.sizes[0];
        let unit = Quantity::Torque.unit(joint);
        Some(format!("where more than {limit:.3} {unit} are commanded"))
    },
    ..Spec::EMPTY
};

/// The part of the commanded torque that a limit removes, τ − clip τ; the size is the limit (N m or N).
pub static EXCESS: Law = Law {
    name: "excess",
    column: |term, joint, motion| {
        let limit = term.sizes[0];
        motion.map(|k| {
            let tau = motion.tau[joint][k];
            tau - tau.clamp(-limit, limit)
        })
    },
    sizes: &[(Size::Main, 0)],
    cuts: true,
    ..Law::PLAIN
};

/// The coefficient that a limit may have. It removes all torque beyond it, so that the coefficient is one; a torque
/// scale changes it. Source: first diagnosis.
const CUT_OFF: std::ops::RangeInclusive<f64> = 0.8..=1.25;
/// The largest part of the power beyond the limit that may remain with the limit in the model. If more remains, the
/// motion shows that the drive gave more torque. Source: a real robot on which a limit of 31 N m was named although 8.5
/// % of the rows are above it.
const MOST_REMAINING: f64 = 0.5;
/// The largest part of the moving rows that a torque limit may clip. Source: first diagnosis.
const MOST_CLIPPED: f64 = 0.45;
/// The least torque limit, as a part of the torque that the motion needs by the model, which may be wrong. Source: two simulated
/// arms with URDFs wrong by 30 %; a value of 0.7 excluded the limit of one, and 0.45 that of the other.
const BELOW_NEED: f64 = 0.4;
/// The least torque limit, as a multiple of the joint's dry friction. With a lower limit, the drive could hardly move
/// the joint, and a torque that is mostly dry friction looks clipped at the friction level. Source: the TIAGo, on whose
/// joint arm_1 a limit of 3.4 N m was named beside 3.3 N m of friction.
const LEAST_OVER_FRICTION: f64 = 1.3;

/// The limits that are tried first, as shares of the largest commanded torque. They are so close to each other that the coefficient
/// of one of them is within [`CUT_OFF`] if the true limit is 0.2 to 0.97 of this torque.
const LIMITS: [f64; 15] = [0.2, 0.27, 0.36, 0.45, 0.55, 0.65, 0.73, 0.8, 0.83, 0.86, 0.885, 0.91, 0.93, 0.95, 0.965];
/// The limits that are tried first beside [`LIMITS`]: a position loop may command many times the torque that the drive can give.
const WOUND_UP: [f64; 7] = [0.027, 0.036, 0.048, 0.064, 0.085, 0.11, 0.15];

/// Whether the torque that the limit removes is the residual of the model without it, on the rows where it acts.
fn cuts(fitted: &dyn Fitted) -> bool {
    let Some(x) = fitted.column(0) else { return true };
    let (mut with, mut without) = (0.0, 0.0);
    for ((x, left), moving) in x.iter().zip(fitted.residual()).zip(fitted.moving()) {
        if *moving && *x != 0.0 {
            with += left * left;
            without += (left + fitted.value(0) * x).powi(2);
        }
    }
    with <= MOST_REMAINING * without
}

/// A limit acts on a row if its column exceeds this part of its largest value. Source: first diagnosis.
const ACTS: f64 = 0.02;
/// A limit also acts on a row if its column exceeds this part of the limit. Source: a simulated wrist that lost its load, on which a
/// limit of 0.4 % of the largest torque was named, although 60 % of the torques are above it.
const ACTS_OF_LIMIT: f64 = 0.5;

/// The part of the moving rows on which the limit acts.
fn acting(fitted: &dyn Fitted) -> f64 {
    let Some(x) = fitted.column(0) else { return 0.0 };
    let largest = x.iter().fold(0.0_f64, |largest, v| largest.max(v.abs()));
    let moving = || x.iter().zip(fitted.moving()).filter(|(_, moving)| **moving);
    let least = (ACTS * largest).min(ACTS_OF_LIMIT * fitted.term(0).sizes[0]);
    let acting = moving().filter(|(x, _)| x.abs() > least).count();
    acting as f64 / moving().count().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::COULOMB_FRICTION;
    use crate::test_support::{column, machine};

    /// The torque of a slow joint that has only dry friction is constant at the friction level, which resembles a limit.
    #[test]
    fn a_limit_just_above_the_dry_friction_is_refused() {
        let limit = |limit: f64| Effect::of(&TORQUE_SATURATION).on("a").with("limit", limit);
        let friction = |joint: &str| Effect::of(&COULOMB_FRICTION).on(joint).with("level", 3.3);
        assert!((TORQUE_SATURATION.is_contradicted)(&limit(3.4), &[friction("a")]));
        assert!(!(TORQUE_SATURATION.is_contradicted)(&limit(3.4), &[friction("b")]));
        assert!(!(TORQUE_SATURATION.is_contradicted)(&limit(6.6), &[friction("a")]));
    }

    #[test]
    fn one_of_the_first_limits_has_a_possible_coefficient() {
        for thousandths in 200..=970 {
            let limit = f64::from(thousandths) / 1e3;
            let is_possible = |tried: &f64| CUT_OFF.contains(&((1.0 - limit) / (1.0 - tried)));
            assert!(LIMITS.iter().any(is_possible), "{limit}");
        }
    }

    #[test]
    fn its_column_is_the_clipped_torque() {
        let effect = Effect::of(&TORQUE_SATURATION).on("a").with("limit", 2.5);
        assert_eq!(machine(&effect).limits, [2.5, f64::INFINITY]);
        let (cut, tau) = column(&Term::on(&EXCESS, 0).sized([2.5]), 0);
        for (cut, tau) in cut.iter().zip(tau) {
            assert_eq!(tau - cut, tau.clamp(-2.5, 2.5));
        }
    }
}
