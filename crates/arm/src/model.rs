//! The immutable description of a serial arm.

use nalgebra::Vector3;

use crate::chain::FixedJoint;
use crate::inertia::Inertia;
use crate::joint::Joint;
use crate::pose::Pose;
use crate::visual::Visual;

/// The gravitational acceleration in the paper and in most physics engines, 9.81 m/s².
pub const STANDARD_GRAVITY: f64 = 9.81;

/// A named frame that is fixed to a link, such as a flange or a tool behind a fixed joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The URDF link's name.
    pub name: String,
    /// The moving link that it is fixed to, as an index into [`Arm::joints`]; `None` is the base.
    pub link: Option<usize>,
    /// Its pose in that link's frame.
    pub link_from_frame: Pose,
}

/// A body that the URDF fixes to the last moving link, such as a tool: a link beyond a fixed joint with all that it carries.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedBody {
    /// The URDF name of the link.
    pub name: String,
    /// Its inertia in the frame of the last moving link, of which [`Joint::inertia`] is the sum.
    pub inertia: Inertia,
}

/// A serial arm of revolute and prismatic joints on a fixed base.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    pub(crate) name: String,
    pub(crate) base_link: String,
    pub(crate) joints: Vec<Joint>,
    pub(crate) frames: Vec<Frame>,
    /// The index of the tool's frame; `None` is the last link itself.
    pub(crate) tool: Option<usize>,
    pub(crate) fixed_bodies: Vec<FixedBody>,
    pub(crate) fixed_joints: Vec<FixedJoint>,
    pub(crate) visuals: Vec<Visual>,
    pub(crate) gravity: Vector3<f64>,
    pub(crate) warnings: Vec<String>,
}

impl Arm {
    /// The robot's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The link that does not move: the URDF's root link, or the base that was chosen.
    pub fn base_link(&self) -> &str {
        &self.base_link
    }

    /// The moving joints, base to tip.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// The number of moving joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// The frames of the links that are merged because their joints are fixed.
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// The joints of the robot that could move and are fixed in this arm, or are not part of it.
    pub fn fixed_joints(&self) -> &[FixedJoint] {
        &self.fixed_joints
    }

    /// The frame at the end of the arm: the tip if one was chosen, otherwise the last frame that the URDF fixes to the
    /// last link, or that link itself.
    pub fn tool_frame(&self) -> Frame {
        let last = self.dof() - 1;
        self.tool.map(|tool| self.frames[tool].clone()).unwrap_or_else(|| Frame {
            name: self.joints[last].link_name.clone(),
            link: Some(last),
            link_from_frame: Pose::identity(),
        })
    }

    /// The bodies that the URDF fixes to the last moving link and that could be taken off, so that some mass is left.
    pub fn fixed_bodies(&self) -> &[FixedBody] {
        &self.fixed_bodies
    }

    /// The visual shapes of the URDF.
    pub fn visuals(&self) -> &[Visual] {
        &self.visuals
    }

    /// Gravitational acceleration in the base frame (m/s²), by default 9.81 along −z.
    pub fn gravity(&self) -> &Vector3<f64> {
        &self.gravity
    }

    /// Doubtful values in the URDF that were accepted.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The ten inertial parameters of every link, base to tip: the vector that the torque regressor multiplies.
    pub fn inertial_parameters(&self) -> Vec<f64> {
        self.joints.iter().flat_map(|joint| joint.inertia.parameters()).collect()
    }
}
