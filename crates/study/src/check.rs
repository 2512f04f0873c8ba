//! Checks of a recording against the robot's URDF: names, limits, signs, order, motor side.

mod applied;
mod column_map;
mod correction;
mod fit;
mod positions;
mod proposal;
mod smooth;
mod thresholds;
mod torque_unit;
pub mod turns;
mod wording;

use arm::Arm;
use effects::Quantity;
use recording::{FindingKind, Quality, Recording, RegularRecording, nearest};
use report::numbers::{percent, rounded};
use serde::Serialize;

pub use self::column_map::{Change, Layout};
use self::correction::Correction;
use self::fit::{Fit, fit, residual_share_of_drive};
use self::positions::Pair;
pub use self::proposal::{Proposal, proposal};
use self::smooth::Smooth;
use self::thresholds::{
    EFFORT_SLACK, LEAST_INSTANTS, LIMIT_SLACK, MOST_SPEED, MOTOR_SIDE, NEEDS_MODEL, NOT_EXPLAINED, OF_SIZE, OTHER_UNIT,
    WORSE,
};

/// What a contradiction between recording and URDF is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MisfitKind {
    /// A joint of the recording that the URDF does not have.
    NotInUrdf,
    /// A joint of the URDF that the recording does not have.
    NotRecorded,
    /// No joint of the recording is one of the URDF.
    OtherRobot,
    /// The unit of time.
    Time,
    /// The unit of the positions.
    PositionUnit,
    /// A position that does not change although the torque does.
    ConstantPosition,
    /// Positions whole turns beyond the URDF's limits.
    Turns,
    /// Positions beyond the URDF's limits.
    PositionLimits,
    /// Speeds beyond the URDF's limits.
    Speed,
    /// Torques beyond the URDF's limits.
    EffortLimits,
    /// The unit of the torques, or the side of the gear.
    TorqueUnit,
    /// Signs, order or zeros.
    Columns,
}

/// A contradiction between recording and URDF.
#[derive(Debug, Serialize)]
pub struct Misfit {
    /// What it is about.
    #[serde(skip)]
    pub kind: MisfitKind,
    /// The joint, if it concerns one.
    pub joint: Option<String>,
    /// A description, with the remedy.
    pub text: String,
    /// Whether it must be corrected before the robot can be diagnosed.
    #[serde(skip)]
    pub prevents_diagnosis: bool,
    /// The keys of a column map that correct it.
    #[serde(skip)]
    pub changes: Vec<Change>,
}

impl Misfit {
    /// A contradiction that does not prevent a diagnosis, with the keys of a column map that correct it.
    pub fn new(kind: MisfitKind, joint: Option<&str>, text: impl Into<String>, changes: Vec<Change>) -> Self {
        Self { kind, joint: joint.map(str::to_owned), text: text.into(), prevents_diagnosis: false, changes }
    }
}

/// The column map (TOML) that corrects `misfits` of `recording`; `None` if none of them can be corrected by a map, or if with the
/// map the recording still contradicts the URDF of `arm`, is explained less, or is too short to judge it.
pub fn column_map(arm: &Arm, misfits: &[Misfit], recording: &Recording) -> Option<String> {
    let changes: Vec<Change> = misfits.iter().flat_map(|misfit| misfit.changes.iter().cloned()).collect();
    let text = Layout::of(recording).map(&changes)?;
    let new = applied::applied(recording, &changes);
    let (new_regular, _) = new.regular().ok()?;
    let remaining = check(arm, &new_regular, &Quality::of(&new, &new_regular));
    if remaining.misfits.iter().any(|misfit| misfit.prevents_diagnosis) {
        return None;
    }
    let has_time = changes.iter().any(Change::is_of_time);
    let Some(after) = as_it_is(arm, &new_regular) else {
        // Of a recording that seems to be hours long, short windows were read, which are too short in the right unit.
        return (has_time && recording.left_out > 0.0).then_some(text);
    };
    let (old_regular, _) = recording.regular().ok()?;
    let before = as_it_is(arm, &old_regular).map_or(f64::INFINITY, |before| before.score());
    // With a wrong unit of time, the inertial torques have another size.
    let is_scaled = |joint: usize| after.needs_model(joint) && !OF_SIZE.contains(&after.factor[joint]);
    let has_wrong_time = has_time && (0..arm.dof()).any(is_scaled);
    (!has_wrong_time && after.score() <= before + WORSE).then_some(text)
}

/// The fit of the recording as it is; `None` if it cannot be computed.
fn as_it_is(arm: &Arm, regular: &RegularRecording) -> Option<Fit> {
    let smooth = Smooth::of(regular, &order(arm, regular)?);
    (smooth.len() > LEAST_INSTANTS).then(|| fit(arm, &smooth, Correction::AsItIs))
}

/// The place of each of the arm's joints in the recording, if all are there.
fn order(arm: &Arm, regular: &RegularRecording) -> Option<Vec<usize>> {
    arm.joints().iter().map(|joint| regular.joints.iter().position(|name| *name == joint.name)).collect()
}

/// What the check of one recording found.
#[derive(Debug, Default)]
pub struct Checked {
    /// The contradictions between recording and URDF.
    pub misfits: Vec<Misfit>,
    /// Whether times, positions and torques seem to be in the model's units, so that signs, zeros and order can be judged.
    pub has_model_units: bool,
}

/// The contradictions in names, units and limits between `regular` and `arm`.
pub fn check(arm: &Arm, regular: &RegularRecording, quality: &Quality) -> Checked {
    let mut checked = Checked { misfits: names(arm, regular), has_model_units: false };
    if let Some(misfit) = positions::of_time(arm, quality) {
        // With a wrong unit of time, speeds and accelerations show nothing.
        checked.misfits.push(misfit);
        return checked;
    }
    let order = order(arm, regular);
    let smooth = order.as_ref().map(|order| Smooth::of(regular, order));
    let smooth = smooth.as_ref().filter(|smooth| smooth.len() > LEAST_INSTANTS);
    let find = |name: &String| quality.joints.iter().find(|quality| quality.joint == *name);
    let joints = arm.joints().iter();
    let pairs: Vec<Pair<'_>> = joints.filter_map(|joint| Some((joint, find(&joint.name)?))).collect();
    let unit = positions::of_positions(arm, &pairs, smooth);
    if !unit.is_empty() {
        checked.misfits.extend(unit);
        return checked;
    }
    let too_fast = positions::of_speeds(&pairs);
    // With a wrong unit of time, the model's torques are meaningless.
    let has_other_time = too_fast.is_some();
    checked.misfits.extend(too_fast);
    let mut in_degrees = 0;
    for (joint, measured) in &pairs {
        let limits = joint.limits;
        let (low, high) = measured.q_range;
        if let Some(misfit) = positions::of_one(arm, &(joint, measured), smooth) {
            checked.misfits.push(misfit);
            in_degrees += 1;
            continue;
        }
        let mut add = |kind: MisfitKind, text: String| {
            checked.misfits.push(Misfit::new(kind, Some(&joint.name), text, Vec::new()));
        };
        if measured.speed_max > MOST_SPEED * limits.velocity && limits.velocity > 0.0 {
            add(
                MisfitKind::Speed,
                format!(
                    "the speed reaches {}, {} times the URDF's velocity limit {} {}; check the units of position and time",
                    rounded(measured.speed_max, 3),
                    rounded(measured.speed_max / limits.velocity, 2),
                    rounded(limits.velocity, 4),
                    Quantity::Speed.unit(joint.kind)
                ),
            );
        }
        if low < limits.lower - LIMIT_SLACK || high > limits.upper + LIMIT_SLACK {
            add(
                MisfitKind::PositionLimits,
                format!(
                    "positions {} … {} exceed the URDF's limits {:.3} … {:.3} {}; check unit, zero and sign, or the limits",
                    rounded(low, 4),
                    rounded(high, 4),
                    limits.lower,
                    limits.upper,
                    Quantity::Position.unit(joint.kind)
                ),
            );
        }
        let torque = measured.tau_range.0.abs().max(measured.tau_range.1.abs());
        if limits.effort > 0.0 && torque > EFFORT_SLACK * limits.effort {
            add(
                MisfitKind::EffortLimits,
                format!(
                    "the torque reaches {}, above the URDF's effort limit {} {}; check its unit and side of the gear",
                    rounded(torque, 3),
                    rounded(limits.effort, 4),
                    Quantity::Torque.unit(joint.kind)
                ),
            );
        }
    }
    if let (Some(order), Some(smooth)) = (order, smooth) {
        let moves: Vec<bool> = order.iter().map(|&joint| quality.joints[joint].moves).collect();
        // With positions in degrees or of another joint, the model's torques are meaningless.
        let has = |kinds: &[FindingKind]| quality.findings.iter().any(|finding| kinds.contains(&finding.kind));
        let has_other_units = has(&[FindingKind::TimeUnit, FindingKind::Degrees, FindingKind::VelocityUnit]);
        if !has_other_units && in_degrees == 0 && !has_other_time {
            checked.misfits.extend(torques(arm, smooth, &moves));
            checked.has_model_units = true;
        }
    }
    checked.has_model_units &= !checked.misfits.iter().any(|misfit| misfit.prevents_diagnosis);
    checked
}

fn names(arm: &Arm, regular: &RegularRecording) -> Vec<Misfit> {
    let of_arm: Vec<String> = arm.joints().iter().map(|joint| joint.name.clone()).collect();
    let missing = |kind: MisfitKind, from: &[String], within: &[String], what: &str| -> Vec<Misfit> {
        let lost = from.iter().filter(|name| !within.contains(name));
        lost.map(|name| {
            let free: Vec<String> = within.iter().filter(|other| !from.contains(other)).cloned().collect();
            let hint = nearest(name, &free).map_or(".".to_owned(), |other| format!("; is \"{other}\" meant?"));
            let text = format!("{what}{hint} Name the columns as the URDF does, or give a column map (--map)");
            Misfit::new(kind, Some(name), text, Vec::new())
        })
        .collect()
    };
    let is_fixed = |joint: &String| arm.fixed_joints().iter().any(|fixed| fixed.name == *joint);
    let recorded: Vec<String> = regular.joints.iter().filter(|joint| !is_fixed(joint)).cloned().collect();
    if !recorded.is_empty() && recorded.iter().all(|joint| !of_arm.contains(joint)) {
        let text = format!(
            "no joint of the recording ({}) is one of {} ({}); give the URDF of the robot that was recorded, or the joints' names \
             in a column map (--map)",
            recorded.join(", "),
            arm.name(),
            of_arm.join(", ")
        );
        return vec![Misfit::new(MisfitKind::OtherRobot, None, text, Vec::new())];
    }
    let mut misfits =
        missing(MisfitKind::NotInUrdf, &recorded, &of_arm, "is in the recording, but the URDF has no such joint");
    misfits.extend(missing(
        MisfitKind::NotRecorded,
        &of_arm,
        &regular.joints,
        "is in the URDF, but the recording has no such joint",
    ));
    misfits
}

/// Contradictions in units that the torques show.
fn torques(arm: &Arm, smooth: &Smooth, moves: &[bool]) -> Vec<Misfit> {
    let names: Vec<&str> = arm.joints().iter().map(|joint| joint.name.as_str()).collect();
    let as_it_is = fit(arm, smooth, Correction::AsItIs);
    if let Some((text, changes)) = torque_unit::of(&names, moves, &as_it_is) {
        let prevents_diagnosis = true;
        return vec![Misfit { prevents_diagnosis, ..Misfit::new(MisfitKind::TorqueUnit, None, text, changes) }];
    }
    let mut misfits = Vec::new();
    for (joint, name) in names.iter().enumerate() {
        let is_constant = smooth.q[joint].windows(2).all(|pair| pair[0] == pair[1]);
        if is_constant && as_it_is.residual_share[joint] > NOT_EXPLAINED && as_it_is.size[joint] > OF_SIZE.start {
            let text = format!(
                "the position is {} in all rows, but the torque varies by {} times as much as the model's at that position, and \
                 the model explains {} of the torque; was the position recorded?",
                rounded(smooth.q[joint][0], 4),
                rounded(as_it_is.size[joint], 2),
                percent(1.0 - as_it_is.residual_share[joint])
            );
            misfits.push(Misfit::new(MisfitKind::ConstantPosition, Some(name), text, Vec::new()));
        }
    }
    for (joint, &factor) in as_it_is.factor.iter().enumerate() {
        let matters = moves[joint] && as_it_is.needs_model(joint);
        let size = factor.abs();
        // Many URDFs omit the inertias of the drives, and that of a wrist's drive may be a thousand times its link's.
        let is_drive = || {
            size > 1.0
                && !torque_unit::may_be_decimal(size)
                && residual_share_of_drive(smooth, joint) <= NEEDS_MODEL * as_it_is.residual_share[joint]
        };
        if matters && factor > 0.0 && !(MOTOR_SIDE..OTHER_UNIT).contains(&size) && !is_drive() {
            let what = if size < 1.0 { "motor side, or a current" } else { "another unit" };
            let text = format!(
                "the torque is {} times the model's: {what}? Give tau_scale (about {}) in a column map",
                rounded(size, 2),
                rounded(1.0 / size, 2)
            );
            let scale = Change::scale(names[joint], 1.0 / size);
            misfits.push(Misfit::new(MisfitKind::TorqueUnit, Some(names[joint]), text, vec![scale]));
        }
    }
    misfits
}
