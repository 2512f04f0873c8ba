//! Stribeck friction: dry friction that is larger at very low speed.

use super::load_dependent::LOAD_SIGN;
use super::thermal::WARMING;
use crate::background::FRICTION_CURVE;
use crate::laws::{ABS_SIGN, SIGN};
use crate::{Against, Cone, Dry, Fitted, Form, Law, Parameter, Quantity, Range, Size, Spec, Systematic, Term, Turn};

/// τ = (coulomb + (breakaway − coulomb) e^(−|q̇/velocity|^exponent)) sgn q̇.
pub static STRIBECK_FRICTION: Spec = Spec {
    name: "stribeck_friction",
    title: "Stribeck friction",
    meaning: "Coulomb friction that is larger at very low speed (breakaway) than in fast motion",
    distinguished_by: "motions at constant speeds, from very slow to fast",
    formula: "(Fc + (Fs − Fc) e^(−|q̇/v|^δ)) sgn q̇",
    sentence: "friction that falls from {breakaway} at breakaway to {coulomb}, with a Stribeck velocity of {velocity}",
    parameters: &[
        Parameter::new("coulomb", Quantity::Torque).within(Range::NotNegative),
        Parameter::new("breakaway", Quantity::Torque).within(Range::NotNegative),
        Parameter::new("velocity", Quantity::Speed).within(Range::Positive),
        Parameter::new("exponent", Quantity::Ratio).within(Range::Positive).or(2.0).remarked(""),
    ],
    main: &["breakaway"],
    generalises: Some("coulomb_friction"),
    against: Against::Speed,
    forms: |grounds| {
        let mut forms = Vec::new();
        for joint in grounds.moving() {
            for share in VELOCITIES {
                for exponent in EXPONENTS {
                    let fading = Term::on(&FADING, joint).sized([share * grounds.scales.speed[joint], exponent]);
                    forms.push(Form::on(Turn::Friction, joint, vec![Term::on(&SIGN, joint), fading]));
                }
            }
        }
        forms
    },
    is_possible: |fitted| {
        let (coulomb, falling) = (fitted.value(0), fitted.value(1));
        let is_slow = fitted.term(1).sizes[0] <= FASTEST;
        is_slow && falling > 0.0 && coulomb > LEAST_COULOMB * falling && fades(fitted) && falls(fitted)
    },
    read: |effect, estimate| {
        let (a, b) = (estimate.place(0)?, estimate.place(1)?);
        let second = *estimate.terms().get(1)?;
        let [velocity, exponent, ..] = second.sizes;
        let level = estimate.level_beside(&[&WARMING, &ABS_SIGN, &LOAD_SIGN]);
        let coulomb = estimate.note("coulomb", |draw| level * draw[a]);
        let breakaway = estimate.note_within(Systematic::OfForm, "breakaway", &|draw| level * draw[a] + draw[b]);
        let velocity = estimate.size(Systematic::OfForm, "velocity", Size::Main, velocity);
        if estimate.shown(1) < FULLY_SHOWN {
            estimate.extend("breakaway", coulomb + EXTRAPOLATED * (breakaway - coulomb));
            estimate.extend("velocity", velocity / EXTRAPOLATED);
        }
        let effect = effect.with("coulomb", coulomb).with("breakaway", breakaway);
        Some(effect.with("velocity", velocity).with("exponent", exponent))
    },
    // If another dry friction of the joint states the Coulomb level, this one states only the additional breakaway
    // friction.
    own_sentence: |effect| {
        let text = "dry friction that is larger by {breakaway} at breakaway than in motion, \
             with a Stribeck velocity of {velocity}";
        (effect.number("coulomb") == 0.0).then_some(text)
    },
    dry_friction: |effect| Some(effect.number("coulomb")),
    apply: |effect, at, machine| {
        let [coulomb, breakaway, velocity, exponent] =
            ["coulomb", "breakaway", "velocity", "exponent"].map(|key| effect.number(key));
        let level = move |qd: f64, _| coulomb + (breakaway - coulomb) * fading(qd, velocity, exponent);
        machine.dry.push((at.joint, Dry::new(level)));
    },
    region: |terms, joint| {
        let speed = 2.0 * velocity(terms)?;
        Some(format!("below about {speed:.3} {}", Quantity::Speed.unit(joint)))
    },
    ..Spec::EMPTY
};

/// e^(−|q̇/velocity|^exponent) sgn q̇; sizes are the velocity (rad/s or m/s) and the exponent (1 or 2).
pub static FADING: Law = Law {
    name: "fading",
    column: |term, joint, motion| {
        let [velocity, exponent, ..] = term.sizes;
        motion.map(|k| fading(motion.qd[joint][k], velocity, exponent) * motion.sign(joint, k))
    },
    sizes: &[(Size::Main, 0)],
    other_form: Some(|term, factor| {
        let mut other = *term;
        other.sizes[1] = 3.0 - other.sizes[1];
        other.sizes[0] *= factor;
        (other, true)
    }),
    cone: Cone::Level(|_, _, _| 1.0),
    ..Law::PLAIN
};

/// The remaining share of the additional breakaway friction at a speed.
fn fading(qd: f64, velocity: f64, exponent: f64) -> f64 {
    (-(qd / velocity).abs().powf(exponent)).exp()
}

/// The velocity of the first Stribeck column in a list (rad/s or m/s).
pub fn velocity(terms: &[Term]) -> Option<f64> {
    let term = terms.iter().find(|term| term.always().is(&FADING))?;
    Some(term.sizes[0])
}

/// The largest Stribeck velocity (rad/s or m/s): friction that falls over a wider range of speeds belongs to the curve
/// of the viscous friction. Source: published ones of robot joints are 0.01 to 0.2 rad/s, those of simulated cases at
/// most 0.3.
const FASTEST: f64 = 0.5;

/// The least Coulomb friction of a joint in motion, as a part of the additional breakaway friction. Source: `prove`,
/// seeds 1 and 2, and two sets made with MuJoCo.
const LEAST_COULOMB: f64 = 0.1;

/// The largest part of the additional breakaway friction that the background may take back at standstill. Source:
/// simulated cases; true Stribeck friction loses 0.01 at most, friction that reaches its level gradually 1.5 and more.
const MOST_TAKEN_BACK: f64 = 0.5;

/// The part of the additional breakaway friction that some row in motion must show, because the filter blurs the change of the
/// sign at reversals. Source: 44 simulated cases of four published arms with Stribeck velocities of 0.03 to 0.15 rad/s
/// show 0.3 and more.
const LEAST_SHOWN: f64 = 0.25;
/// If rows in motion show less than this part, the intervals extend to the sizes that the rows do not exclude. Source: the same cases; with more,
/// 19 of 19 sizes are within 15 % of the truth.
const FULLY_SHOWN: f64 = 0.6;
/// Where the rows show only a part, the additional breakaway friction may be larger by this factor, with a Stribeck velocity that is smaller
/// by it. Source: the same cases, 3.3; the three-joint arm at 0.01 rad/s, 11.
const EXTRAPOLATED: f64 = 12.0;
/// A row is slow if more than this part of the additional breakaway friction remains there.
const FADED: f64 = 0.5;
/// The part of the moving rows that may be slow: otherwise the effect is no friction at low speed.
const MOST_SLOW: f64 = 0.5;

/// The velocities at which the friction has fallen that are tried first, as shares of the largest speed.
const VELOCITIES: [f64; 6] = [0.05, 0.08, 0.12, 0.18, 0.27, 0.4];
/// The exponents that are tried first.
const EXPONENTS: [f64; 2] = [1.0, 2.0];

/// Whether friction with the background's curve is larger at standstill than in motion. Friction that reaches its level
/// gradually has a background that is negative at low speed, and the additional friction only corrects that curve.
fn falls(fitted: &dyn Fitted) -> bool {
    let curve = fitted.term(1).joint.map(|joint| Term::on(&FRICTION_CURVE, joint));
    let taken_back = curve.map_or(0.0, |curve| -fitted.background(&curve));
    taken_back < MOST_TAKEN_BACK * fitted.value(1)
}

/// Whether moving rows show a part of the additional friction, and on most of them it has fallen below half, so that it is a
/// friction at low speed.
fn fades(fitted: &dyn Fitted) -> bool {
    let Some(x) = fitted.column(1) else { return false };
    let (mut moving, mut slow, mut most) = (0_usize, 0_usize, 0.0_f64);
    for (x, _) in x.iter().zip(fitted.moving()).filter(|(_, moving)| **moving) {
        moving += 1;
        slow += usize::from(x.abs() > FADED);
        most = most.max(x.abs());
    }
    (slow as f64) < MOST_SLOW * moving as f64 && most > LEAST_SHOWN
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn its_columns_are_its_torque() {
        let effect = Effect::of(&STRIBECK_FRICTION).on("a").with("coulomb", 1.0);
        let effect = effect.with("breakaway", 3.0).with("velocity", 0.7);
        let fading = Term::on(&FADING, 0).sized([0.7, 2.0]);
        agree(&effect, &[(Term::on(&SIGN, 0), 1.0), (fading, 2.0)]);
    }
}
