//! Torque that is applied later than it is commanded.

use crate::{
    Detectability, Experiment, Form, Law, Parameter, Quantity, Range, Size, Spec, Systematic, Term, Turn, UNIT,
};

/// The experiment that distinguishes elasticity and backlash from a delay.
pub(super) const SECOND_ENCODER: Experiment = Experiment {
    rank: 4,
    text: "record a second encoder on the link side of the gear: it shows backlash and elasticity, and no delay",
};

/// The torque applied at t is the one commanded at t − `delay`.
pub static ACTUATION_DELAY: Spec = Spec {
    name: "actuation_delay",
    title: "actuation delay",
    meaning: "the torque is applied later than it is commanded",
    distinguished_by: "sinusoidal motions at several frequencies",
    formula: "applied(t) = commanded(t − T)",
    sentence: "a delay of {delay} between commanded and applied torque",
    parameters: &[Parameter::new("delay", Quantity::Time).within(Range::NotNegative)],
    main: &["delay"],
    // A link behind a gap or a spring also lags.
    excludes: &["backlash", "joint_elasticity"],
    // Neither of two in the cases of `torque_scale` was right; they were up to 1.1 times as large.
    least_beside_residual: Some(1.5),
    is_simulated: true,
    experiment: Some(SECOND_ENCODER),
    detectability: Detectability::Sized {
        because: "a shorter delay may change the torque by too little to be detected",
        if_none: "a delay as long as a drive may have changes the torque by too little to be detected surely",
        is_seen_below: false,
    },
    not_testable_turn: 5,
    forms: |grounds| {
        let forms = |joint| {
            [0.002, 0.004, 0.006, 0.009, 0.013, 0.02, 0.027].map(|delay| {
                let terms = vec![Term::on(&LATE, joint).sized([delay])];
                Form::on(Turn::Late, joint, terms)
            })
        };
        let accelerates = |&joint: &usize| grounds.inertial[joint] >= LEAST_INERTIAL;
        grounds.moving().filter(accelerates).flat_map(forms).collect()
    },
    is_possible: |fitted| {
        let is_short = |term: Term| !term.is(&LATE) || term.sizes[0] < 1.001 * LONGEST_DELAY;
        UNIT.contains(&fitted.value(0)) && (0..fitted.len()).all(|k| is_short(fitted.term(k)))
    },
    // The link behind a gap also lags, by longer than a drive does.
    is_certain: |effect, _, _| effect.number("delay") <= LONGEST_NAMED,
    read: |effect, estimate| {
        let delay = estimate.terms().first()?.sizes[0];
        let delay = estimate.simulated(Systematic::OfForm, "delay", |drawn, size| (delay * (drawn + size)).max(0.0));
        Some(effect.with("delay", delay))
    },
    // Delays add up.
    is_twin: |_, _| false,
    of_command: |effect, joint| Some(Term::on(&LATE, joint).sized([effect.number("delay")])),
    apply: |effect, at, machine| machine.delays[at.joint] += effect.number("delay"),
    ..Spec::EMPTY
};

/// τ(t) − τ(t − delay) of the measured torque; the size is the delay (s).
pub static LATE: Law = Law {
    name: "late",
    column: |term, joint, motion| Some(late(&motion.tau[joint], term.sizes[0] / motion.period)),
    sizes: &[(Size::Main, 0)],
    uses_measured_torque: true,
    ..Law::PLAIN
};

/// sgn q̇(t) − sgn q̇(t − delay), for a coefficient of one: dry friction that turns round late; the size is the delay (s).
pub static LATE_SIGN: Law = Law {
    name: "late_sign",
    column: |term, joint, motion| {
        let signs = motion.map(|k| motion.sign(joint, k))?;
        Some(late(&signs, term.sizes[0] / motion.period))
    },
    sizes: &[(Size::Main, 0)],
    ..Law::PLAIN
};

/// A lag (s) whose column stands for those of other short lags, which are nearly proportional to it.
pub const UNIT_LAG: f64 = 0.005;

/// The longest delay of a drive (s). A position loop with a longer one is unstable. Source: first diagnosis.
const LONGEST_DELAY: f64 = 0.03;
/// The longest delay that is named (s); a longer one is tried, so that it does not seem to be this long. Source: four delays in 320 cases of
/// `prove` were false, of 23 to 30 ms, and each was a gap; the longest true one of all simulated cases has 14 ms.
const LONGEST_NAMED: f64 = 0.02;

/// The part of the joint's torque that accelerations must need. A delay shows where the torque changes quickly; gravity
/// and friction change slowly or at reversals, where a delay and a dependence on the velocity look alike. Source: a
/// real robot on which a delay of 26 ms was named where nothing accelerates.
const LEAST_INERTIAL: f64 = 0.05;

/// The signal minus itself `ticks` earlier, by cubic interpolation; zero before the signal began.
fn late(signal: &[f64], ticks: f64) -> Vec<f64> {
    let whole = ticks.floor();
    let part = ticks - whole;
    let back = whole as usize;
    // Catmull-Rom weights at the fraction `part` of a tick towards the past.
    let weights = [
        -0.5 * part + part * part - 0.5 * part.powi(3),
        1.0 - 2.5 * part * part + 1.5 * part.powi(3),
        0.5 * part + 2.0 * part * part - 1.5 * part.powi(3),
        -0.5 * part * part + 0.5 * part.powi(3),
    ];
    let at = |place: i64| signal[place.clamp(0, signal.len() as i64 - 1) as usize];
    (0..signal.len())
        .map(|k| {
            let base = k as i64 - back as i64;
            let before: f64 = (0..4).map(|w| weights[w] * at(base + 1 - w as i64)).sum();
            signal[k] - before
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Effect;
    use crate::test_support::machine;

    #[test]
    fn delays_add_up() {
        let effect = Effect::of(&ACTUATION_DELAY).on("b").with("delay", 0.004);
        assert_eq!(machine(&effect).delays, [0.0, 0.004]);
    }

    #[test]
    fn a_longer_delay_than_drives_have_is_not_certain() {
        for (delay, certain) in [(0.004, true), (0.0199, true), (0.023, false), (LONGEST_DELAY, false)] {
            let effect = Effect::of(&ACTUATION_DELAY).on("b").with("delay", delay);
            assert_eq!((ACTUATION_DELAY.is_certain)(&effect, &|_| None, 0.0), certain, "{delay}");
        }
    }

    /// Cubic interpolation delays a parabola exactly, also by fractions of a tick.
    #[test]
    fn delays_are_exact_on_parabolas() {
        let signal: Vec<f64> = (0..40).map(|k| 0.3 * f64::from(k) - 0.02 * f64::from(k * k)).collect();
        for ticks in [0.3, 1.0, 2.7] {
            let late = late(&signal, ticks);
            for k in 6..34 {
                let before = k as f64 - ticks;
                let expected = signal[k] - (0.3 * before - 0.02 * before * before);
                assert!((late[k] - expected).abs() < 1e-12, "{ticks} {k}");
            }
        }
    }
}
