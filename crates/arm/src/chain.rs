//! How an arm is chosen among the joints of a robot, and which joints are fixed for it.

use std::fmt;

use crate::joint::JointKind;
use crate::pose::Pose;

/// How an arm is chosen among the joints of a robot. By default it is the robot's only chain of moving joints;
/// grippers and mimicking joints are fixed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChainOptions {
    /// The link that does not move; `None` is the root link.
    pub base: Option<String>,
    /// The last link of the arm: the joints between the base and it move, and all others are fixed.
    pub tip: Option<String>,
    /// Joints that are fixed, each with its position (rad or m).
    pub locks: Vec<(String, f64)>,
    /// The joints in the recordings. Without a tip, the arm has no other joints. Empty without recordings.
    pub recorded: Vec<String>,
}

/// A joint of the robot that could move and is fixed in the arm.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedJoint {
    /// The URDF joint's name.
    pub name: String,
    /// How it would move if it were not fixed.
    pub kind: JointKind,
    /// Where it is fixed (rad or m).
    pub position: f64,
    /// The pose of its child link in its parent link.
    pub parent_from_child: Pose,
    /// Why it is fixed.
    pub reason: FixedBecause,
    /// Whether the arm carries it, so that its position affects the arm's dynamics.
    pub is_carried: bool,
}

/// Why a joint is fixed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FixedBecause {
    /// [`ChainOptions::locks`] asks for it.
    Locked,
    /// It mimics this joint.
    Mimics(String),
    /// Its name is that of a gripper's joint, and there is nothing but the gripper beyond it.
    Gripper,
    /// The recordings do not contain it.
    NotRecorded,
    /// It is not between base and tip.
    OffChain,
}

impl fmt::Display for FixedBecause {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Locked => formatter.write_str("locked"),
            Self::Mimics(other) => write!(formatter, "mimics {other}"),
            Self::Gripper => formatter.write_str("gripper"),
            Self::NotRecorded => formatter.write_str("not recorded"),
            Self::OffChain => formatter.write_str("not on the chain"),
        }
    }
}

/// A note counts the joints instead of listing them if there are more than this.
const MOST_NAMED: usize = 4;

/// One line about the joints that were fixed without an option and that the arm carries.
pub(crate) fn note(fixed: &[FixedJoint]) -> Option<String> {
    let unasked = |joint: &&FixedJoint| joint.is_carried && joint.reason != FixedBecause::Locked;
    let fixed: Vec<&FixedJoint> = fixed.iter().filter(unasked).collect();
    let mut named: Vec<String> = fixed
        .iter()
        .take(MOST_NAMED)
        .map(|joint| {
            let unit = match joint.kind {
                JointKind::Revolute => "rad",
                JointKind::Prismatic => "m",
            };
            format!("{} at {} {unit} ({})", joint.name, joint.position, joint.reason)
        })
        .collect();
    if fixed.len() > MOST_NAMED {
        named.push(format!("{} more", fixed.len() - MOST_NAMED));
    }
    (!named.is_empty()).then(|| {
        format!(
            "joints that are fixed in the arm: {}; --lock JOINT=VALUE fixes a joint elsewhere, --tip LINK lets the joints \
             up to that link move",
            named.join(", ")
        )
    })
}
