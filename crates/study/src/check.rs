//! Checks of a recording against the robot's URDF: names, limits, signs, order, motor side.

mod column_map;
mod smooth;
mod supposition;
mod torque_unit;

use std::f64::consts::TAU;

use arm::{Arm, Joint, JointKind};
use recording::{FindingKind, JointQuality, Quality, Recording, RegularRecording, Warning, nearest};
use report::numbers::rounded;
use serde::Serialize;

use self::column_map::{Change, Value};
use self::smooth::Smooth;
use self::supposition::{EXPLAINED, Fit, Supposition, fit};
use self::torque_unit::MOTOR_SIDE;

/// An assumption must reduce the mean log residual of the joints by at least this much.
const GAIN: f64 = 2.0;
/// An assumption must be better than the next one by at least this reduction of the mean log residual.
const LEAD: f64 = 1.0;
/// A torque of more than this multiple of the model's is in another unit.
const OTHER_UNIT: f64 = 100.0;
/// The largest speed of a robot, as a multiple of the URDF's limit; many URDFs have limits of the normal operation.
const BEYOND: f64 = 5.0;

/// A contradiction between recording and URDF.
#[derive(Debug, Serialize)]
pub struct Misfit {
    /// The joint, if it concerns one.
    pub joint: Option<String>,
    /// A description, with the remedy.
    pub text: String,
    /// Whether it must be corrected before the robot can be diagnosed.
    #[serde(skip)]
    pub spoils: bool,
    /// The keys of a column map that correct it.
    #[serde(skip)]
    pub changes: Vec<Change>,
}

impl Misfit {
    fn new(joint: Option<&str>, text: impl Into<String>, changes: Vec<Change>) -> Self {
        Self {
            joint: joint.map(str::to_owned),
            text: text.into(),
            spoils: false,
            changes,
        }
    }
}

/// The column map that corrects `misfits` of `recording`, which was read with the user's map (`mapped`) or without one.
pub fn column_map(misfits: &[Misfit], recording: &Recording, mapped: bool) -> Option<String> {
    let changes: Vec<Change> = misfits
        .iter()
        .flat_map(|misfit| misfit.changes.iter().cloned())
        .collect();
    let known = |warning: &Warning| matches!(warning, Warning::System { .. } | Warning::Joined { .. });
    let own = !mapped && !recording.warnings.iter().any(known);
    column_map::text(&recording.joints, &changes, own, recording.qd.is_some())
}

/// Whether the positions span two turns and more than the URDF's limits allow, and are within them as degrees. A zero that is
/// wrong by turns does not change the span, and many motions exceed the limits of their URDF.
fn is_in_degrees(joint: &Joint, measured: &JointQuality) -> bool {
    let (low, high) = measured.q_range;
    let limits = joint.limits;
    joint.kind == JointKind::Revolute
        && limits.upper > limits.lower
        && high - low > (2.0 * TAU).max(1.5 * (limits.upper - limits.lower))
        && low.to_radians() > limits.lower - 1e-2
        && high.to_radians() < limits.upper + 1e-2
}

fn degrees(joint: &Joint, measured: &JointQuality) -> Misfit {
    let text = format!(
        "the position is in degrees: it spans {} … {}, which the URDF's limits {:.3} … {:.3} rad allow in degrees only; \
         say so in a column map (--map): q_unit = \"deg\"",
        rounded(measured.q_range.0, 4),
        rounded(measured.q_range.1, 4),
        joint.limits.lower,
        joint.limits.upper
    );
    let mut changes = vec![Change::new(&joint.name, "q_unit", Value::Text("deg"))];
    // Velocities that are the positions' slopes have the same unit.
    if measured
        .velocity_ratio
        .is_some_and(|ratio| (0.5..2.0).contains(&ratio.abs()))
    {
        changes.push(Change::new(&joint.name, "qd_unit", Value::Text("deg/s")));
    }
    Misfit::new(Some(&joint.name), text, changes)
}

/// The contradictions between `regular` and `arm`.
pub fn check(arm: &Arm, regular: &RegularRecording, quality: &Quality) -> Vec<Misfit> {
    let mut misfits = names(arm, regular);
    for (joint, measured) in arm.joints().iter().filter_map(|joint| {
        let found = quality.joints.iter().find(|quality| quality.joint == joint.name)?;
        Some((joint, found))
    }) {
        let limits = joint.limits;
        let (low, high) = measured.q_range;
        if is_in_degrees(joint, measured) {
            misfits.push(degrees(joint, measured));
            continue;
        }
        let mut add = |text: String| misfits.push(Misfit::new(Some(&joint.name), text, Vec::new()));
        if measured.speed_max > BEYOND * limits.velocity && limits.velocity > 0.0 {
            add(format!(
                "the speed reaches {}, {} times the URDF's velocity limit {}; check the units of position and time",
                rounded(measured.speed_max, 3),
                rounded(measured.speed_max / limits.velocity, 2),
                rounded(limits.velocity, 4)
            ));
        }
        if low < limits.lower - 1e-2 || high > limits.upper + 1e-2 {
            add(format!(
                "positions {} … {} exceed the URDF's limits {:.3} … {:.3}; check unit, zero and sign, or the limits",
                rounded(low, 4),
                rounded(high, 4),
                limits.lower,
                limits.upper
            ));
        }
        let torque = measured.tau_range.0.abs().max(measured.tau_range.1.abs());
        if limits.effort > 0.0 && torque > 1.05 * limits.effort {
            add(format!(
                "the torque reaches {torque:.4}, above the URDF's effort limit {:.4}; check its unit and side of the gear",
                limits.effort
            ));
        }
    }
    // All of them are wrong together, because all torques depend on each position.
    let in_degrees = misfits.iter().filter(|misfit| !misfit.changes.is_empty()).count();
    let moving = quality.joints.iter().filter(|joint| joint.moves).count();
    if in_degrees > 0 && in_degrees >= moving {
        for misfit in misfits.iter_mut().filter(|misfit| !misfit.changes.is_empty()) {
            misfit.spoils = true;
        }
    }
    let order: Option<Vec<usize>> = arm
        .joints()
        .iter()
        .map(|joint| regular.joints.iter().position(|name| *name == joint.name))
        .collect();
    if let Some(order) = order {
        let moves: Vec<bool> = order.iter().map(|&joint| quality.joints[joint].moves).collect();
        let smooth = Smooth::of(regular, &order);
        // With positions in degrees or of another joint, torques cannot be compared.
        let doubted = quality.findings.iter().any(|finding| {
            matches!(
                finding.kind,
                FindingKind::TimeUnit | FindingKind::Degrees | FindingKind::VelocityUnit | FindingKind::VelocitySwapped
            )
        });
        if smooth.len() > 100 && !doubted && in_degrees == 0 {
            misfits.extend(torques(arm, &smooth, &moves));
        }
    }
    misfits
}

fn names(arm: &Arm, regular: &RegularRecording) -> Vec<Misfit> {
    let of_arm: Vec<String> = arm.joints().iter().map(|joint| joint.name.clone()).collect();
    let missing = |from: &[String], within: &[String], what: &str| -> Vec<Misfit> {
        let lost = from.iter().filter(|name| !within.contains(name));
        lost.map(|name| {
            let free: Vec<String> = within.iter().filter(|other| !from.contains(other)).cloned().collect();
            let hint = nearest(name, &free).map_or(String::new(), |other| format!("; is \"{other}\" meant?"));
            let text = format!("{what}{hint} Name the columns as the URDF does, or give a column map (--map)");
            Misfit::new(Some(name), text, Vec::new())
        })
        .collect()
    };
    let is_fixed = |joint: &String| arm.fixed_joints().iter().any(|fixed| fixed.name == *joint);
    let recorded: Vec<String> = regular
        .joints
        .iter()
        .filter(|joint| !is_fixed(joint))
        .cloned()
        .collect();
    let mut misfits = missing(
        &recorded,
        &of_arm,
        "is in the recording, but the URDF has no such joint",
    );
    misfits.extend(missing(
        &of_arm,
        &regular.joints,
        "is in the URDF, but the recording has no such joint",
    ));
    misfits
}

/// Contradictions in units, signs, order and zeros that the torques show.
fn torques(arm: &Arm, smooth: &Smooth, moves: &[bool]) -> Vec<Misfit> {
    let names: Vec<&str> = arm.joints().iter().map(|joint| joint.name.as_str()).collect();
    let as_it_is = fit(arm, smooth, Supposition::AsItIs);
    if let Some((text, changes)) = torque_unit::of(&names, moves, &as_it_is) {
        let spoils = true;
        return vec![Misfit {
            spoils,
            ..Misfit::new(None, text, changes)
        }];
    }
    if let Some(misfit) = supposed(arm, smooth, moves, &names, &as_it_is) {
        return vec![misfit];
    }
    let mut misfits = Vec::new();
    for (joint, &factor) in as_it_is.factor.iter().enumerate() {
        let matters = moves[joint] && as_it_is.told_by_model(joint);
        let size = factor.abs();
        if matters && factor > 0.0 && !(MOTOR_SIDE..OTHER_UNIT).contains(&size) {
            let what = if size < 1.0 {
                "motor side, or a current"
            } else {
                "another unit"
            };
            let text = format!(
                "the torque is {size:.2e} times the model's: {what}? Give tau_scale (about {:.3}) in a column map",
                1.0 / size
            );
            let scale = Change::scale(names[joint], 1.0 / size);
            misfits.push(Misfit::new(Some(names[joint]), text, vec![scale]));
        }
    }
    misfits
}

/// The supposition that explains the torques far better than all others, if there is one.
fn supposed(arm: &Arm, smooth: &Smooth, moves: &[bool], names: &[&str], as_it_is: &Fit) -> Option<Misfit> {
    let mut scored: Vec<(f64, Supposition, Fit)> = Supposition::all(arm, moves)
        .into_iter()
        .map(|supposition| {
            let fit = fit(arm, smooth, supposition);
            (as_it_is.score() - fit.score(), supposition, fit)
        })
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (gain, best, fit) = scored.first()?;
    let next = scored[1..].iter().find(|(_, other, _)| !best.same_joint(*other));
    let lead = gain - next.map_or(0.0, |next| next.0);
    if !(*gain > GAIN && lead > LEAD) {
        return None;
    }
    let rivals = || {
        let near = |(next, other, _): &&(f64, Supposition, Fit)| best.same_joint(*other) && gain - next < LEAD;
        scored[1..].iter().filter(near).map(|(_, other, _)| *other)
    };
    let good = |joint: &usize| fit.left[*joint] < EXPLAINED && as_it_is.left[*joint] > 3.0 * fit.left[*joint].max(0.02);
    // How much better the supposition explains a joint's torque.
    let evidence = |joint: usize| {
        let share = |fit: &Fit| (100.0 * (1.0 - fit.left[joint]).max(0.0)).round();
        format!(
            "with this correction, the model and friction explain {} % of the torque's variance at {}; without it, {} %",
            share(fit),
            names[joint],
            share(as_it_is)
        )
    };
    let change = |joint: usize, key, value| Change::new(names[joint], key, Value::Number(value));
    let exchanged = |what: &str, keys: &[&'static str], told_at: usize, a: usize, b: usize| {
        let text = format!(
            "the {what} of {} and {} seem swapped; correct the header, or map the columns (--map): {}",
            names[a],
            names[b],
            evidence(told_at)
        );
        let pairs = [(a, b), (b, a)];
        let of = |key: &'static str| {
            pairs.map(|(at, other)| Change::new(names[at], key, Value::ColumnOf(names[other].to_owned())))
        };
        Some(Misfit::new(None, text, keys.iter().flat_map(|key| of(key)).collect()))
    };
    match *best {
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
        Supposition::TorquesSwapped(a, b) if good(&a) && good(&b) => exchanged("torques", &["tau"], a, a, b),
        // All joints' torques depend on the positions: it is sufficient that one of the two is explained.
        Supposition::PositionsSwapped(a, b) if good(&a) || good(&b) => {
            exchanged("positions", &["q", "qd"], if good(&a) { a } else { b }, a, b)
        }
        // A zero shows in the joint's own gravity torque, or in that of the joints that carry it.
        Supposition::Zero(joint, added) if rivals().next().is_none() => {
            let told_at = (0..=joint).rev().find(good)?;
            let turn = match added {
                added if added.abs() > 3.0 => "π",
                added if added > 0.0 => "-π/2",
                _ => "π/2",
            };
            let text = format!(
                "the position's zero is off by {turn} from the URDF's; correct it (q_offset = {added:.4} in a column map): {}",
                evidence(told_at)
            );
            Some(Misfit::new(
                Some(names[joint]),
                text,
                vec![change(joint, "q_offset", added)],
            ))
        }
        _ => None,
    }
}
