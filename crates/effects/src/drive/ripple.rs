//! A torque that repeats with the joint's angle.

use crate::laws::{is_same_wave, sine_and_cosine, wave};
use crate::{Against, Law, Parameter, Quantity, Size, Spec, State, Systematic, Term};

/// τ = amplitude sin(periods q + phase).
pub static TORQUE_RIPPLE: Spec = Spec {
    name: "torque_ripple",
    title: "torque ripple",
    meaning: "a torque that repeats with the joint's angle (cogging, gear teeth)",
    distinguished_by: "the same sweep at two speeds: a ripple has a constant period in angle, a resonance in time",
    formula: "A sin(N q + φ)",
    sentence: "a torque ripple of {amplitude} with {periods} periods per revolution",
    parameters: &[
        Parameter::new("amplitude", Quantity::Torque),
        Parameter::new("periods", Quantity::Ratio).remarked("per revolution"),
        Parameter::new("phase", Quantity::Angle),
    ],
    main: &["amplitude"],
    // The only one in the cases of `torque_scale` was wrong, and 1.2 times as large.
    least_beside_residual: Some(1.5),
    is_suggested: true,
    may_repeat: true,
    is_periodic: true,
    against: Against::Position,
    // None: the residuals suggest the periods.
    forms: |_| Vec::new(),
    // Two ripples of nearly the same period are not distinguished.
    is_same: |a, b| is_same_wave(a, b, SAME_PERIODS),
    read: |effect, estimate| {
        let (a, b) = (estimate.place(0)?, estimate.place(1)?);
        let periods = estimate.terms().first()?.sizes[0];
        let about = estimate.best()[b].atan2(estimate.best()[a]);
        let amplitude = estimate.note("amplitude", |draw| draw[a].hypot(draw[b]));
        let periods = estimate.size(Systematic::Usual, "periods", Size::Periods, periods);
        let phase = estimate.note("phase", |draw| about + around(draw[b].atan2(draw[a]) - about));
        let effect = effect.with("amplitude", amplitude).with("periods", periods);
        Some(effect.with("phase", phase))
    },
    // A part that turns with the joint repeats a whole number of times per revolution; only a motor before a gear may have any
    // ratio.
    is_certain: |effect, interval, _| {
        let whole = effect.number("periods").round();
        let holds = |[low, high]: [f64; 2]| whole >= 1.0 && (low..=high).contains(&whole);
        interval("periods").is_none_or(|own| own[1] >= LEAST_GEARED || holds(own))
    },
    // A joint has one ripple for each ratio at which its parts turn.
    is_twin: |a, b| a.number("periods") == b.number("periods"),
    apply: |effect, at, machine| {
        let [amplitude, periods, phase] = ["amplitude", "periods", "phase"].map(|key| effect.number(key));
        let torque = move |joint: usize, state: State<'_>| amplitude * wave(periods * state.q[joint] + phase, false);
        machine.add_torque(at.joint, effect.onset(), torque);
    },
    ..Spec::EMPTY
};

/// sin (form 0) or cos (form 1) of periods × q; the size is the number of periods (rad/rad).
pub static RIPPLE: Law = Law {
    name: "ripple",
    column: |term, joint, motion| motion.map(|k| wave(term.sizes[0] * motion.q[joint][k], term.form == 1)),
    sizes: &[(Size::Periods, 0)],
    nudges: &[|term, step| term.sized([term.sizes[0] * (1.0 + 0.02 * step)])],
    ..Law::PLAIN
};

/// The columns of a ripple on a joint.
pub fn columns(joint: usize, periods: f64) -> Vec<Term> {
    sine_and_cosine(&RIPPLE, joint, periods)
}

/// The least ratio of a gear, as periods per revolution of the joint: a motor before a gear turns at least this often,
/// and its poles and teeth repeat more often. Source: a real robot on which a ripple of 4.27 periods was named.
const LEAST_GEARED: f64 = 8.0;

/// The relative difference of periods below which two ripples are the same. Source: first diagnosis.
const SAME_PERIODS: f64 = 0.2;

/// An angle within half a turn of zero.
fn around(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::agree;

    #[test]
    fn a_slow_ripple_repeats_with_the_joint_itself() {
        let is_certain = |periods: f64, half: f64| {
            let effect = Effect::of(&TORQUE_RIPPLE).on("a").with("periods", periods);
            (TORQUE_RIPPLE.is_certain)(&effect, &|_| Some([periods - half, periods + half]), 0.05)
        };
        assert!(is_certain(4.05, 0.1));
        assert!(!is_certain(4.27, 0.1));
        assert!(!is_certain(0.2, 0.3));
        assert!(is_certain(33.4, 0.1));
    }

    #[test]
    fn its_columns_are_its_torque() {
        let effect = Effect::of(&TORQUE_RIPPLE).on("a").with("amplitude", 0.5);
        let effect = effect.with("periods", 6.0).with("phase", 0.1);
        let columns = columns(0, 6.0);
        agree(&effect, &[(columns[0], 0.5 * 0.1_f64.cos()), (columns[1], 0.5 * 0.1_f64.sin())]);
    }
}
