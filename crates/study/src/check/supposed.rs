//! The search for a supposition on signs, order and zeros that explains a recording's torques far better than all others.

use arm::Arm;

use super::Misfit;
use super::column_map::{Change, Value};
use super::smooth::Smooth;
use super::supposition::{EXPLAINED, Fit, Supposition, fit};

/// A supposition must reduce the sum of the joints' log residuals by at least this much.
pub const GAIN: f64 = 2.0;
/// A joint's torque is not explained if its residual has at least this share of its variance, and explained in full below the other.
pub const NOT_EXPLAINED: f64 = 0.5;
const IN_FULL: f64 = 0.05;
/// A wrong zero leaves at least this share of the variance of some joint's torque unexplained. A centre of mass that lies elsewhere than
/// in the URDF may leave less, and look like a turned joint. Source: simulated arms with URDFs wrong by 3 to 30 %, where five of seven
/// false warnings were at 0.08 to 0.14; 70 of 84 zeros off by a quarter of a turn, of those that are seen at all, leave more.
const OF_A_ZERO: f64 = 0.28;
/// The number of joints, not explained before and in full with it, from which a wrong zero or order of two joints is certain. A link
/// whose centre of mass lies elsewhere than in the URDF is seen so at its own joint, if the links beyond it are light.
const CERTAIN: usize = 2;

/// A supposition must be better than the next one by at least this reduction of the sum of log residuals.
const LEAD: f64 = 1.0;

/// The contradiction that follows from the supposition that explains the torques far better than all others; `None` if
/// there is no such supposition. `as_it_is` is the fit of the recording without a supposition. A wrong zero or a swap that is certain
/// prevents a diagnosis.
pub fn supposed(arm: &Arm, smooth: &Smooth, moves: &[bool], names: &[&str], as_it_is: &Fit) -> Option<Misfit> {
    let mut scored: Vec<(f64, Supposition, Fit)> = Supposition::all(arm, moves)
        .into_iter()
        .map(|supposition| {
            let fit = fit(arm, smooth, supposition);
            (as_it_is.score() - fit.score(), supposition, fit)
        })
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (gain, best, fit) = scored.first()?;
    let next = scored[1..]
        .iter()
        .find(|(_, other, _)| !best.same_joint(*other) && !best.same_signs(*other));
    let lead = gain - next.map_or(0.0, |next| next.0);
    let close = next.filter(|_| lead <= LEAD).map(|(_, other, _)| *other);
    // A base on a wall or on a ceiling is an effect that the diagnosis finds, not an error of the recording.
    let is_base = |supposition: Supposition| matches!(supposition, Supposition::Gravity(_));
    if *gain <= GAIN || is_base(*best) || close.is_some_and(|other| is_base(other) && !best.is_of_all_signs()) {
        return None;
    }
    // Of two suppositions that explain the torques about equally well, the better one is reported and the other is
    // mentioned. Both must explain much.
    if close.is_some() && *gain <= 2.0 * GAIN {
        return None;
    }
    let beside = match close {
        None => String::new(),
        Some(other) if is_base(other) => ", or the base hangs from a ceiling or a wall".to_owned(),
        Some(other) => other
            .words(names)
            .map_or(String::new(), |words| format!(", or {words}")),
    };
    let is_doubtful = close.is_some_and(is_base);
    let rivals = || {
        let near = |(next, other, _): &&(f64, Supposition, Fit)| best.same_joint(*other) && gain - next < LEAD;
        scored[1..].iter().filter(near).map(|(_, other, _)| *other)
    };
    let good = |joint: &usize| {
        fit.residual_share[*joint] < EXPLAINED
            && as_it_is.residual_share[*joint] > 3.0 * fit.residual_share[*joint].max(0.02)
    };
    let no_worse = |joint: usize| {
        fit.residual_share[joint] < EXPLAINED && fit.residual_share[joint] <= as_it_is.residual_share[joint]
    };
    // How much of the torque of `joint` is explained with and without the supposition.
    let evidence = |joint: usize| {
        let share = |fit: &Fit| (100.0 * (1.0 - fit.residual_share[joint])).round();
        format!(
            "with this correction, the model and friction explain {} % of the torque's variance at {}; without it, {} %{beside}",
            share(fit),
            names[joint],
            share(as_it_is)
        )
    };
    let change = |joint: usize, key, value| Change::new(names[joint], key, Value::Number(value));
    let exchanged = |what: &str, keys: &[&'static str], shown_at: usize, a: usize, b: usize| {
        let text = format!(
            "the {what} of {} and {} seem swapped; correct the header, or map the columns (--map): {}",
            names[a],
            names[b],
            evidence(shown_at)
        );
        let pairs = [(a, b), (b, a)];
        let of = |key: &'static str| {
            pairs.map(|(at, other)| Change::new(names[at], key, Value::ColumnOf(names[other].to_owned())))
        };
        Some(Misfit::new(None, text, keys.iter().flat_map(|key| of(key)).collect()))
    };
    let explained: Vec<usize> = (0..arm.dof()).filter(|joint| good(joint)).collect();
    let all = |text: &str, keys: &[&'static str]| {
        let text = format!("{text}: {}", evidence(explained[0]));
        // If the base may hang from a ceiling, the signs may be right, and no map is proposed.
        let joints = if is_doubtful { 0..0 } else { 0..arm.dof() };
        let changes = joints.flat_map(|joint| keys.iter().map(move |key| change(joint, key, -1.0)));
        Some(Misfit::new(None, text, changes.collect()))
    };
    let in_order = |what: &str, keys: &[&'static str]| {
        let text = format!(
            "the {what} seem to be in the opposite order, tip to base; correct the header, or map the columns (--map): {}",
            evidence(explained[0])
        );
        let last = arm.dof() - 1;
        let of = |joint: usize| {
            let column = Value::ColumnOf(names[last - joint].to_owned());
            keys.iter()
                .map(move |key| Change::new(names[joint], key, column.clone()))
        };
        Some(Misfit::new(None, text, (0..=last).flat_map(of).collect()))
    };
    let becomes_clear =
        |&joint: &usize| as_it_is.residual_share[joint] > NOT_EXPLAINED && fit.residual_share[joint] < IN_FULL;
    let is_of_places = matches!(
        best,
        Supposition::Zero(..)
            | Supposition::Swapped(..)
            | Supposition::TorquesSwapped(..)
            | Supposition::PositionsSwapped(..)
    );
    let is_certain = close.is_none() && is_of_places && (0..arm.dof()).filter(becomes_clear).count() >= CERTAIN;
    let misfit = match *best {
        Supposition::AllTorquesFlipped if explained.len() > 1 => all(
            "the torques of all joints have the sign opposite to the URDF's axes; invert them (tau_sign = -1 for each joint in a \
             column map)",
            &["tau_sign"],
        ),
        Supposition::AllPositionsFlipped if explained.len() > 1 => all(
            "the positions of all joints have the sign opposite to the URDF's axes; invert them (sign = -1 and tau_sign = -1 for \
             each joint in a column map)",
            &["sign", "tau_sign"],
        ),
        Supposition::AllFlipped if explained.len() > 1 => all(
            "positions and torques of all joints have the sign opposite to the URDF's axes; invert both (sign = -1 for each joint \
             in a column map)",
            &["sign"],
        ),
        Supposition::Reversed if explained.len() > 1 => in_order("columns of the joints", &["q", "qd", "tau"]),
        Supposition::TorquesReversed if explained.len() > 1 => in_order("torques of the joints", &["tau"]),
        Supposition::Flipped(joint) | Supposition::TorqueFlipped(joint) if good(&joint) => {
            let inverted = |keys: &[&'static str]| keys.iter().map(|key| change(joint, key, -1.0)).collect();
            let (text, changes): (_, Vec<Change>) = if rivals().any(|other| matches!(other, Supposition::Zero(..))) {
                (
                    "the torque or the position has the sign opposite to the URDF's axis, or the position's zero is off by π; \
                  check one after the other (tau_sign, sign, q_offset in a column map)",
                    Vec::new(),
                )
            } else if rivals().next().is_some() {
                (
                    "the torque or the position has the sign opposite to the URDF's axis; invert one (tau_sign = -1, or \
                  sign and tau_sign, in a column map)",
                    inverted(&["tau_sign"]),
                )
            } else if matches!(best, Supposition::TorqueFlipped(_)) {
                (
                    "the torque has the sign opposite to the URDF's axis; invert it (tau_sign = -1 in a column map)",
                    inverted(&["tau_sign"]),
                )
            } else if fit.factor[joint] < 0.0 {
                (
                    "position and torque have the sign opposite to the URDF's axis; invert both (sign = -1 in a column map)",
                    inverted(&["sign"]),
                )
            } else {
                (
                    "the position has the sign opposite to the URDF's axis; invert it (sign = -1 and tau_sign = -1 in a \
                  column map)",
                    inverted(&["sign", "tau_sign"]),
                )
            };
            let text = format!("{text}: {}", evidence(joint));
            Some(Misfit::new(Some(names[joint]), text, changes))
        }
        Supposition::Swapped(a, b) if good(&a) && good(&b) => exchanged("columns", &["q", "qd", "tau"], a, a, b),
        // Two joints with similar motions may explain each other's torques, so that the second joint need not become
        // better.
        Supposition::TorquesSwapped(a, b) if (good(&a) && no_worse(b)) || (good(&b) && no_worse(a)) => {
            exchanged("torques", &["tau"], if good(&a) { a } else { b }, a, b)
        }
        // The torques of all joints depend on the positions, so that it is sufficient that one of the two is explained.
        Supposition::PositionsSwapped(a, b) if good(&a) || good(&b) => {
            exchanged("positions", &["q", "qd"], if good(&a) { a } else { b }, a, b)
        }
        // A wrong zero shows in the gravity torque of the joint itself or of the joints that carry it.
        Supposition::Zero(joint, added) if rivals().next().is_none() => {
            let shows = |at: &usize| good(at) && as_it_is.residual_share[*at] >= OF_A_ZERO;
            let shown_at = (0..=joint).rev().find(shows)?;
            let turn = match added {
                added if added.abs() > 3.0 => "π",
                added if added > 0.0 => "-π/2",
                _ => "π/2",
            };
            let text = format!(
                "the position's zero is off by {turn} from the URDF's; correct it (q_offset = {added:.4} in a column map): {}",
                evidence(shown_at)
            );
            Some(Misfit::new(
                Some(names[joint]),
                text,
                vec![change(joint, "q_offset", added)],
            ))
        }
        _ => None,
    };
    misfit.map(|misfit| Misfit {
        prevents_diagnosis: is_certain,
        is_of_robot: matches!(best, Supposition::Zero(..)) && !is_certain,
        ..misfit
    })
}
