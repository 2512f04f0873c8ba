//! A torque that depends on the joint's position.

use crate::laws::{ONE, POSITION, TENT, power, tent};
use crate::{
    Against, Detectability, Effect, Fitted, Form, Parameter, Quantity, SetsIn, Shape, Spec, State, Term, Times, Turn,
};

/// τ = stiffness (q − rest); for a nonlinear spring, a curve through (q, τ) points: linear between them, constant beyond.
pub static SPRING: Spec = Spec {
    name: "spring",
    title: "spring",
    meaning: "a torque that depends on the joint's position (counterbalance, gas spring, cable)",
    distinguished_by: "slow sweeps over the whole range, with and without a payload",
    formula: "K (q − q₀), or a curve over the position where the spring is nonlinear",
    sentence: "a spring torque with a stiffness of {stiffness} and its zero at {rest}",
    parameters: &[
        Parameter::new("stiffness", Quantity::Stiffness),
        Parameter::new("rest", Quantity::Position),
        Parameter::new("curve", Quantity::Torque).of(Shape::Points).remarked("rad, N m"),
    ],
    main: &["stiffness"],
    may_end: true,
    may_be_inertial: true,
    may_set_in: true,
    generalises: Some("torque_offset"),
    excludes: &["own_position", "torque_offset", "friction_asymmetry"],
    is_beyond_the_drive: true,
    against: Against::Position,
    detectability: Detectability::LINEAR,
    not_testable_turn: 11,
    forms: |grounds| {
        let forms = |joint| {
            [
                Form::on(Turn::Position, joint, columns(joint, &[1])),
                Form::on(Turn::Position, joint, columns(joint, &[1, 2, 3])),
                // A curve that rises throughout is a spring; any other curve is an unmodelled form.
                Form::on(Turn::Curve, joint, grounds.tents(joint, joint, POINTS, Times::One)),
            ]
        };
        grounds.moving().flat_map(forms).collect()
    },
    sets_in: Some(SetsIn { turn: 2, forms: |joint| vec![columns(joint, &[1])], looked_for_with: 2 }),
    is_possible: |fitted| stiffens(fitted) && rests_in_reach(fitted),
    read: |effect, estimate| {
        let [low, high] = estimate.positions();
        let terms = estimate.terms();
        let shape: Vec<(Term, Option<usize>)> =
            terms.into_iter().enumerate().map(|(k, term)| (term.always(), estimate.place(k))).collect();
        let reached = reached(&shape, estimate.best());
        let torque = |draw: &[f64], q: f64| -> f64 {
            let q = reached.map_or(q, |[first, last]| q.clamp(first, last));
            let drawn = |&(term, place): &(Term, Option<usize>)| (term, place.map_or(0.0, |place| draw[place]));
            torque(&shape.iter().map(drawn).collect::<Vec<_>>(), q)
        };
        let slope = |draw: &[f64]| (torque(draw, high) - torque(draw, low)) / (high - low);
        let stiffness = estimate.note("stiffness", slope);
        let middle = 0.5 * (low + high);
        let rest = estimate.note("rest", |draw| middle - torque(draw, middle) / slope(draw));
        let points = if shape.len() == 2 { 0 } else { POINTS };
        let curve: Vec<[f64; 2]> = (0..points)
            .map(|k| {
                let q = low + (high - low) * k as f64 / (points - 1) as f64;
                [q, torque(estimate.best(), q)]
            })
            .collect();
        let effect = effect.with("stiffness", stiffness);
        Some(effect.with("rest", rest).with("curve", curve).since(estimate.onset()))
    },
    refuse: |effect| {
        let pair = effect.points("curve").windows(2).find(|pair| pair[1][0] <= pair[0][0])?;
        Some(("curve's next angle", pair[1][0], "larger than the one before"))
    },
    // A straight spring and a curve on one joint are not the same effect.
    // Two springs without a curve are one spring, with the zero of their common torque.
    sum: |a, b| {
        let have_no_curve = [a, b].iter().all(|spring| spring.points("curve").is_empty());
        let stiffness = a.number("stiffness") + b.number("stiffness");
        let torque = |spring: &Effect| spring.number("stiffness") * spring.number("rest");
        let rest = (torque(a) + torque(b)) / stiffness;
        (have_no_curve && rest.is_finite()).then(|| a.clone().with("stiffness", stiffness).with("rest", rest))
    },
    is_twin: |a, b| a == b || [a, b].iter().all(|spring| spring.points("curve").is_empty()),
    apply: |effect, at, machine| {
        let points = effect.points("curve").to_vec();
        if points.is_empty() {
            let (stiffness, rest) = (effect.number("stiffness"), effect.number("rest"));
            let torque = move |joint: usize, state: State<'_>| stiffness * (state.q[joint] - rest);
            machine.add_torque(at.joint, effect.onset(), torque);
        } else {
            let torque = move |joint: usize, state: State<'_>| interpolate(&points, state.q[joint]);
            machine.add_torque(at.joint, effect.onset(), torque);
        }
    },
    ..Spec::EMPTY
};

/// A point of a curve is used if the moving joint comes close enough for its tent function to reach this value. Source:
/// `prove`, seeds 1 and 2, and two sets made with MuJoCo.
const VISITED: f64 = 0.5;
/// The largest part of its total rise by which a spring's curve may fall between two points, due to noise. Source: as
/// for [`VISITED`].
const LARGEST_FALL: f64 = 0.05;
/// The largest part of its total rise by which a spring's curve may fall over all its points together. Source: as for
/// [`VISITED`].
const ALL_FALLS: f64 = 0.1;
/// The number of parts of the recorded range between which the slope of a curve is evaluated. Source: first diagnosis.
const SLOPES: i32 = 20;
/// The least number of these slopes that are positive for a spring: a curve that falls elsewhere is no spring. Source:
/// first diagnosis.
const LEAST_RISING: usize = 17;
/// The points of a curve. Source: first diagnosis.
const POINTS: usize = 12;

/// The farthest rest position of a spring, beyond the recorded range, as a multiple of that range, unless it is within
/// the joint's range. A spring with a farther rest position is almost a constant torque. Source: two real robots, on
/// four joints of which springs about −11.8 or 14.1 rad took the place of an offset.
const BEYOND: f64 = 1.0;

fn columns(joint: usize, powers: &[usize]) -> Vec<Term> {
    let powers = powers.iter().map(|&power| Term::on(&POSITION, joint).form(power));
    std::iter::once(Term::on(&ONE, joint)).chain(powers).collect()
}

/// Linear between points in order of their first number, constant beyond; 0 without points.
fn interpolate(points: &[[f64; 2]], x: f64) -> f64 {
    let after = points.partition_point(|point| point[0] <= x);
    match (after.checked_sub(1).map(|before| points[before]), points.get(after)) {
        (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some([_, y]), None) | (None, Some(&[_, y])) => y,
        (None, None) => 0.0,
    }
}

/// Whether a spring pulls back: its torque grows with the angle over nearly all of the range.
fn stiffens(fitted: &dyn Fitted) -> bool {
    let all = || 0..fitted.len();
    let is_visited = |k: usize| {
        let column = fitted.column(k);
        column.is_some_and(|x| x.iter().zip(fitted.moving()).any(|(x, moving)| *moving && *x > VISITED))
    };
    let tents: Vec<f64> = all()
        .filter(|&k| fitted.term(k).is(&TENT) && is_visited(k) && fitted.value(k) != 0.0)
        .map(|k| fitted.value(k))
        .collect();
    if let (Some(first), Some(last)) = (tents.first(), tents.last()) {
        let rise = last - first;
        let falls = || tents.windows(2).map(|pair| (pair[0] - pair[1]).max(0.0));
        return rise > 0.0 && falls().all(|fall| fall < LARGEST_FALL * rise) && falls().sum::<f64>() < ALL_FALLS * rise;
    }
    let is_position = |k: &usize| {
        let term = fitted.term(*k).always();
        term.is(&POSITION) && power(&term) == 1
    };
    let Some(x) = all().find(is_position).and_then(|k| fitted.column(k)) else {
        return false;
    };
    let (low, high) = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    let slope = |q: f64| -> f64 {
        all()
            .map(|k| {
                let term = fitted.term(k).always();
                if term.is(&POSITION) {
                    let power = power(&term);
                    f64::from(power) * q.powi(power - 1) * fitted.value(k)
                } else {
                    0.0
                }
            })
            .sum()
    };
    let rising = (0..=SLOPES).filter(|&k| slope(low + (high - low) * f64::from(k) / f64::from(SLOPES)) > 0.0).count();
    rising >= LEAST_RISING
}

/// Whether the joint can reach the angle without torque, by the straight line between the ends of the recorded range.
fn rests_in_reach(fitted: &dyn Fitted) -> bool {
    let terms: Vec<(Term, f64)> = (0..fitted.len()).map(|k| (fitted.term(k).always(), fitted.value(k))).collect();
    let is_straight = |(term, _): &(Term, f64)| term.is(&POSITION) && power(term) == 1;
    let (low, high) = match terms.iter().position(is_straight).and_then(|k| fitted.column(k)) {
        // A column is zero before its onset.
        Some(x) => range(x.iter().copied().filter(|&q| q != 0.0)),
        None => range(terms.iter().filter(|(term, _)| term.is(&TENT)).map(|(term, _)| term.sizes[0])),
    };
    let rising = torque(&terms, high) - torque(&terms, low);
    if !(high > low && rising != 0.0) {
        return false;
    }
    let middle = 0.5 * (low + high);
    let rest = middle - torque(&terms, middle) * (high - low) / rising;
    let limits = terms.first().map(|(term, _)| fitted.arm().joints()[term.of[0]].limits);
    let (lower, upper) = limits.map_or((low, high), |limits| (limits.lower, limits.upper));
    let margin = BEYOND * (high - low);
    let own = low - margin..=high + margin;
    own.contains(&rest) || (lower.is_finite() && upper.is_finite() && (lower..=upper).contains(&rest))
}

/// The least and the largest of some numbers.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// The first and the last point of a curve that the fitted recordings reach: the others have coefficients of zero. `None` for springs without
/// a curve.
fn reached(shape: &[(Term, Option<usize>)], best: &[f64]) -> Option<[f64; 2]> {
    let tents = || shape.iter().filter(|(term, _)| term.is(&TENT));
    let size = |place: &Option<usize>| place.map_or(0.0, |place| best[place].abs());
    let largest = tents().map(|(_, place)| size(place)).fold(0.0, f64::max);
    let mut centres = tents().filter(|(_, place)| size(place) > NOT_FITTED * largest).map(|(term, _)| term.sizes[0]);
    let first = centres.next()?;
    Some([first, centres.next_back().unwrap_or(first)])
}

/// The part of the largest coefficient of a curve up to which one was not fitted. Source: rounding.
const NOT_FITTED: f64 = 1e-9;

/// The torque of a spring's terms with their coefficients at an angle (N m or N).
fn torque(terms: &[(Term, f64)], q: f64) -> f64 {
    let one = |&(term, value): &(Term, f64)| {
        if term.is(&ONE) {
            value
        } else if term.is(&POSITION) {
            value * q.powi(power(&term))
        } else if term.is(&TENT) {
            value * tent(q, term.sizes[0], term.sizes[1])
        } else {
            0.0
        }
    };
    terms.iter().map(one).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::agree;

    #[test]
    fn its_columns_are_its_torque() {
        let effect = Effect::of(&SPRING).on("a").with("stiffness", 10.0).with("rest", 0.2);
        let columns = columns(0, &[1]);
        agree(&effect, &[(columns[0], -2.0), (columns[1], 10.0)]);
    }

    /// The curve is constant beyond the points that the recordings reach, whose coefficients are not zero.
    #[test]
    fn a_curve_ends_where_it_was_fitted() {
        let tent = |k: usize| (Term::on(&TENT, 0).sized([0.1 * k as f64, 0.1]), Some(k));
        let shape: Vec<_> = (0..5).map(tent).collect();
        assert_eq!(reached(&shape, &[1e-15, -2.0, 0.5, 3.0, 0.0]), Some([0.1, 0.1 * 3.0]));
        assert_eq!(reached(&shape, &[-3.0, -2.0, 0.5, 3.0, 4.0]), Some([0.0, 0.4]));
        let straight: Vec<_> = columns(0, &[1]).into_iter().map(|term| (term, Some(0))).collect();
        assert_eq!(reached(&straight, &[1.0]), None);
    }

    /// A straight spring on a joint that was recorded from −0.5 to 0.5 rad.
    struct Straight {
        arm: ::arm::Arm,
        values: [f64; 2],
        columns: [Vec<f64>; 2],
    }

    impl Fitted for Straight {
        fn len(&self) -> usize {
            2
        }
        fn term(&self, k: usize) -> Term {
            columns(0, &[1])[k]
        }
        fn value(&self, k: usize) -> f64 {
            self.values[k]
        }
        fn background(&self, _: &Term) -> f64 {
            0.0
        }

        fn column(&self, k: usize) -> Option<&[f64]> {
            Some(&self.columns[k])
        }
        fn residual(&self) -> Vec<f64> {
            vec![0.0; 3]
        }
        fn moving(&self) -> &[bool] {
            &[true; 3]
        }
        fn is_trial(&self) -> bool {
            false
        }
        fn arm(&self) -> &::arm::Arm {
            &self.arm
        }
    }

    #[test]
    fn a_spring_rests_where_the_joint_may_be() {
        let is_possible = |limit: &str, rest: f64| {
            let kind = if limit.is_empty() { "continuous" } else { "revolute" };
            let urdf = format!(
                r#"<robot name="one"><link name="base"/><joint name="a" type="{kind}"><parent link="base"/><child link="l"/>
<axis xyz="0 0 1"/>{limit}</joint><link name="l"><inertial><mass value="1"/>
<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link></robot>"#
            );
            (SPRING.is_possible)(&Straight {
                arm: ::arm::Arm::from_urdf_text(&urdf, "one.urdf").expect("it is an arm"),
                values: [-2.0 * rest, 2.0],
                columns: [vec![1.0; 3], vec![-0.5, 0.1, 0.5]],
            })
        };
        let limits = r#"<limit lower="-3" upper="3" effort="9" velocity="9"/>"#;
        assert!(is_possible(limits, 0.2) && is_possible(limits, 2.9) && is_possible("", 1.4));
        assert!(!is_possible(limits, -11.8) && !is_possible(limits, 14.1) && !is_possible("", 1.6));
    }

    #[test]
    fn a_curve_is_linear_between_its_points() {
        let points = [[-1.0, 4.0], [0.0, 2.0], [1.0, 3.0]];
        for (q, expected) in [(-2.0, 4.0), (-0.5, 3.0), (0.0, 2.0), (0.25, 2.25), (9.0, 3.0)] {
            assert_eq!(interpolate(&points, q), expected);
        }
    }
}
