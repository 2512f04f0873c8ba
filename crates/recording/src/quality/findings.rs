//! Doubtful properties of a recording, as sentences with the remedy.

use serde::Serialize;

use super::JointQuality;
use crate::RegularRecording;

const DEGREES: f64 = 180.0 / std::f64::consts::PI;
/// Revolutions per minute in rad/s.
const RPM: f64 = 30.0 / std::f64::consts::PI;

/// Rows that are further apart than this (s) are not those of a drive.
const SLOWEST_PERIOD: f64 = 0.1;

/// A torque whose step is more than this share of its range is coarse. Source: a UR3 simulated with another engine; with steps of 5 % of the
/// range of a wrist's torque its friction was off by 50 %.
const COARSE_TORQUE: f64 = 0.03;

/// The kind of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FindingKind {
    /// No joint moves.
    NoMotion,
    /// The torque is constant.
    NoTorque,
    /// The stamps seem to be in milliseconds, or in another unit than seconds.
    TimeUnit,
    /// The stamps seem to be a multiple of the true time.
    ClockRate,
    /// Positions seem to be in degrees.
    Degrees,
    /// The recorded velocity is in another unit than the positions.
    VelocityUnit,
    /// The recorded velocity has the opposite sign.
    VelocitySign,
    /// The recorded velocity is that of another joint.
    VelocitySwapped,
    /// The recorded velocity is not the derivative of the position.
    VelocityUnrelated,
    /// The torque remains at its extreme value.
    Saturation,
    /// Some joints do not move.
    JointAtRest,
    /// The encoder's step is large compared with the motion.
    CoarseEncoder,
    /// The torque's step is large compared with its range.
    CoarseTorque,
    /// The recorded velocity is late.
    VelocityLate,
}

/// One finding, about one joint or the whole file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Its kind.
    pub kind: FindingKind,
    /// The joint, if it is about one.
    pub joint: Option<String>,
    /// What was found, and the remedy.
    pub text: String,
    /// The unit of the stamps, for a [`FindingKind::TimeUnit`].
    #[serde(skip)]
    pub time_unit: Option<&'static str>,
}

/// The findings on `joints`; `swapped` are pairs of joints (position, velocity) whose velocities are exchanged.
pub fn of(regular: &RegularRecording, joints: &[JointQuality], swapped: &[(usize, usize)]) -> Vec<Finding> {
    let time_unit = time_unit(regular.period, joints);
    let unit = time_unit.as_ref().map(|(unit, _)| *unit);
    let clock_rate = if time_unit.is_none() { clock_rate(joints) } else { None };
    let mut findings = Vec::new();
    let mut add = |kind, joint: Option<&JointQuality>, text: String| {
        findings.push(Finding {
            kind,
            joint: joint.map(|joint| joint.joint.clone()),
            text,
            time_unit: unit.filter(|_| kind == FindingKind::TimeUnit),
        });
    };
    if joints.iter().all(|joint| !joint.moves) {
        let text = "no joint moves, so that only gravity and offsets can be identified; record a motion".into();
        add(FindingKind::NoMotion, None, text);
    }
    if let Some((_, text)) = &time_unit {
        add(FindingKind::TimeUnit, None, text.clone());
    }
    if let Some(rate) = clock_rate {
        let text = format!(
            "the recorded velocities of all joints that move are {rate:.3} times their positions' slopes: the time stamps are probably \
             {rate:.3} times the true times; correct the stamps, or give the velocities' unit if all of them have another one"
        );
        add(FindingKind::ClockRate, None, text);
    }
    for joint in joints.iter().filter(|joint| joint.tau_range.0 == joint.tau_range.1) {
        let text = format!("the torque is {} throughout; was it logged? Check its column", joint.tau_range.0);
        add(FindingKind::NoTorque, Some(joint), text);
    }
    for (index, joint) in joints.iter().enumerate() {
        if let Some((_, other)) = swapped.iter().find(|(position, _)| *position == index) {
            let text = format!(
                "its recorded velocity is not its position's slope, but that of \"{}\" is; were columns swapped? Correct the \
                 header or map the columns",
                joints[*other].joint
            );
            add(FindingKind::VelocitySwapped, Some(joint), text);
        } else if time_unit.is_none() {
            velocity(joint, clock_rate.is_some(), &mut add);
        }
        let reach = joint.q_range.0.abs().max(joint.q_range.1.abs());
        let in_degrees = joint.velocity_ratio.is_some_and(|ratio| near(ratio.abs(), 1.0 / DEGREES));
        if reach > 4.0 * std::f64::consts::PI && !in_degrees {
            let text = format!(
                "positions reach {}: degrees taken for radians, or millimetres for metres? Give q_unit in a column \
                 map; for a continuous joint this is normal",
                if reach < 1e4 { format!("{reach:.1}") } else { format!("{reach:.1e}") }
            );
            add(FindingKind::Degrees, Some(joint), text);
        }
        let range = joint.tau_range.1 - joint.tau_range.0;
        let coarse = joint.tau_step.filter(|&step| joint.moves && step > COARSE_TORQUE * range);
        if let Some(step) = coarse {
            let text = format!(
                "the torque's step ({step:.2e}) is {:.0} % of its whole range, so that friction and other small effects come out too \
                 large or too small: record it with finer digits",
                100.0 * step / range
            );
            add(FindingKind::CoarseTorque, Some(joint), text);
        }
        // Coarse steps and a torque that is rounded to zero also have plateaus.
        let plateaus = joint.plateaus.iter().flatten();
        for (value, share) in plateaus.filter(|(value, _)| *value != 0.0 && coarse.is_none()) {
            let text = format!(
                "the torque stays at its extreme of {value:.4} for {:.1} % of the time: a limit? Commanded torque beyond \
                 it was not applied",
                100.0 * share
            );
            add(FindingKind::Saturation, Some(joint), text);
        }
        let range = joint.q_range.1 - joint.q_range.0;
        if let Some(step) = joint.q_step.filter(|&step| joint.moves && step > range / 1000.0) {
            let text = format!(
                "the encoder's step ({step:.2e}) is {:.1} % of the whole motion; the accelerations are coarse: use a larger motion",
                100.0 * step / range
            );
            add(FindingKind::CoarseEncoder, Some(joint), text);
        }
    }
    let still: Vec<&str> = joints.iter().filter(|joint| !joint.moves).map(|joint| joint.joint.as_str()).collect();
    if !still.is_empty() && still.len() < joints.len() {
        let text = format!(
            "{} {} not move, so that {} friction and drive cannot be identified",
            still.join(", "),
            if still.len() == 1 { "does" } else { "do" },
            if still.len() == 1 { "its" } else { "their" },
        );
        add(FindingKind::JointAtRest, None, text);
    }
    let mut lags: Vec<f64> = joints.iter().filter_map(|joint| joint.velocity_lag).collect();
    lags.sort_by(f64::total_cmp);
    if let (Some(least), Some(most)) = (lags.first(), lags.last())
        && most.abs().max(least.abs()) > (0.5 * regular.period).max(5e-4)
    {
        let text = format!(
            "recorded velocities are {}{}; testbed differentiates the positions instead",
            lateness(*least, *most),
            if *most > 0.0 { ", probably by a filter" } else { "" },
        );
        add(FindingKind::VelocityLate, None, text);
    }
    findings
}

/// "4.0 to 4.3 ms late", or early.
fn lateness(least: f64, most: f64) -> String {
    let (way, least, most) = if most <= 0.0 { ("early", -most, -least) } else { ("late", least, most) };
    let (least, most) = (format!("{:.1}", 1e3 * least), format!("{:.1}", 1e3 * most));
    if least == most { format!("{most} ms {way}") } else { format!("{least} to {most} ms {way}") }
}

/// The unit of the stamps if it is not s: rows are too far apart for a drive, and the recorded velocities of all
/// joints exceed the slopes of their positions by the number of units per second.
fn time_unit(period: f64, joints: &[JointQuality]) -> Option<(&'static str, String)> {
    if period < SLOWEST_PERIOD {
        return None;
    }
    let ratios: Vec<f64> = joints.iter().filter_map(|joint| joint.velocity_ratio).collect();
    let unit = [("ms", 1e3), ("us", 1e6), ("ns", 1e9)].into_iter().find(|(_, units)| {
        let fits = ratios.iter().filter(|ratio| near(ratio.abs(), *units)).count();
        fits > 0 && fits == ratios.len()
    });
    let (unit, units) = unit?;
    let text = format!(
        "rows are {period:.4} s apart, and all recorded velocities are {units} times their positions' slopes: the stamps are \
         in {unit}; give unit = \"{unit}\" under [time] in a column map (--map)"
    );
    Some((unit, text))
}

/// The least number of joints whose velocities must agree on a wrong clock.
const LEAST_OF_CLOCK: usize = 3;
/// The relative difference of a clock's rate from one from which it is wrong: a filter changes the velocities by less.
const WRONG_RATE: f64 = 0.03;
/// The relative difference of the ratios of velocities to slopes that a common clock may have.
const SAME_RATE: f64 = 0.01;

/// The time of the stamps over the true time, if the recorded velocities of all joints that move agree on another one.
fn clock_rate(joints: &[JointQuality]) -> Option<f64> {
    let moving: Vec<&JointQuality> = joints.iter().filter(|joint| joint.moves).collect();
    let is_clear = |joint: &&&JointQuality| joint.velocity_correlation.is_some_and(|correlation| correlation > 0.98);
    let ratios: Vec<f64> = moving.iter().filter(is_clear).filter_map(|joint| joint.velocity_ratio).collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let is_common = ratios.len() >= LEAST_OF_CLOCK
        && ratios.len() == moving.len()
        && ratios.iter().all(|ratio| (ratio / mean - 1.0).abs() < SAME_RATE);
    // Larger factors are those of units.
    (is_common && (mean - 1.0).abs() > WRONG_RATE && (0.2..5.0).contains(&mean)).then_some(mean)
}

fn near(value: f64, expected: f64) -> bool {
    (value / expected - 1.0).abs() < 0.04
}

/// The findings on a joint's recorded velocity; those on its unit are left out if the clock `is_wrong`.
fn velocity(joint: &JointQuality, is_wrong: bool, add: &mut impl FnMut(FindingKind, Option<&JointQuality>, String)) {
    let Some(ratio) = joint.velocity_ratio else {
        if let Some(correlation) = joint.velocity_correlation.filter(|correlation| correlation.abs() < 0.6) {
            let text = format!(
                "the recorded velocity is hardly correlated with the position's derivative (correlation {correlation:.2}); check its \
                 column"
            );
            add(FindingKind::VelocityUnrelated, Some(joint), text);
        }
        return;
    };
    if ratio < 0.0 && joint.velocity_correlation.is_some_and(|correlation| correlation.abs() > 0.95) {
        let text =
            "the recorded velocity has the sign opposite to the position's slope; invert one (sign in a column map)";
        add(FindingKind::VelocitySign, Some(joint), text.into());
    }
    let size = ratio.abs();
    // A filtered velocity is smaller than the slope if the motion is small and fast.
    let clear = joint.velocity_correlation.is_some_and(|correlation| correlation.abs() > 0.98);
    let guess = if is_wrong {
        return;
    } else if near(size, DEGREES) {
        "it is in deg/s, or the position in rad against it: give qd_unit = \"deg/s\" in a column map"
    } else if near(size, 1.0 / DEGREES) {
        "the position is in degrees: give q_unit = \"deg\" in a column map"
    } else if near(size, RPM) {
        "it is in rpm: give qd_unit = \"rpm\" in a column map"
    } else if near(size, 1e3) || near(size, 1e-3) {
        "one of them is in thousandths (mm, mrad): give the units in a column map"
    } else if clear && !(0.8..1.25).contains(&size) {
        "other units, or motor side against joint side: give units or gear in a column map"
    } else {
        return;
    };
    let text = format!("the recorded velocity is {size:.4} times the position's slope; {guess}");
    add(FindingKind::VelocityUnit, Some(joint), text);
}
