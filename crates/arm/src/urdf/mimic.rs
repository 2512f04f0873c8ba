//! Joints that mimic others: refused where they would move with the arm, otherwise fixed where the mimicked joint puts them.

use super::Reader;
use super::choose::{Chain, limits};
use super::spelling::nearest;
use crate::chain::FixedBecause;
use crate::error::ArmError;

/// What a joint that mimics another follows in the end.
enum Followed<'a> {
    /// A joint that moves in the arm.
    Moving(&'a str),
    /// A joint that does not exist.
    Unknown(&'a str),
    /// A joint that stands still.
    Fixed,
}

/// A joint that follows a moving one.
struct Follower<'a> {
    joint: &'a urdf_rs::Joint,
    /// The joint that its `<mimic>` names.
    mimicked: &'a str,
    /// The moving joint that it follows in the end.
    name: &'a str,
}

impl<'a> Reader<'a> {
    /// Refuses joints that mimic a moving joint of the arm: they move with it, and the arm would hold them fixed. Refuses joints that
    /// mimic one that the robot does not have. Joints beside the arm that it does not carry are not looked at, and joints that are
    /// locked are not either. Where a tip was chosen, joints beyond it are fixed as always: a warning names those that move.
    pub(super) fn check_mimics(&self, chain: &mut Chain<'a>, recorded: &[String]) -> Result<(), ArmError> {
        let mut moving: Vec<Follower<'_>> = Vec::new();
        let mut beyond: Vec<String> = Vec::new();
        for fixed in &chain.fixed {
            let FixedBecause::Mimics(mimicked) = &fixed.reason else {
                continue;
            };
            let Some(joint) = self.robot.joints.iter().find(|joint| joint.name == fixed.name) else {
                continue;
            };
            let on_way = self.is_on_way(joint, chain);
            let is_of_arm = on_way || (fixed.is_carried && chain.tip.is_none());
            match self.followed(joint, chain) {
                Followed::Unknown(name) if is_of_arm => return Err(self.unknown(joint, name)),
                Followed::Moving(name) if is_of_arm => moving.push(Follower { joint, mimicked, name }),
                Followed::Moving(name) if fixed.is_carried => beyond.push(format!("{} ({name})", joint.name)),
                _ => {}
            }
        }
        if let Some((first, others)) = moving.split_first() {
            return Err(self.follows_moving(first, others, recorded.contains(&first.joint.name)));
        }
        if !beyond.is_empty() {
            chain.warnings.push(format!(
                "joints beyond the tip that follow a moving joint of the arm, and are fixed in the model all the same: {}",
                beyond.join(", ")
            ));
        }
        Ok(())
    }

    /// Whether `joint` is between the base and a moving joint or the chosen tip.
    fn is_on_way(&self, joint: &urdf_rs::Joint, chain: &Chain<'a>) -> bool {
        let moving = self.robot.joints.iter().filter(|other| chain.position(&other.name).is_none());
        let ends = moving.map(|other| other.child.link.as_str()).chain(chain.tip);
        let mut ways = ends.filter_map(|end| self.path(end, chain.base));
        ways.any(|way| way.iter().any(|on_way| on_way.name == joint.name))
    }

    fn unknown(&self, joint: &urdf_rs::Joint, mimicked: &str) -> ArmError {
        let known = self.robot.joints.iter().map(|joint| joint.name.as_str());
        let hint = nearest(mimicked, known).map_or_else(String::new, |meant| format!(" (is \"{meant}\" meant?)"));
        self.joint_error(
            joint,
            format!("mimics joint \"{mimicked}\", which the file does not have{hint}"),
            &format!(
                "correct the name in its <mimic>, fix the joint with --lock {}=VALUE, or end the arm before it with --tip LINK",
                joint.name
            ),
        )
    }

    /// The error for a joint that follows a moving one; `others` do so, too.
    fn follows_moving(&self, first: &Follower<'_>, others: &[Follower<'_>], is_recorded: bool) -> ArmError {
        let Follower { joint, mimicked, name } = first;
        let followed =
            if name == mimicked { format!("\"{name}\"") } else { format!("\"{mimicked}\", which follows \"{name}\"") };
        let lock = format!("fix it with --lock {}=VALUE", joint.name);
        let (recorded, mut remedy) = if is_recorded {
            ("is recorded, and ", format!("delete its <mimic> if it has a drive of its own, or {lock}"))
        } else {
            ("", format!("{lock} if its motion matters little, or delete its <mimic> if it has a drive of its own"))
        };
        if !others.is_empty() {
            let names: Vec<&str> = others.iter().map(|other| other.joint.name.as_str()).collect();
            remedy += &format!("; so do {}", names.join(", "));
        }
        self.joint_error(
            joint,
            format!(
                "{recorded}mimics {followed}, a moving joint of the arm, and testbed models joints that move independently"
            ),
            &remedy,
        )
    }

    /// What `joint` follows, which may follow another one.
    fn followed(&self, joint: &'a urdf_rs::Joint, chain: &Chain<'a>) -> Followed<'a> {
        let mut at = joint;
        // There are at most as many steps as joints, unless they follow each other in a circle.
        for _ in 0..self.robot.joints.len() {
            let Some(mimic) = &at.mimic else { break };
            if mimic.multiplier == Some(0.0) {
                break;
            }
            let Some(next) = self.robot.joints.iter().find(|other| other.name == mimic.joint) else {
                return Followed::Unknown(&mimic.joint);
            };
            if chain.position(&next.name).is_none() {
                return Followed::Moving(&next.name);
            }
            let is_locked =
                |fixed: &crate::chain::FixedJoint| fixed.name == next.name && fixed.reason == FixedBecause::Locked;
            if chain.fixed.iter().any(is_locked) {
                break;
            }
            at = next;
        }
        Followed::Fixed
    }

    /// Sets the positions of joints that mimic a fixed one.
    pub(super) fn follow(&self, chain: &mut Chain<'a>) {
        // A mimicked joint may mimic another one: there are at most as many steps as joints.
        for _ in 0..self.robot.joints.len() {
            let mut changed = false;
            for joint in &self.robot.joints {
                let Some(mimic) = &joint.mimic else { continue };
                let fixed = chain.fixed.iter().position(|fixed| fixed.name == joint.name);
                let Some(at) = fixed.filter(|&at| chain.fixed[at].reason != FixedBecause::Locked) else {
                    continue;
                };
                let Some(followed) = chain.positions.get(mimic.joint.as_str()) else {
                    continue;
                };
                let wanted = mimic.multiplier.unwrap_or(1.0) * followed + mimic.offset.unwrap_or(0.0);
                let position = limits(joint).map_or(wanted, |(lower, upper)| wanted.clamp(lower, upper));
                changed |= chain.fixed[at].position != position && position.is_finite();
                if position.is_finite() {
                    chain.fixed[at].position = position;
                    chain.positions.insert(&joint.name, position);
                }
            }
            if !changed {
                break;
            }
        }
    }
}
