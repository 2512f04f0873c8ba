//! The requirements on a URDF whose robot is a serial arm with masses.

use std::collections::HashSet;

use super::Reader;
use super::lines::line_of;
use crate::error::ArmError;
use crate::inertia::Inertia;
use crate::joint::Joint;
use crate::model::Arm;

impl<'a> Reader<'a> {
    /// Checks that the links form one tree, and returns its root.
    pub(super) fn check_tree(&self) -> Result<&'a str, ArmError> {
        let mut links = HashSet::new();
        for link in &self.robot.links {
            if !links.insert(link.name.as_str()) {
                return Err(self.link_error(&link.name, "occurs twice".into(), "give each link a name of its own"));
            }
        }
        let mut joints = HashSet::new();
        let mut children = HashSet::new();
        for joint in &self.robot.joints {
            if !joints.insert(joint.name.as_str()) {
                return Err(self.joint_error(joint, "occurs twice".into(), "give each joint a name of its own"));
            }
            for end in [&joint.parent.link, &joint.child.link] {
                if !links.contains(end.as_str()) {
                    return Err(self.joint_error(
                        joint,
                        format!("joins link \"{end}\", which the file does not have"),
                        "correct the name or add the link",
                    ));
                }
            }
            if !children.insert(joint.child.link.as_str()) {
                let link = &joint.child.link;
                let same_child = |other: &&urdf_rs::Joint| other.child.link == *link;
                let first = self.robot.joints.iter().find(same_child);
                let first = first.map_or(link, |first| &first.name);
                return Err(self.joint_error(
                    joint,
                    format!("closes a loop: link \"{link}\" is already the child of joint \"{first}\""),
                    &format!(
                        "testbed models serial arms: delete joint \"{}\", or joint \"{first}\" if that one is not driven",
                        joint.name
                    ),
                ));
            }
        }
        if self.robot.links.is_empty() {
            return Err(self.robot_error("has no links".into(), "is this a URDF?"));
        }
        let mut roots = self.robot.links.iter().filter(|link| !children.contains(link.name.as_str()));
        let Some(root) = roots.next() else {
            let into_first = |joint: &&urdf_rs::Joint| joint.child.link == self.robot.links[0].name;
            let closing = self.robot.joints.iter().find(into_first);
            return Err(self.robot_error(
                "has no base: every link is the child of a joint, so the joints form a loop".into(),
                &closing.map_or_else(String::new, |joint| {
                    format!(
                        "delete the joint that closes it: \"{}\" if link \"{}\" is the base",
                        joint.name, joint.child.link
                    )
                }),
            ));
        };
        if let Some(other) = roots.next() {
            return Err(self.link_error(
                &other.name,
                format!("is the child of no joint, and so is link \"{}\": a robot has one root", root.name),
                "join the two parts, or remove one",
            ));
        }
        let mut reached = HashSet::new();
        let mut waiting = vec![root.name.as_str()];
        while let Some(name) = waiting.pop() {
            reached.insert(name);
            let from_here = self.robot.joints.iter().filter(|joint| joint.parent.link == name);
            waiting.extend(from_here.map(|joint| joint.child.link.as_str()));
        }
        match self.robot.joints.iter().find(|joint| !reached.contains(joint.child.link.as_str())) {
            Some(joint) => Err(self.joint_error(
                joint,
                "is part of a loop that does not reach the base".into(),
                &format!(
                    "testbed models serial arms: delete this joint, and join link \"{}\" to the arm",
                    joint.child.link
                ),
            )),
            None => Ok(&root.name),
        }
    }

    /// Refuses the inertia tensor of the newest link if it has a negative principal moment, and warns if it violates
    /// the triangle inequality, so that no distribution of mass has it.
    pub(super) fn check_tensor(&self, arm: &mut Arm) -> Result<(), ArmError> {
        let Some(joint) = arm.joints.last() else { return Ok(()) };
        let mut moments = joint.inertia.tensor.symmetric_eigenvalues();
        moments.as_mut_slice().sort_by(f64::total_cmp);
        let scale = moments.abs().max();
        if moments[0] < -1e-6 * scale {
            return Err(self.link_error(
                &joint.link_name,
                format!("has the principal moment of inertia {:.6} kg m², which is negative", moments[0]),
                "check ixx … izz, and their frame",
            ));
        }
        if moments[0] + moments[1] < moments[2] * (1.0 - 1e-6) {
            let warning = format!(
                "link \"{}\": no body has the principal moments {:.6}, {:.6} and {:.6} kg m² (the two smaller must \
                 add up to the largest at least); taken as they are",
                joint.link_name, moments[0], moments[1], moments[2]
            );
            arm.warnings.push(warning);
        }
        Ok(())
    }

    /// Refuses an arm without any inertia, and warns of each moving link without mass where others have some, and of links that are larger
    /// than the arm or much smaller. Forward dynamics needs [`Arm::massless_joint`] to be `None`.
    pub(super) fn check_masses(&self, arm: &mut Arm) -> Result<(), ArmError> {
        if arm.joints.iter().all(|joint| joint.inertia == Inertia::zero()) {
            return Err(self.robot_error(
                "has no moving link with a mass or an inertia (<inertial>)".into(),
                "dynamics need masses and inertias: export them from the CAD model",
            ));
        }
        let massless = arm.joints.iter().filter(|joint| joint.inertia.mass == 0.0);
        let mut notes: Vec<String> = massless.map(|joint| self.massless(joint)).collect();
        notes.extend(arm.joints.iter().filter_map(|joint| self.larger_than_the_arm(arm, joint)));
        notes.extend(arm.small_bodies());
        arm.warnings.extend(notes);
        Ok(())
    }

    /// The warning that the moments of inertia of the link of `joint` are those of a body larger than the arm with all its links'
    /// centres of mass and travels in one line, as a placeholder of 1 kg m² is.
    fn larger_than_the_arm(&self, arm: &Arm, joint: &Joint) -> Option<String> {
        let (radius, reach) = arm.larger_than_the_arm(joint)?;
        let name = &joint.link_name;
        Some(format!(
            "link \"{name}\" (line {}) has a moment of inertia of {:.3} kg m² and a mass of {:.3} kg, as a body with a radius of \
             gyration of {radius:.2} m, and the arm with all its links in one line is {reach:.2} m long; is it a placeholder? correct its <inertia>",
            line_of(self.text, "link", name),
            joint.inertia.tensor.symmetric_eigenvalues().max(),
            joint.inertia.mass
        ))
    }

    /// The warning that the link of `joint` has no mass.
    fn massless(&self, joint: &Joint) -> String {
        let name = &joint.link_name;
        let line = line_of(self.text, "link", name);
        let rest = if joint.inertia == Inertia::zero() {
            "no mass and no inertia; add its <inertial>, unless it stands for no body"
        } else {
            "an inertia but no mass, which no body has; correct its <mass>, unless it stands for a rotor"
        };
        format!("link \"{name}\" (line {line}), which {} moves, has {rest}", joint.name)
    }
}
