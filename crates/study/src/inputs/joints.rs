//! The assignment of a recording's columns to the arm's joints.

use std::path::Path;

use anyhow::bail;
use arm::{Arm, FixedBecause, FixedJoint, JointKind};
use recording::{Recording, RegularRecording, Signal, Warning, nearest};

/// The travel from which a joint with a gripper's name may be one of the arm (rad).
const LEAST_TRAVEL: f64 = 0.5;

/// The rotating joints that are fixed in the arm because of a gripper's name, but move in the recording, each with a text.
pub(super) fn moving_grippers(recording: &Recording, arm: &Arm) -> Vec<(String, String)> {
    let is_gripper = |fixed: &&FixedJoint| fixed.reason == FixedBecause::Gripper && fixed.kind == JointKind::Revolute;
    let text = |fixed: &FixedJoint| {
        let column = recording.joints.iter().position(|joint| *joint == fixed.name)?;
        let positions = recording.q.get(column)?.iter().copied().filter(|q| q.is_finite());
        let (low, high) =
            positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(q), high.max(q)));
        let travel = high - low;
        (travel > LEAST_TRAVEL).then(|| {
            format!(
                "moves by {travel:.2} rad, but is fixed at {} rad in the arm, because its name is that of a gripper's joint; if it is a \
                 joint of the arm, give the link after it as --tip LINK, with --lock JOINT=POSITION for each joint before it that is not \
                 recorded",
                fixed.position
            )
        })
    };
    let grippers = arm.fixed_joints().iter().filter(is_gripper);
    grippers.filter_map(|fixed| Some((fixed.name.clone(), text(fixed)?))).collect()
}

/// The column of each joint of the arm. Columns of joints that are fixed in the arm are omitted.
///
/// # Errors
/// If the recording lacks a joint of the arm, or has one that the robot does not have, or that was fixed because the
/// recording `first`, which selected the arm, lacks it.
pub(super) fn order(
    recording: &Recording,
    arm: &Arm,
    name: &str,
    first: &str,
    map: Option<&Path>,
) -> anyhow::Result<Vec<usize>> {
    let known: Vec<String> = arm.joints().iter().map(|joint| joint.name.clone()).collect();
    let quoted = |names: &[String]| names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    let lost = arm
        .fixed_joints()
        .iter()
        .find(|fixed| fixed.reason == FixedBecause::NotRecorded && recording.joints.contains(&fixed.name));
    if let Some(FixedJoint { name: joint, .. }) = lost {
        bail!(
            "{first}: has no positions and torques (q_{joint}, tau_{joint}) of \"{joint}\" of {}, and {name} has them; record all \
             joints of the arm in every recording, or fix a joint that did not move: --lock {joint}=VALUE",
            arm.name()
        );
    }
    let is_fixed = |joint: &str| arm.fixed_joints().iter().any(|fixed| fixed.name == joint);
    let foreign: Vec<String> =
        recording.joints.iter().filter(|joint| !known.contains(joint) && !is_fixed(joint)).cloned().collect();
    let lacking: Vec<String> = known.iter().filter(|joint| !recording.joints.contains(joint)).cloned().collect();
    let empty = recording.warnings.iter().find_map(|warning| match warning {
        Warning::JointLeftOut { joint, column } if lacking.contains(joint) => Some((joint, column)),
        _ => None,
    });
    if let Some((joint, column)) = empty {
        bail!(
            "{name}: column \"{column}\" has no values, so that \"{joint}\" of {} cannot be diagnosed; record it, or fix the joint if it did not move: --lock {joint}=VALUE",
            arm.name()
        );
    }
    let is_numbered = recording.joints.iter().all(|joint| joint.parse::<usize>().is_ok());
    if lacking.len() == known.len() && is_numbered {
        bail!(
            "{name}: its {} joints have numbers, and the arm of {} has {} joints; say in a column map (--map) which are meant, or \
             fix those that did not move (--lock JOINT=VALUE). A map of the first ones, to be corrected:\n{}",
            recording.joints.len(),
            arm.name(),
            known.len(),
            first_ones(recording, &known)
        );
    }
    if lacking.len() == known.len()
        && let Some(places) = in_another_spelling(&recording.joints, &known)
    {
        bail!(
            "{name}: its joints are {}, those of {} are {}, as if in another spelling; if they are the same, read the recording with \
             this column map (--map):\n{}",
            quoted(&recording.joints),
            arm.name(),
            quoted(&known),
            map_of(recording, &known, &places)
        );
    }
    if lacking.len() == known.len() {
        bail!(
            "{name}: belongs to another robot: its joints are {}, those of {} are {}; give the URDF of the robot that was recorded, or a column map (--map)",
            quoted(&recording.joints),
            arm.name(),
            quoted(&known)
        );
    }
    if let (Some(joint), Some(map)) = (lacking.first(), map) {
        let hint = foreign.first().map_or_else(String::new, |other| format!(" (is [joints.{other}] meant?)"));
        bail!(
            "{}: has no [joints.{joint}] for {} of {}{hint}; add a table for each joint of the arm",
            map.display(),
            quoted(&lacking),
            arm.name()
        );
    }
    if let Some(joint) = lacking.first() {
        let hint = nearest(joint, &foreign)
            .map_or_else(String::new, |near| format!("; the name of its column q_{near} is similar"));
        bail!(
            "{name}: has no column q_{joint} for {} of {}{hint}; record all joints of the arm, name their columns in a column map (--map), or fix a joint that did not move: --lock {joint}=VALUE",
            quoted(&lacking),
            arm.name()
        );
    }
    if let Some(joint) = foreign.first() {
        let fixed: Vec<String> = arm.fixed_joints().iter().map(|joint| joint.name.clone()).collect();
        let unrecorded: Vec<String> = fixed.iter().filter(|name| !recording.joints.contains(name)).cloned().collect();
        let and_fixed = match unrecorded.as_slice() {
            [] => String::new(),
            names => format!(", and without a column {}", quoted(names)),
        };
        let rename = nearest(joint, &unrecorded)
            .map_or_else(String::new, |near| format!("rename the column to q_{near} if \"{near}\" is meant, "));
        bail!(
            "{name}: column q_{joint}: {} {} of {}, which has {}{and_fixed}; {rename}leave the column out with a column map (--map), or give the URDF of the robot that was recorded",
            quoted(&foreign),
            if foreign.len() == 1 { "is not a joint" } else { "are not joints" },
            arm.name(),
            quoted(&known)
        );
    }
    Ok(known.iter().filter_map(|joint| recording.joints.iter().position(|found| found == joint)).collect())
}

/// The recording with the joints of `arm` in its order, if it has all of them; other joints are omitted.
pub fn in_order_of(arm: &Arm, recording: RegularRecording) -> Option<RegularRecording> {
    let place = |joint: &arm::Joint| recording.joints.iter().position(|name| *name == joint.name);
    let order: Vec<usize> = arm.joints().iter().map(place).collect::<Option<_>>()?;
    Some(reordered(recording, &order))
}

/// The recording with its joints in another order; other joints are omitted.
pub(super) fn reordered(mut recording: RegularRecording, order: &[usize]) -> RegularRecording {
    let signal = |signal: &Signal| -> Signal { order.iter().map(|&from| signal[from].clone()).collect() };
    let partial = |signal: &recording::PartialSignal| -> recording::PartialSignal {
        order.iter().map(|&from| signal.get(from).cloned().flatten()).collect()
    };
    recording.joints = order.iter().map(|&from| recording.joints[from].clone()).collect();
    recording.q = signal(&recording.q);
    recording.tau = signal(&recording.tau);
    recording.qd = recording.qd.as_ref().map(signal);
    recording.qdd = recording.qdd.as_ref().map(signal);
    recording.q_secondary = partial(&recording.q_secondary);
    recording.tau_current = partial(&recording.tau_current);
    recording.current = partial(&recording.current);
    recording.temperature = partial(&recording.temperature);
    recording
}

/// The places of the joints `known` among `found`, if each is there in another spelling: in a namespace, in other case, with other
/// separators, or with one more word before or after it, which is the same for all joints.
fn in_another_spelling(found: &[String], known: &[String]) -> Option<Vec<usize>> {
    let plain = |name: &String| -> String {
        let last = name.rsplit(['/', ':']).next().unwrap_or_default();
        last.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
    };
    let [found, known] = [found, known].map(|names| names.iter().map(plain).collect::<Vec<String>>());
    // What one name has more than the other.
    let more: [fn(&str, &str) -> Option<String>; 4] = [
        |found, known| found.strip_suffix(known).map(str::to_owned),
        |found, known| found.strip_prefix(known).map(str::to_owned),
        |found, known| known.strip_suffix(found).map(str::to_owned),
        |found, known| known.strip_prefix(found).map(str::to_owned),
    ];
    let places = |more: fn(&str, &str) -> Option<String>, word: &str| -> Option<Vec<usize>> {
        let place = |joint: &String| {
            let is_same = |(_, other): &(usize, &String)| more(other, joint).as_deref() == Some(word);
            let mut places = found.iter().enumerate().filter(is_same);
            let (first, _) = places.next()?;
            places.next().is_none().then_some(first)
        };
        known.iter().map(place).collect()
    };
    let first = known.first()?;
    more.into_iter().find_map(|more| {
        let words = found.iter().filter_map(|other| more(other, first));
        // A digit more is another number.
        let mut words = words.filter(|word| word.is_empty() || word.chars().any(char::is_alphabetic));
        words.find_map(|word| places(more, &word))
    })
}

/// A column map of the first numbered joints, with the names `known`.
fn first_ones(recording: &Recording, known: &[String]) -> String {
    let count = known.len().min(recording.joints.len());
    map_of(recording, known, &(0..count).collect::<Vec<_>>())
}

/// A column map that gives the joints at `places` the names `known`.
fn map_of(recording: &Recording, known: &[String], places: &[usize]) -> String {
    let Some(origin) = &recording.origin else {
        return String::new();
    };
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let mut map = format!("[time]\ncolumn = {}\n", quoted(&origin.time));
    if let Some(run) = &origin.run {
        map += &format!("run = {}\n", quoted(run));
    }
    for (name, &joint) in known.iter().zip(places) {
        map += &format!("[joints.{}]\n", quoted(name));
        for column in origin.columns.iter().filter(|column| column.joint == joint) {
            let key = column.quantity.prefix().trim_end_matches('_');
            map += &format!("{key} = {}\n", quoted(&column.header));
        }
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_recognised_in_another_spelling() {
        let names = |list: &[&str]| list.iter().map(|&name| name.to_owned()).collect::<Vec<String>>();
        let known = names(&["joint_1", "joint_2"]);
        for found in [
            ["Joint2", "Joint1"],
            ["arm/joint2", "arm/joint1"],
            ["JOINT-2", "joint 1"],
            ["left_joint_2", "left_joint_1"],
            ["joint_2_left", "joint_1_left"],
            ["2", "1"],
        ] {
            assert_eq!(in_another_spelling(&names(&found), &known), Some(vec![1, 0]), "{found:?}");
        }
        // Which of two is meant is unknown, and not all are there.
        assert_eq!(in_another_spelling(&names(&["left/joint1", "right/joint1", "joint2"]), &known), None);
        assert_eq!(in_another_spelling(&names(&["Joint1"]), &known), None);
        // Another word for each joint, and another number.
        assert_eq!(in_another_spelling(&names(&["left_joint_1", "right_joint_2"]), &known), None);
        assert_eq!(in_another_spelling(&names(&["joint_11", "joint_21"]), &known), None);
    }

    #[test]
    fn a_gripper_that_moves_may_be_a_joint_of_the_arm() {
        let joint = |name: &str, parent: &str, child: &str| {
            format!(
                r#"<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/><axis xyz="0 0 1"/></joint>
<link name="{child}"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>"#
            )
        };
        let urdf = format!(
            r#"<robot name="two"><link name="base"/>{}{}</robot>"#,
            joint("elbow", "base", "a"),
            joint("GripperYaw", "a", "b")
        );
        let arm = Arm::from_urdf_text(&urdf, "two.urdf").expect("it is an arm");
        let texts = |yaw: f64| {
            let recording = Recording {
                joints: vec!["elbow".into(), "GripperYaw".into()],
                q: vec![vec![0.0, 1.0], vec![f64::NAN, 0.0, yaw]],
                ..Recording::default()
            };
            moving_grippers(&recording, &arm)
        };
        assert!(texts(0.2).is_empty());
        let [(name, text)] = &texts(2.5)[..] else { panic!("one joint") };
        assert_eq!(name, "GripperYaw");
        assert!(text.contains("moves by 2.50 rad") && text.contains("--tip LINK"), "{text}");
    }
}
