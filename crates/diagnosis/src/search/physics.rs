//! What a coefficient must be for its cause to be possible.

use arm::Arm;

use crate::regression::fit::Fit;
use crate::regression::table::Table;
use crate::regression::term::Term;
use crate::search::candidate::{Candidate, Cause, FASTEST_WARMING, LONGEST_DELAY};

/// Unit coefficients may be off by what linear columns leave.
const UNIT: std::ops::RangeInclusive<f64> = 0.7..=1.4;
const COARSE_UNIT: std::ops::RangeInclusive<f64> = 0.4..=2.5;
/// A limit cuts off all that is beyond it. Its column is made of the measured torque, which may stand for a scale.
const CUT_OFF: std::ops::RangeInclusive<f64> = 0.8..=1.25;
/// A payload is no more than so many times as heavy as the moving links.
const MOST_PAYLOAD: f64 = 1.5;
/// A push is no more than so many times the arm's weight: the drives could not hold against it.
const MOST_CONTACT: f64 = 4.0;
/// A cause that is so many times larger than what it is to explain cancels another.
const LARGEST_SHARE: f64 = 3.0;
/// The largest part of the moving rows that a torque limit may clip.
const MOST_CLIPPED: f64 = 0.45;
/// Beside what breaking away takes more, dry friction of a joint in motion is at least this part of it.
const LEAST_COULOMB: f64 = 0.1;
/// A point of a curve counts where the joint, in motion, comes so near that its tent is this high.
const VISITED: f64 = 0.5;
/// Exponents of what grows faster than the speed.
const DRAG: std::ops::RangeInclusive<f64> = 1.4..=3.2;
/// Between its points a spring's curve may fall, for noise, by this part of all its rise …
const LARGEST_FALL: f64 = 0.05;
/// … and on the whole by this part.
const ALL_FALLS: f64 = 0.1;
/// Loads on a tool, and their centres of mass (m) as a share of the arm's reach.
const PAYLOAD_REACH: f64 = 0.5;

/// Whether `candidate` is possible at the coefficients of `fit`.
pub fn is_possible(candidate: &Candidate, table: &Table, fit: &Fit, arm: &Arm) -> bool {
    let value = |k: usize| fit.coefficient(candidate.columns[k]);
    // What every drive has may well be hidden by masses that are wrong the other way.
    let cancels = |joint| torque_share(candidate, table, fit, joint) >= LARGEST_SHARE;
    if !candidate.cause.is_ordinary() && candidate.joint.is_some_and(cancels) {
        return false;
    }
    match candidate.cause {
        Cause::Viscous | Cause::Coulomb | Cause::RotorInertia => value(0) > 0.0,
        Cause::Drag => value(0) > 0.0 && drags(candidate, table),
        Cause::Asymmetry => value(0) > 0.0 && value(1).abs() < value(0),
        Cause::Stribeck => value(1) > 0.0 && value(0) > LEAST_COULOMB * value(1) && fades(candidate, table),
        // Without load there may be no friction at all, but not less.
        Cause::LoadDependent => value(1) > 0.0 && value(1) < 1.0 && value(0) > -0.1 * value(1) * load(table, candidate),
        Cause::Thermal => {
            value(1) > 0.0 && value(0) > 0.0 && value(1) < 4.0 * value(0) && warms_slowly(candidate, table)
        }
        Cause::TorqueScale => (-0.7..2.0).contains(&value(0)),
        // A drive spends no more than part of its time at its limit.
        Cause::Saturation => CUT_OFF.contains(&value(0)) && acting(candidate, table) < MOST_CLIPPED,
        // Beside a resonance the coefficient is soon small: until its size is refined, it says little.
        Cause::Elasticity | Cause::Backlash if !candidate.is_trial => COARSE_UNIT.contains(&value(0)),
        Cause::Delay => UNIT.contains(&value(0)) && is_short(candidate, table),
        Cause::Elasticity | Cause::Backlash => UNIT.contains(&value(0)),
        Cause::Payload => {
            let mass = value(0);
            let reach = PAYLOAD_REACH * reach(arm);
            let first: f64 = (1..4).map(|k| value(k).powi(2)).sum::<f64>().sqrt();
            mass > 0.0 && first < mass * reach && mass < MOST_PAYLOAD * moving_mass(arm)
        }
        Cause::LinkError => (-0.8..2.0).contains(&value(0)),
        Cause::InertialScale => (-0.6..1.5).contains(&value(0)),
        Cause::Tilt => value(0).hypot(value(1)) < 0.4,
        Cause::EncoderOffset => value(0).abs() < 0.2,
        Cause::Spring => spring_stiffens(candidate, table, fit),
        Cause::Contact => (0..3).map(|k| value(k).powi(2)).sum::<f64>().sqrt() < MOST_CONTACT * weight(arm),
        Cause::TorqueOffset
        | Cause::Ripple
        | Cause::Coupling(_)
        | Cause::OwnPosition
        | Cause::OtherPosition(_)
        | Cause::OtherSpeed(_)
        | Cause::History
        | Cause::Product
        | Cause::Periodic
        | Cause::Time => true,
    }
}

/// Whether what is simulated at its size comes out with a coefficient near one.
pub fn is_at_its_size(candidate: &Candidate, fit: &Fit) -> bool {
    !candidate.cause.is_unit() || UNIT.contains(&fit.coefficient(candidate.columns[0]))
}

/// The mass of the moving links (kg).
fn moving_mass(arm: &Arm) -> f64 {
    arm.joints().iter().map(|joint| joint.inertia.mass).sum()
}

/// What the arm weighs on Earth (N).
fn weight(arm: &Arm) -> f64 {
    const GRAVITY: f64 = 9.81;
    GRAVITY * moving_mass(arm)
}

/// Whether it is a delay that a drive may have.
fn is_short(candidate: &Candidate, table: &Table) -> bool {
    candidate.columns.iter().all(|&column| match table.terms[column] {
        Term::Late { delay, .. } => delay < 1.001 * LONGEST_DELAY,
        _ => true,
    })
}

/// Whether Stribeck's part has faded to less than half on most of the moving rows: it is friction of low speeds.
fn fades(candidate: &Candidate, table: &Table) -> bool {
    let Some(joint) = candidate.joint else { return false };
    let Some(place) = table.place[joint][candidate.columns[1]] else {
        return false;
    };
    let this = &table.joints[joint];
    let (mut moving, mut slow) = (0, 0);
    for row in (0..this.y.len()).filter(|&row| this.moving[row]) {
        moving += 1;
        slow += usize::from(this.x[place][row].abs() > 0.5);
    }
    2 * slow < moving
}

/// Whether its exponent is one of drag.
fn drags(candidate: &Candidate, table: &Table) -> bool {
    candidate.columns.iter().all(|&column| match table.terms[column] {
        Term::Drag { exponent, .. } => DRAG.contains(&exponent),
        _ => true,
    })
}

/// Whether its time constant is that of a drive that warms, but for what refinement did to it.
fn warms_slowly(candidate: &Candidate, table: &Table) -> bool {
    candidate.columns.iter().all(|&column| match table.terms[column] {
        Term::Warm { time_constant, .. } => time_constant > 0.7 * FASTEST_WARMING,
        _ => true,
    })
}

/// The root mean square of a candidate's torque over that of what it is to explain, on moving rows.
fn torque_share(candidate: &Candidate, table: &Table, fit: &Fit, joint: usize) -> f64 {
    let values: Vec<f64> = candidate
        .columns
        .iter()
        .map(|&column| fit.coefficient(column))
        .collect();
    let torque = table.torque(joint, &candidate.columns, &values);
    let this = &table.joints[joint];
    let power = |signal: &[f64]| -> f64 {
        signal
            .iter()
            .zip(&this.moving)
            .filter(|(_, moving)| **moving)
            .map(|(v, _)| v * v)
            .sum()
    };
    (power(&torque) / power(&this.y).max(1e-300)).sqrt()
}

/// Whether a spring pulls back: its torque grows with the angle over nearly all of the range.
fn spring_stiffens(candidate: &Candidate, table: &Table, fit: &Fit) -> bool {
    let Some(joint) = candidate.joint else { return false };
    let tents: Vec<f64> = candidate
        .columns
        .iter()
        .filter(|&&column| {
            matches!(table.terms[column], Term::Tent { .. })
                && is_visited(table, joint, column)
                && fit.coefficient(column) != 0.0
        })
        .map(|&column| fit.coefficient(column))
        .collect();
    if let (Some(first), Some(last)) = (tents.first(), tents.last()) {
        let rise = last - first;
        let falls = || tents.windows(2).map(|pair| (pair[0] - pair[1]).max(0.0));
        return rise > 0.0 && falls().all(|fall| fall < LARGEST_FALL * rise) && falls().sum::<f64>() < ALL_FALLS * rise;
    }
    let position = candidate
        .columns
        .iter()
        .find(|&&c| matches!(table.terms[c].always(), Term::Position(_, 1)));
    let Some(x) = position.and_then(|&column| table.place[joint][column]) else {
        return false;
    };
    let x = &table.joints[joint].x[x];
    let (low, high) = x
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    let slope = |q: f64| -> f64 {
        candidate
            .columns
            .iter()
            .map(|&column| match table.terms[column].always() {
                Term::Position(_, power) => f64::from(power) * q.powi(power - 1) * fit.coefficient(column),
                _ => 0.0,
            })
            .sum()
    };
    let steps = 20;
    let rising = (0..=steps)
        .filter(|&k| slope(low + (high - low) * f64::from(k) / f64::from(steps)) > 0.0)
        .count();
    rising >= 17
}

/// Whether the joint comes near a tent's point in motion.
fn is_visited(table: &Table, joint: usize, column: usize) -> bool {
    let this = &table.joints[joint];
    table.place[joint][column]
        .is_some_and(|place| (0..this.y.len()).any(|row| this.moving[row] && this.x[place][row] > VISITED))
}

/// The part of the moving rows on which a candidate's first column is not zero.
fn acting(candidate: &Candidate, table: &Table) -> f64 {
    let Some(joint) = candidate.joint else { return 1.0 };
    let Some(place) = table.place[joint][candidate.columns[0]] else {
        return 0.0;
    };
    let this = &table.joints[joint];
    let largest = this.x[place].iter().fold(0.0_f64, |largest, v| largest.max(v.abs()));
    let moving = this.moving.iter().filter(|&&m| m).count();
    let acting = (0..this.y.len())
        .filter(|&row| this.moving[row] && this.x[place][row].abs() > 0.02 * largest)
        .count();
    acting as f64 / moving.max(1) as f64
}

/// The mean of the load's column where it is not zero.
fn load(table: &Table, candidate: &Candidate) -> f64 {
    let Some(joint) = candidate.joint else { return 0.0 };
    table.place[joint][candidate.columns[1]].map_or(0.0, |place| {
        let x = &table.joints[joint].x[place];
        x.iter().map(|v| v.abs()).sum::<f64>() / x.len().max(1) as f64
    })
}

/// The sum of the distances from joint to joint (m).
pub fn reach(arm: &Arm) -> f64 {
    let links: f64 = arm
        .joints()
        .iter()
        .map(|joint| joint.parent_from_joint.translation.norm())
        .sum();
    (links + arm.tool_frame().link_from_frame.translation.norm()).max(0.2)
}
