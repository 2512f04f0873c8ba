//! Units of positions other than the model's, and time stamps with which no robot could have moved.

use std::f64::consts::{PI, TAU};

use arm::{Arm, Joint, JointKind};
use recording::{FindingKind, JointQuality, Quality};
use report::numbers::{percent, rounded};

use super::column_map::{Change, Value};
use super::correction::Correction;
use super::fit::fit;
use super::smooth::Smooth;
use super::thresholds::{
    BEYOND_RANGE, LIMIT_SLACK, MOST_SPAN, MOST_SPEED, MOTOR_SIDE, ONE_IN_DEGREES, SAME_SLOPE, SAME_SPEED, SAME_UNIT,
    SLACK, SLOWEST_PERIOD, TURN_FACTORS, UNIT_LEAD,
};
use super::{Misfit, MisfitKind};

/// Degrees and milliradians: the unit of positions, the unit of velocities, its size in rad.
const UNITS: [(&str, &str, f64); 2] = [("deg", "deg/s", PI / 180.0), ("mrad", "mrad/s", 1e-3)];
/// Turns of a joint, which make positions too small.
const TURN: (&str, &str, f64) = ("turn", "turn/s", TAU);

/// A joint of the arm and the statistics of its recorded signals.
pub type Pair<'a> = (&'a Joint, &'a JointQuality);

/// The contradiction if rows are too far apart to show a drive's motion, with the unit of the time stamps that would
/// explain it.
pub fn of_time(arm: &Arm, quality: &Quality) -> Option<Misfit> {
    let period = 1.0 / quality.rate;
    if period <= SLOWEST_PERIOD {
        return None;
    }
    let finding = quality.findings.iter().find(|finding| finding.kind == FindingKind::TimeUnit);
    // Recorded velocities determine the unit. Without them, it is the largest unit with which the rows are close enough.
    let units = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
    let by_velocity = finding.and_then(|finding| {
        let unit = finding.time_unit?;
        units.into_iter().find(|(name, _)| *name == unit)
    });
    let found = by_velocity.or_else(|| {
        let is_close = |(_, seconds): &(&str, f64)| period * seconds <= SLOWEST_PERIOD;
        units.into_iter().find(is_close).filter(|(_, seconds)| {
            let is_possible = |joint: &Joint| {
                let measured = quality.joints.iter().find(|measured| measured.joint == joint.name);
                let speed = measured.map_or(0.0, |measured| measured.speed_max / seconds);
                joint.limits.velocity <= 0.0 || speed <= MOST_SPEED * joint.limits.velocity
            };
            arm.joints().iter().all(is_possible)
        })
    });
    let Some((unit, seconds)) = found else {
        let text = format!(
            "its rows are {period:.3} s apart, too far for velocities and accelerations (and in no other unit of time the speeds \
             would be possible): record at 100 Hz or more"
        );
        return Some(Misfit { prevents_diagnosis: true, ..Misfit::new(MisfitKind::Time, None, text, Vec::new()) });
    };
    let text = format!(
        "its rows are {period:.3} s apart; are its stamps in {unit}{}? Give the unit in a column map (--map: unit = \"{unit}\" \
         under [time]), or record at 100 Hz or more",
        // A counter of rows and whole milliseconds at 1 kHz look the same.
        if (period - 1.0).abs() < 1e-9 {
            ", or are they the numbers of the rows (divide them by the rate)"
        } else {
            ""
        }
    );
    Some(Misfit {
        prevents_diagnosis: true,
        ..Misfit::new(MisfitKind::Time, None, text, vec![Change::time(unit, seconds)])
    })
}

/// The contradictions in the unit of the positions, judged by their ranges, by the ratio of their slopes to the recorded
/// velocities, and by the torques.
pub fn of_positions(arm: &Arm, pairs: &[Pair<'_>], smooth: Option<&Smooth>) -> Vec<Misfit> {
    let moving: Vec<&Pair<'_>> =
        pairs.iter().filter(|(joint, measured)| measured.moves && joint.kind == JointKind::Revolute).collect();
    let evident: Vec<&&Pair<'_>> = moving.iter().filter(|pair| is_beyond(pair)).collect();
    let slow = |factor: f64| {
        let ratio = |pair: &&Pair<'_>| pair.1.velocity_ratio;
        !moving.is_empty()
            && moving
                .iter()
                .all(|pair| ratio(pair).is_some_and(|ratio| (ratio.abs() / factor - 1.0).abs() < SAME_SLOPE))
    };
    let by_velocity = UNITS.into_iter().chain([TURN]).find(|(_, _, factor)| slow(*factor));
    // Positions in turns are inside all limits. Their slopes, or the model's torques, show the unit.
    let in_turns = smooth.filter(|_| by_velocity.is_none() && evident.is_empty());
    if let Some(share) = in_turns.and_then(|smooth| explained_in_turns(arm, &moving, smooth)) {
        return vec![of_unit(pairs, &moving, TURN, &format!("with this unit, the model and friction {share}"))];
    }
    if by_velocity.is_none() && 2 * evident.len() < moving.len().max(1) {
        return Vec::new();
    }
    let fits = |(_, _, factor): &(&str, &str, f64)| {
        moving.iter().all(|(joint, measured)| {
            let limits = joint.limits;
            let slack = SLACK * (limits.upper - limits.lower) + LIMIT_SLACK;
            limits.upper <= limits.lower
                || (measured.q_range.0 * factor > limits.lower - slack
                    && measured.q_range.1 * factor < limits.upper + slack)
        })
    };
    let mut possible: Vec<(&str, &str, f64)> = UNITS.into_iter().filter(fits).collect();
    if let Some(smooth) = smooth.filter(|_| !possible.is_empty()) {
        let score = |unit: &(&str, &str, f64)| fit(arm, smooth, Correction::Unit(unit.2)).score();
        // Limits that a motion exceeds are wrong more often than torques that agree.
        let best = UNITS.into_iter().min_by(|a, b| score(a).total_cmp(&score(b)));
        if let Some(best) = best.filter(|best| score(&possible[0]) - score(best) > UNIT_LEAD) {
            possible[0] = best;
        }
    }
    // One joint whose position exceeds its limits may be the only one in that unit.
    if let (Some(smooth), [one], Some(unit)) = (smooth, &evident[..], possible.first())
        && by_velocity.is_none()
        && let Some(at) = arm.joints().iter().position(|joint| joint.name == one.0.name)
    {
        let score = |correction| fit(arm, smooth, correction).score();
        if score(Correction::UnitOf(at, unit.2)) < score(Correction::Unit(unit.2)) {
            return Vec::new();
        }
    }
    let shown = evident.first().or(moving.first().as_ref()).map(|pair| **pair);
    let Some((joint, measured)) = shown else {
        return Vec::new();
    };
    let range = format!("{} spans {} … {}", joint.name, rounded(measured.q_range.0, 4), rounded(measured.q_range.1, 4));
    // Positions of the motors with the torques of the joints, or of the motors: in degrees, the torques would be far too small.
    let is_geared = |unit: &(&str, &str, f64)| {
        let fitted = smooth.map(|smooth| fit(arm, smooth, Correction::Unit(unit.2)));
        by_velocity.is_none() && fitted.is_some_and(|fit| fit.size.iter().all(|size| *size < MOTOR_SIDE))
    };
    let found = by_velocity.or(possible.first().copied()).filter(|unit| !is_geared(unit));
    let Some((unit, of_velocity, factor)) = found else {
        let text = format!(
            "the positions are in no unit of angle that agrees with the torques: {range}, and the URDF's limits are {:.3} … {:.3} \
             rad. Counts of an encoder, or the motors' side of the gears? Give each joint's q_scale (rad of one count) or gear in \
             a column map (--map)",
            joint.limits.lower, joint.limits.upper
        );
        return vec![Misfit {
            prevents_diagnosis: true,
            ..Misfit::new(MisfitKind::PositionUnit, None, text, Vec::new())
        }];
    };
    let name = name_of(unit);
    let why = if by_velocity.is_some() {
        format!("their slopes are {} times the recorded velocities", rounded(1.0 / factor, 3))
    } else if !fits(&(unit, of_velocity, factor)) {
        format!(
            "{range}, and the torques agree with the model far better in {name} than in any unit that the URDF's limits allow"
        )
    } else {
        format!(
            "{range}, which the URDF's limits {:.3} … {:.3} rad allow in {name} only",
            joint.limits.lower, joint.limits.upper
        )
    };
    vec![of_unit(pairs, &moving, (unit, of_velocity, factor), &why)]
}

/// The unit of the positions in words.
fn name_of(unit: &str) -> &'static str {
    match unit {
        "deg" => "degrees",
        "turn" => "turns",
        _ => "milliradians",
    }
}

/// The contradiction that all positions are in a unit, because of `why`.
fn of_unit(
    pairs: &[Pair<'_>],
    moving: &[&Pair<'_>],
    (unit, of_velocity, factor): (&'static str, &'static str, f64),
    why: &str,
) -> Misfit {
    let name = name_of(unit);
    let text = format!("the positions are in {name}: {why}; say so in a column map (--map): q_unit = \"{unit}\"");
    // A wrong unit of one position makes all torques of the model wrong, so that all joints are corrected together.
    let mut changes = Vec::new();
    let slopes = moving
        .iter()
        .filter(|(_, measured)| measured.velocity_ratio.is_some_and(|ratio| SAME_UNIT.contains(&ratio.abs())));
    let velocities_too = 2 * slopes.count() >= moving.len();
    for (joint, _) in pairs.iter().filter(|(joint, _)| joint.kind == JointKind::Revolute) {
        changes.push(Change::new(&joint.name, "q_unit", Value::Unit(unit, factor)));
        // Velocities that equal the slopes of the positions are in the same unit.
        if velocities_too {
            changes.push(Change::new(&joint.name, "qd_unit", Value::Unit(of_velocity, factor)));
        }
    }
    Misfit { prevents_diagnosis: true, ..Misfit::new(MisfitKind::PositionUnit, None, text, changes) }
}

/// What the model explains with positions in turns, if that is nearly all of most joints' torques and far more than as they are.
fn explained_in_turns(arm: &Arm, moving: &[&Pair<'_>], smooth: &Smooth) -> Option<String> {
    let within = moving.iter().all(|(joint, measured)| {
        let limits = joint.limits;
        let slack = SLACK * (limits.upper - limits.lower) + LIMIT_SLACK;
        let (low, high) = measured.q_range;
        limits.upper <= limits.lower || (low * TAU > limits.lower - slack && high * TAU < limits.upper + slack)
    });
    if moving.is_empty() || !within {
        return None;
    }
    let [now, turned] = [Correction::AsItIs, Correction::Unit(TAU)].map(|correction| fit(arm, smooth, correction));
    let has_size = |&joint: &usize| TURN_FACTORS.contains(&turned.factor[joint]);
    let judged: Vec<usize> = (0..arm.dof()).filter(|&joint| turned.needs_model(joint)).collect();
    let is_right = 2 * judged.len() >= moving.len() && judged.iter().all(has_size);
    if !is_right || now.score() - turned.score() < UNIT_LEAD * moving.len() as f64 {
        return None;
    }
    let share = |residuals: &[f64]| {
        let residual: f64 = judged.iter().map(|&joint| residuals[joint]).sum();
        percent(1.0 - residual / judged.len() as f64)
    };
    Some(format!(
        "explain {} of the torques; without it, {}",
        share(&turned.residual_share),
        share(&now.residual_share)
    ))
}

/// Whether the positions span more than two turns and more than 1.5 times the URDF's range. A zero that is off by whole
/// turns does not change the span, and many motions exceed the URDF's limits slightly.
fn is_beyond((joint, measured): &Pair<'_>) -> bool {
    let (low, high) = measured.q_range;
    let limits = joint.limits;
    limits.upper > limits.lower && high - low > MOST_SPAN.max(BEYOND_RANGE * (limits.upper - limits.lower))
}

/// The contradiction if the positions of one joint fit into its limits only in degrees. It prevents a diagnosis if the recorded
/// velocities or the torques agree: a joint that turns without end may also exceed its limits that far.
pub fn of_one(arm: &Arm, (joint, measured): &Pair<'_>, smooth: Option<&Smooth>) -> Option<Misfit> {
    let (low, high) = measured.q_range;
    let limits = joint.limits;
    let fits = low.to_radians() > limits.lower - LIMIT_SLACK && high.to_radians() < limits.upper + LIMIT_SLACK;
    if joint.kind != JointKind::Revolute || !is_beyond(&(joint, measured)) || !fits {
        return None;
    }
    let (unit, of_velocity, factor) = UNITS[0];
    let mut changes = vec![Change::new(&joint.name, "q_unit", Value::Unit(unit, factor))];
    if measured.velocity_ratio.is_some_and(|ratio| SAME_UNIT.contains(&ratio.abs())) {
        changes.push(Change::new(&joint.name, "qd_unit", Value::Unit(of_velocity, factor)));
    }
    let is_slope = |ratio: f64| (ratio.abs() * factor - 1.0).abs() < SAME_SLOPE;
    let agrees = |smooth: &Smooth| {
        let at = arm.joints().iter().position(|other| other.name == joint.name);
        let explains = |correction| fit(arm, smooth, correction).score();
        at.is_some_and(|at| explains(Correction::AsItIs) - explains(Correction::UnitOf(at, factor)) > ONE_IN_DEGREES)
    };
    let is_certain = measured.velocity_ratio.is_some_and(is_slope) || smooth.is_some_and(agrees);
    let text = format!(
        "the position {} in degrees: it spans {} … {}, which the URDF's limits {:.3} … {:.3} rad allow in degrees only; \
         say so in a column map (--map): q_unit = \"deg\"",
        if is_certain { "is" } else { "may be" },
        rounded(low, 4),
        rounded(high, 4),
        limits.lower,
        limits.upper
    );
    Some(Misfit {
        prevents_diagnosis: is_certain,
        ..Misfit::new(MisfitKind::PositionUnit, Some(&joint.name), text, changes)
    })
}

/// The contradiction if the speeds of all joints that move are far beyond their limits.
pub fn of_speeds(pairs: &[Pair<'_>]) -> Option<Misfit> {
    let moving: Vec<&Pair<'_>> = pairs.iter().filter(|(_, measured)| measured.moves).collect();
    let mut times: Vec<f64> =
        moving.iter().map(|(joint, measured)| measured.speed_max / joint.limits.velocity).collect();
    times.sort_by(f64::total_cmp);
    let (least, most) = (*times.first()?, *times.last()?);
    let has_limits = moving.iter().all(|(joint, _)| joint.limits.velocity > 0.0);
    if !has_limits || least <= MOST_SPEED || moving.len() < 2 {
        return None;
    }
    let ratios: Vec<f64> = moving.iter().filter_map(|(_, measured)| measured.velocity_ratio).collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
    let same = ratios.len() == moving.len() && ratios.iter().all(|ratio| (ratio / mean - 1.0).abs() < SAME_SLOPE);
    let hint = if same && !SAME_SPEED.contains(&mean) {
        format!(
            "; the recorded velocities are {} times the positions' slopes on all of them, so that the time stamps are probably \
             too close by that factor",
            rounded(mean, 3)
        )
    } else {
        String::new()
    };
    let text = format!(
        "the speeds of all joints that move are {} to {} times the URDF's velocity limits{hint}; check the units of time and \
         positions (unit under [time], q_unit, q_scale in a column map)",
        rounded(least, 2),
        rounded(most, 2)
    );
    Some(Misfit { prevents_diagnosis: true, ..Misfit::new(MisfitKind::Speed, None, text, Vec::new()) })
}
