//! Dry friction that falls as the drive warms up.

use crate::laws::{ABS_SIGN, SIGN};
use crate::{
    Against, Circumstance, Cone, Detectability, Dry, Experiment, Form, Law, Parameter, Quantity, Range, Size, Spec,
    Systematic, Term, Turn,
};

/// The shortest time constant of a drive that warms (s). Source: first diagnosis.
pub const FASTEST_WARMING: f64 = 8.0;

/// Dry friction coulomb (1 + amplitude e^(−(t − start)/time_constant)) sgn q̇, t on the recordings' own clock.
pub static THERMAL_DRIFT: Spec = Spec {
    name: "thermal_drift",
    title: "warming friction",
    meaning: "Coulomb friction that falls as the drive warms up",
    distinguished_by: "a longer recording of one repeated motion that starts with a cold drive",
    formula: "Coulomb friction × (1 + a e^(−(t − t₀)/T))",
    sentence: "Coulomb friction of {coulomb} on the warm drive, larger by {amplitude%} % at first, \
               with a time constant of {time_constant}",
    parameters: &[
        Parameter::new("coulomb", Quantity::Torque).within(Range::NotNegative).remarked("N m, when warm"),
        Parameter::new("amplitude", Quantity::Ratio)
            .within(Range::AtLeastMinusOne)
            .remarked("of the warm level, at time t₀"),
        Parameter::new("time_constant", Quantity::Time).within(Range::Positive),
        Parameter::new("start", Quantity::Time).or(0.0).remarked("s, t₀; 0 where the clock begins with the recordings"),
    ],
    main: &["amplitude"],
    generalises: Some("coulomb_friction"),
    prior: 8.0,
    may_be_in_one_recording: true,
    against: Against::TimeAlong,
    experiment: Some(Experiment {
        rank: 3,
        text: "record the same motion with the cold and with the warm drive, on one clock",
    }),
    detectability: Detectability::Linear {
        if_no_form: Some("the recordings are shorter than the time that a drive takes to warm up"),
        is_of_first: true,
        is_of_all_torque: false,
    },
    not_testable_turn: 8,
    forms: |grounds| {
        let constants = TIME_CONSTANTS.map(|share| share * grounds.span.unwrap_or(0.0));
        // A drive does not warm up faster than this.
        let constants: Vec<f64> = constants.into_iter().filter(|time| *time >= FASTEST_WARMING).collect();
        let start = start(grounds.times.first().map_or(0.0, |&(begins, _)| begins));
        let mut forms = Vec::new();
        for joint in grounds.moving() {
            for &time_constant in &constants {
                let warming = Term::on(&WARMING, joint).sized([time_constant, start]);
                forms.push(Form::on(Turn::Friction, joint, vec![Term::on(&SIGN, joint), warming]));
            }
        }
        forms
    },
    is_possible: |fitted| {
        let (warm, cold) = (fitted.value(0), fitted.value(1));
        let is_slow = |term: Term| !term.is(&WARMING) || term.sizes[0] > REFINED * FASTEST_WARMING;
        cold > 0.0 && warm > 0.0 && cold < MOST_COLD * warm && (0..fitted.len()).all(|k| is_slow(fitted.term(k)))
    },
    // The final fit, beside other effects, may leave hardly any warm friction.
    is_certain: |effect, _, _| effect.number("amplitude") < MOST_COLD,
    read: |effect, estimate| {
        let (a, b) = (estimate.place(0)?, estimate.place(1)?);
        let second = *estimate.terms().get(1)?;
        let uneven = estimate.on_joint(&ABS_SIGN);
        let level = |draw: &[f64]| draw[a] - uneven.map_or(0.0, |uneven| draw[uneven].abs());
        let coulomb = estimate.note("coulomb", level);
        let amplitude = estimate.note("amplitude", |draw| draw[b] / level(draw));
        let time_constant = estimate.size(Systematic::Usual, "time_constant", Size::Main, second.sizes[0]);
        let start = second.sizes[1];
        if start != 0.0 {
            estimate.start(start, 0.0);
        }
        let effect = effect.with("coulomb", coulomb).with("amplitude", amplitude).with("start", start);
        Some(effect.with("time_constant", time_constant))
    },
    apply: |effect, at, machine| {
        let [coulomb, amplitude, time_constant, start] =
            ["coulomb", "amplitude", "time_constant", "start"].map(|key| effect.number(key));
        let level = move |_, at: Circumstance| {
            let cold = at.time.map_or(0.0, |time| cold(time, [time_constant, start, 0.0, 0.0]));
            coulomb * (1.0 + amplitude * cold)
        };
        machine.dry.push((at.joint, Dry::new(level)));
    },
    ..Spec::EMPTY
};

/// e^(−(t − start)/time constant) sgn q̇; the sizes are the time constant and the start (s).
pub static WARMING: Law = Law {
    name: "warming",
    column: |term, joint, motion| motion.map(|k| cold(motion.time(k), term.sizes) * motion.sign(joint, k)),
    sizes: &[(Size::Main, 0)],
    cone: Cone::Level(|term, _, time| cold(time, term.sizes)),
    ..Law::PLAIN
};

/// The share of the additional cold friction that remains at `time` (s); it is one at the start.
fn cold(time: f64, [time_constant, start, ..]: [f64; 4]) -> f64 {
    (-(time - start) / time_constant).exp()
}

/// If the first time stamp is later than this (s), the clock began with a controller or a computer and not with the
/// recordings.
const OWN_CLOCK: f64 = 60.0;

/// The time for which the amplitude is given (s), for recordings that begin at `begins`.
fn start(begins: f64) -> f64 {
    if begins.abs() > OWN_CLOCK { begins.floor() } else { 0.0 }
}

/// Refinement may shorten a time constant to this part of [`FASTEST_WARMING`]. Source: first diagnosis.
const REFINED: f64 = 0.7;
/// The largest additional friction of a cold drive, as a multiple of the warm friction. Source: first diagnosis.
const MOST_COLD: f64 = 4.0;

/// The time constants that are tried first, as shares of the time from the first recording to the last.
const TIME_CONSTANTS: [f64; 5] = [0.15, 0.25, 0.4, 0.6, 1.0];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    /// Friction that is ten times as large on the cold drive as on the warm one is no friction.
    #[test]
    fn a_cold_drive_has_a_limited_friction() {
        let drift = |amplitude: f64| Effect::of(&THERMAL_DRIFT).on("a").with("amplitude", amplitude);
        assert!((THERMAL_DRIFT.is_certain)(&drift(2.0), &|_| None, 0.0));
        assert!(!(THERMAL_DRIFT.is_certain)(&drift(9.7), &|_| None, 0.0));
    }

    #[test]
    fn its_columns_are_its_torque() {
        let effect = Effect::of(&THERMAL_DRIFT).on("a").with("coulomb", 2.0);
        let effect = effect.with("amplitude", 0.5).with("time_constant", 10.0);
        let warming = Term::on(&WARMING, 0).sized([10.0]);
        agree(&effect, &[(Term::on(&SIGN, 0), 2.0), (warming, 1.0)]);
        let later = Term::on(&WARMING, 0).sized([10.0, -3.0]);
        agree(&effect.with("start", -3.0), &[(Term::on(&SIGN, 0), 2.0), (later, 1.0)]);
    }
}
