//! Which joints of a URDF move in the arm, and the positions of the others.

use std::collections::{HashMap, HashSet};

use urdf_rs::JointType;

use super::Reader;
use crate::chain::{ChainOptions, FixedBecause, FixedJoint};
use crate::error::ArmError;
use crate::joint::JointKind;
use crate::pose::Pose;

/// Words in the names of grippers' joints.
const GRIPPER_WORDS: [&str; 5] = ["gripper", "finger", "knuckle", "jaw", "thumb"];

/// An error counts the runs of joints instead of listing them if there are more than this.
const MOST_RUNS: usize = 12;

/// The joints of the arm.
pub(super) struct Chain<'a> {
    /// The link that does not move.
    pub(super) base: &'a str,
    /// The tip, if one was chosen.
    pub(super) tip: Option<&'a str>,
    /// The joints that could move and are fixed.
    pub(super) fixed: Vec<FixedJoint>,
    /// What is doubtful about them.
    pub(super) warnings: Vec<String>,
    /// All joints that do not move, each with its position (rad or m).
    pub(super) positions: HashMap<&'a str, f64>,
}

impl Chain<'_> {
    /// The position at which a joint is fixed (rad or m); `None` if it moves.
    pub(super) fn position(&self, joint: &str) -> Option<f64> {
        self.positions.get(joint).copied()
    }
}

type Joints<'a> = Vec<&'a urdf_rs::Joint>;

fn is_movable(joint: &urdf_rs::Joint) -> bool {
    matches!(joint.joint_type, JointType::Revolute | JointType::Continuous | JointType::Prismatic)
}

pub(super) fn kind(joint: &urdf_rs::Joint) -> JointKind {
    match joint.joint_type {
        JointType::Prismatic => JointKind::Prismatic,
        _ => JointKind::Revolute,
    }
}

/// The limits of a joint's position, if they are plausible.
pub(super) fn limits(joint: &urdf_rs::Joint) -> Option<(f64, f64)> {
    let (lower, upper) = (joint.limit.lower, joint.limit.upper);
    (joint.joint_type != JointType::Continuous && lower < upper).then_some((lower, upper))
}

/// Zero, or the nearest position within the limits.
fn resting(joint: &urdf_rs::Joint) -> f64 {
    limits(joint).map_or(0.0, |(lower, upper)| 0.0_f64.clamp(lower, upper))
}

fn is_gripper(joint: &urdf_rs::Joint) -> bool {
    let name = joint.name.to_lowercase();
    GRIPPER_WORDS.iter().any(|word| name.contains(word))
}

/// The flags that choose the joints of `way` from `start` on, and those that choose all of them.
fn choice(base: &str, start: usize, way: &[&urdf_rs::Joint]) -> String {
    let Some(last) = way.last() else { return String::new() };
    let flags = |base: &str, joints: &[&urdf_rs::Joint]| {
        let tip = &last.child.link;
        match joints {
            [_] => format!("--base {base} --tip {tip} (1 joint: {})", last.name),
            _ => format!("--base {base} --tip {tip} ({} joints: {} … {})", joints.len(), joints[0].name, last.name),
        }
    };
    match start {
        0 => flags(base, way),
        _ => format!("{} or {}", flags(&way[start].parent.link, &way[start..]), flags(base, way)),
    }
}

impl<'a> Reader<'a> {
    /// Chooses the arm's joints below `root` according to `options`.
    ///
    /// # Errors
    /// If a link or joint in `options` does not exist, or if several chains are possible; the error lists their tips.
    pub(super) fn choose(&self, root: &'a str, options: &ChainOptions) -> Result<Chain<'a>, ArmError> {
        let base = options.base.as_deref().map_or(Ok(root), |name| self.link(name, "--base"))?;
        let tip = options.tip.as_deref().map(|name| self.link(name, "--tip")).transpose()?;
        self.check_locks(options)?;
        let locked = |joint: &urdf_rs::Joint| options.locks.iter().any(|(name, _)| *name == joint.name);
        let can_move = |joint: &urdf_rs::Joint| is_movable(joint) && joint.mimic.is_none() && !locked(joint);
        let below = self.below(base);
        let candidates: Joints<'a> = below.iter().copied().filter(|joint| can_move(joint)).collect();
        let (moving, grippers) = match tip {
            Some(tip) => {
                let path = self.path(tip, base).ok_or_else(|| {
                    let is_opposite = self.path(base, tip).is_some();
                    self.link_error(
                        tip,
                        format!("is not below link \"{base}\", the base, in the tree of links"),
                        if is_opposite {
                            "exchange --base and --tip"
                        } else {
                            "give a --base on its way from the root, or another --tip"
                        },
                    )
                })?;
                (path.into_iter().filter(|joint| can_move(joint)).collect(), Vec::new())
            }
            None => {
                let (grippers, moving) = self.grippers(base, candidates);
                let moving = self.recorded(base, moving, &options.recorded);
                self.check_chain(base, &moving)?;
                (moving, grippers)
            }
        };
        self.check_kinds(base, &moving)?;
        let mut chain = Chain { base, tip, fixed: Vec::new(), warnings: Vec::new(), positions: HashMap::new() };
        let names = |list: &Joints<'_>, joint: &urdf_rs::Joint| list.iter().any(|other| other.name == joint.name);
        for joint in self.robot.joints.iter().filter(|joint| !names(&moving, joint)) {
            let lock = options.locks.iter().find(|(name, _)| *name == joint.name);
            let position = lock.map_or_else(|| resting(joint), |(_, value)| *value);
            chain.positions.insert(&joint.name, position);
            if !is_movable(joint) {
                continue;
            }
            let reason = match &joint.mimic {
                _ if lock.is_some() => FixedBecause::Locked,
                Some(mimic) => FixedBecause::Mimics(mimic.joint.clone()),
                None if names(&grippers, joint) => FixedBecause::Gripper,
                None if tip.is_none() && names(&below, joint) => FixedBecause::NotRecorded,
                None => FixedBecause::OffChain,
            };
            let carried = self.path(&joint.parent.link, base);
            chain.fixed.push(FixedJoint {
                name: joint.name.clone(),
                kind: kind(joint),
                position,
                parent_from_child: Pose::identity(),
                reason,
                is_carried: carried.is_some_and(|path| path.iter().any(|joint| names(&moving, joint))),
            });
        }
        self.check_mimics(&mut chain, &options.recorded)?;
        self.follow(&mut chain);
        for fixed in &mut chain.fixed {
            if let Some(joint) = self.robot.joints.iter().find(|joint| joint.name == fixed.name) {
                fixed.parent_from_child = self.fixed_pose(joint, fixed.position)?;
            }
        }
        Ok(chain)
    }

    /// The joints below link `base`, in the order of the file.
    fn below(&self, base: &'a str) -> Joints<'a> {
        let mut children: HashMap<&str, Vec<&str>> = HashMap::new();
        for joint in &self.robot.joints {
            children.entry(&joint.parent.link).or_default().push(&joint.child.link);
        }
        let (mut reached, mut open) = (HashSet::from([base]), vec![base]);
        while let Some(link) = open.pop() {
            open.extend(children.remove(link).into_iter().flatten().filter(|child| reached.insert(child)));
        }
        self.robot.joints.iter().filter(|joint| reached.contains(joint.parent.link.as_str())).collect()
    }

    /// The joints from link `base` to link `link`; `None` if `link` is not below `base`.
    pub(super) fn path(&self, link: &str, base: &str) -> Option<Joints<'a>> {
        let mut path = Vec::new();
        let mut at = link;
        while at != base {
            let joint = self.robot.joints.iter().find(|joint| joint.child.link == at)?;
            path.push(joint);
            at = &joint.parent.link;
        }
        path.reverse();
        Some(path)
    }

    fn link(&self, name: &str, flag: &str) -> Result<&'a str, ArmError> {
        let found = self.robot.links.iter().find(|link| link.name == name);
        found.map(|link| link.name.as_str()).ok_or_else(|| {
            let joint = self.robot.joints.iter().find(|joint| joint.name == name);
            if let Some(joint) = joint {
                return self.robot_error(
                    format!("has no link \"{name}\" for {flag}, but a joint of this name"),
                    &format!("the link that it moves is {}", joint.child.link),
                );
            }
            let links: Vec<&str> = self.robot.links.iter().map(|link| link.name.as_str()).collect();
            self.robot_error(
                format!("has no link \"{name}\" for {flag}"),
                &format!("its links are {}", links.join(", ")),
            )
        })
    }

    fn check_locks(&self, options: &ChainOptions) -> Result<(), ArmError> {
        for (place, (name, value)) in options.locks.iter().enumerate() {
            let before = options.locks[..place].iter().find(|(other, _)| other == name);
            if let Some((_, other)) = before.filter(|(_, other)| other != value) {
                return Err(self.robot_error(
                    format!("has one joint \"{name}\", which is locked at {other} and at {value}"),
                    "give one --lock for each joint",
                ));
            }
            let movable = self.robot.joints.iter().filter(|joint| is_movable(joint));
            let Some(joint) = movable.clone().find(|joint| joint.name == *name) else {
                let known: Vec<&str> = movable.map(|joint| joint.name.as_str()).collect();
                return Err(self.robot_error(
                    format!("has no moving joint \"{name}\" for --lock"),
                    &format!("its moving joints are {}", known.join(", ")),
                ));
            };
            let outside = limits(joint).filter(|(lower, upper)| !(*lower - 1e-9..=*upper + 1e-9).contains(value));
            if let Some((lower, upper)) = outside {
                return Err(self.joint_error(
                    joint,
                    format!("is locked at {value}, outside its limits {lower} … {upper}"),
                    "give --lock a position in rad or m",
                ));
            }
            if !value.is_finite() {
                return Err(self.joint_error(
                    joint,
                    format!("is locked at {value}"),
                    "give --lock a position in rad or m",
                ));
            }
        }
        Ok(())
    }

    /// Divides `joints` into those of grippers and the others. Beyond a gripper's joint there are only gripper joints;
    /// if all joints have such names, none counts as one.
    fn grippers(&self, base: &str, joints: Joints<'a>) -> (Joints<'a>, Joints<'a>) {
        let is_beyond = |joint: &urdf_rs::Joint, other: &urdf_rs::Joint| {
            self.path(&other.child.link, base).is_some_and(|path| path.iter().any(|on_way| on_way.name == joint.name))
        };
        let (grippers, others): (Joints<'a>, Joints<'a>) = joints
            .iter()
            .partition(|joint| joints.iter().filter(|other| is_beyond(joint, other)).all(|other| is_gripper(other)));
        if others.is_empty() { (others, joints) } else { (grippers, others) }
    }

    /// The recorded joints, and the joints between two of them, which are missing in the recording and not fixed. All
    /// joints if none is recorded.
    fn recorded(&self, base: &str, joints: Joints<'a>, recorded: &[String]) -> Joints<'a> {
        let is_recorded = |joint: &urdf_rs::Joint| recorded.contains(&joint.name);
        if !joints.iter().any(|joint| is_recorded(joint)) {
            return joints;
        }
        let ways: Vec<Joints<'a>> = joints
            .iter()
            .filter(|joint| is_recorded(joint))
            .filter_map(|joint| self.path(&joint.child.link, base))
            .collect();
        let is_between = |joint: &urdf_rs::Joint| {
            ways.iter().any(|way| {
                let at = way.iter().position(|on_way| on_way.name == joint.name);
                at.is_some_and(|at| way[..at].iter().any(|before| is_recorded(before)))
            })
        };
        joints.into_iter().filter(|joint| is_recorded(joint) || is_between(joint)).collect()
    }

    /// Refuses joints that do not form one chain; the error lists the unbranched runs of joints, the longest first.
    fn check_chain(&self, base: &str, moving: &Joints<'a>) -> Result<(), ArmError> {
        let is_moving = |joint: &urdf_rs::Joint| moving.iter().any(|other| other.name == joint.name);
        let ways: Vec<Joints<'a>> = moving
            .iter()
            .map(|joint| {
                let path = self.path(&joint.child.link, base).unwrap_or_default();
                path.into_iter().filter(|joint| is_moving(joint)).collect()
            })
            .collect();
        // The number of moving joints directly beyond a path: the paths that are longer by one joint.
        let next = |way: &Joints<'a>| -> usize {
            let is_next = |longer: &&Joints<'a>| {
                longer.len() == way.len() + 1 && way.iter().zip(longer.iter()).all(|(a, b)| a.name == b.name)
            };
            ways.iter().filter(is_next).count()
        };
        let branches = ways.iter().filter(|way| next(way) == 0).count();
        if branches < 2 {
            return Ok(());
        }
        let branches_after = |count: usize, way: &Joints<'a>| next(&way[..count].to_vec()) > 1;
        let mut runs: Vec<(usize, &Joints<'a>)> = ways
            .iter()
            .filter(|way| next(way) != 1)
            .map(|way| {
                let start = (0..way.len()).rev().find(|&count| branches_after(count, way));
                (start.unwrap_or(0), way)
            })
            .collect();
        runs.sort_by_key(|(start, way)| (std::cmp::Reverse(way.len() - start), *start));
        let mut choices: Vec<String> =
            runs.iter().take(MOST_RUNS).map(|(start, way)| choice(base, *start, way)).collect();
        if runs.len() > MOST_RUNS {
            choices.push(format!("and {} more", runs.len() - MOST_RUNS));
        }
        Err(self.robot_error(
            format!("branches into chains of moving joints with {branches} ends, and an arm is one chain"),
            &format!("choose one:\n  {}", choices.join("\n  ")),
        ))
    }

    /// Refuses joints of other types between the base and a moving joint.
    fn check_kinds(&self, base: &str, moving: &Joints<'a>) -> Result<(), ArmError> {
        let on_way = |joint: &&'a urdf_rs::Joint| self.path(&joint.child.link, base).unwrap_or_default();
        let mut ways: Joints<'a> = moving.iter().flat_map(on_way).collect();
        if moving.is_empty() {
            ways.extend(&self.robot.joints);
        }
        let other = |joint: &&urdf_rs::Joint| !is_movable(joint) && joint.joint_type != JointType::Fixed;
        ways.into_iter().find(other).map_or(Ok(()), |joint| {
            Err(self.joint_error(
                joint,
                format!("is {:?}", joint.joint_type).to_lowercase(),
                &format!(
                    "testbed models fixed, revolute, continuous and prismatic joints only: choose the part beyond it with \
                     --base {}",
                    joint.child.link
                ),
            ))
        })
    }
}
