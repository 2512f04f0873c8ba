//! A measured torque that is a constant multiple of the true one.

use super::torque_offset::KNOWN_LOAD;
use crate::laws::RIGID;
use crate::{Against, Detectability, Effect, Fitted, Parameter, Quantity, Range, Scaled, SetsIn, Spec, Term, Turn};

/// The measured torque is `factor` times the true one.
pub static TORQUE_SCALE: Spec = Spec {
    name: "torque_scale",
    title: "torque scale",
    meaning: "the measured torque is a constant multiple of the true torque (wrong gain or torque constant)",
    distinguished_by: "a known payload",
    formula: "measured = k × true",
    sentence: "a measured torque of {factor} times the true torque",
    parameters: &[Parameter::new("factor", Quantity::Ratio)
        .within(Range::Positive)
        .neutral_at(1.0)
        .remarked("measured over true")],
    main: &["factor"],
    may_set_in: true,
    is_certain_in_form: true,
    may_be_inertial: true,
    may_be_hidden: true,
    usual: Some(USUAL),
    // Unmodelled structure of the residual resembles a factor on the load. Of the seven that were named beside an unexplained residual of
    // their joint in about 1000 simulated cases of three engines, none was right; they were up to 5.0 times as large.
    least_beside_residual: Some(6.0),
    // Both multiply the load: one that of the drive, the other that of the link.
    least_beside: &[("load_dependent_friction", 0.3)],
    against: Against::Load,
    experiment: Some(KNOWN_LOAD),
    experiments_against: &[("inertial_scale", KNOWN_BODY), ("link_inertial_error", KNOWN_BODY)],
    // The rigid torque alone determines it, but it is a part of the joint's whole torque.
    detectability: Detectability::Linear { if_no_form: None, is_of_first: false, is_of_all_torque: true },
    not_testable_turn: 10,
    forms: |grounds| grounds.on_moving(Turn::Drive, |joint| vec![Term::on(&RIGID, joint)]),
    sets_in: Some(SetsIn { turn: 1, forms: |joint| vec![vec![Term::on(&RIGID, joint)]], looked_for_with: 1 }),
    is_possible: |fitted| {
        let [least, most] = USUAL;
        let relative = fitted.value(0);
        (least..=most).contains(&relative) || RELATIVE.contains(&relative) && is_of_another_unit(fitted)
    },
    is_certain: |effect, interval, accuracy| {
        let factor = effect.number("factor");
        let is_usual = (USUAL[0]..=USUAL[1]).contains(&(factor - 1.0));
        // A unit is a number that is known well, unless the arm's torque explains nothing.
        let is_narrow = |[low, high]: [f64; 2]| high - low < factor;
        is_beyond_tolerance(effect, accuracy) && (is_usual || interval("factor").is_none_or(is_narrow))
    },
    read: |effect, estimate| {
        let at = estimate.place(0)?;
        let factor = estimate.note("factor", |draw| 1.0 + draw[at]);
        let onset = estimate.onset();
        Some(effect.since(onset).with("factor", factor))
    },
    sum: |a, b| Some(a.clone().with("factor", a.number("factor") * b.number("factor"))),
    apply: |effect, at, machine| {
        machine.factors.push(Scaled { joint: at.joint, factor: effect.number("factor"), onset: effect.onset() });
    },
    ..Spec::EMPTY
};

const KNOWN_BODY: &str = "attach a body of known mass to the tool and record the same motion: a torque scale changes its apparent weight, \
     wrong link masses do not";

/// The least deviation of a scale from one, in standard deviations of the torque constants. A smaller deviation is
/// within the tolerance. Source: scales of 5 and 6 % were named with a limit of 4 %, and every drive may have them.
const USUAL_DEVIATIONS: f64 = 1.5;

/// The relative deviation from one that a torque scale may have: that of a torque in another unit, or on the other side of a gear.
const RELATIVE: std::ops::Range<f64> = -0.9995..1999.0;

/// The usual relative deviations from one. Beyond them, the torque is in another unit. Source: first diagnosis.
const USUAL: [f64; 2] = [-0.7, 2.0];

/// The least torque of the arm in another unit, as a multiple of what remains unexplained on the joint (root mean squares). Source: a simulated
/// joint whose positions jump: a factor of 0.16 made the torque smaller that noise is differentiated to, and had 1.1.
const LEAST_OF_ANOTHER_UNIT: f64 = 2.0;

/// Whether the arm's torque in another unit explains most of the measured torque.
fn is_of_another_unit(fitted: &dyn Fitted) -> bool {
    let power = |signal: &[f64]| -> f64 {
        let moving = signal.iter().zip(fitted.moving()).filter(|(_, moving)| **moving);
        moving.map(|(value, _)| value * value).sum()
    };
    let factor = 1.0 + fitted.value(0);
    let of_arm = |column: &[f64]| factor * factor * power(column);
    fitted.column(0).is_some_and(|column| of_arm(column) > LEAST_OF_ANOTHER_UNIT.powi(2) * power(&fitted.residual()))
}

/// Whether the factor of `effect` deviates from one by more than torque constants of this `accuracy`, a relative standard deviation, do.
pub(crate) fn is_beyond_tolerance(effect: &Effect, accuracy: f64) -> bool {
    (effect.number("factor") - 1.0).abs() >= USUAL_DEVIATIONS * accuracy
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{along, column, machine};

    #[test]
    fn a_scale_within_the_accuracy_of_torque_constants_is_not_certain() {
        let is_certain = |factor: f64, accuracy: f64| {
            let effect = Effect::of(&TORQUE_SCALE).on("a").with("factor", factor);
            (TORQUE_SCALE.is_certain)(&effect, &|_| None, accuracy)
        };
        assert!(!is_certain(0.937, 0.05) && !is_certain(1.052, 0.05));
        assert!(is_certain(0.92, 0.05) && is_certain(1.08, 0.05));
        // With better known torque constants, a smaller deviation counts.
        assert!(is_certain(0.966, 0.02));
    }

    /// The column is the rigid torque: a factor of 1.5 adds half of it.
    #[test]
    fn its_column_is_the_rigid_torque() {
        let effect = Effect::of(&TORQUE_SCALE).on("a").with("factor", 1.5);
        assert_eq!(machine(&effect).factors[0].factor, 1.5);
        let (rigid, _) = column(&Term::on(&RIGID, 0), 0);
        assert!(rigid.iter().any(|torque| *torque != 0.0));
    }

    /// A factor that sets in multiplies friction, too, and the fit knows the friction from the time before.
    #[test]
    fn since_an_onset_its_column_is_the_whole_torque() {
        along(|motion| {
            let rest = vec![vec![3.0; motion.ticks()]; 2];
            let mut motion = *motion;
            motion.rigid.rest = &rest;
            let onset = motion.time(motion.ticks() / 2);
            let column = Term::on(&RIGID, 0).since(onset).column(0, &motion).unwrap_or_default();
            for (tick, torque) in column.into_iter().enumerate() {
                let whole = motion.rigid.tau[0][tick] + 3.0;
                assert_eq!(torque, if motion.time(tick) < onset { 0.0 } else { whole }, "at tick {tick}");
            }
            let always = Term::on(&RIGID, 0).column(0, &motion);
            assert_eq!(always.as_ref(), Some(&motion.rigid.tau[0]));
        });
    }
}
