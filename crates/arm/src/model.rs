//! The immutable description of a serial arm.

use nalgebra::{Matrix3, Vector3};

use crate::chain::FixedJoint;
use crate::pose::{Pose, cross_matrix};
use crate::visual::Visual;

/// The gravitational acceleration in the paper and in most physics engines, 9.81 m/s².
pub const STANDARD_GRAVITY: f64 = 9.81;

/// How a joint moves its link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Rotates about its axis; q in rad, tau in N m.
    Revolute,
    /// Translates along its axis; q in m, tau in N.
    Prismatic,
}

/// The limits of a joint; an absent limit is infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Smallest position (rad or m).
    pub lower: f64,
    /// Largest position (rad or m).
    pub upper: f64,
    /// Largest speed (rad/s or m/s).
    pub velocity: f64,
    /// Largest torque (N m) or force (N).
    pub effort: f64,
}

/// Mass, centre of mass and rotational inertia of one link, in the link's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass (m).
    pub com: Vector3<f64>,
    /// Inertia tensor about the centre of mass, along the link's axes (kg m²).
    pub tensor: Matrix3<f64>,
}

impl Inertia {
    /// A body without mass.
    pub fn zero() -> Self {
        Self {
            mass: 0.0,
            com: Vector3::zeros(),
            tensor: Matrix3::zeros(),
        }
    }

    /// The inertia tensor about the link frame's origin (kg m²).
    pub fn tensor_about_origin(&self) -> Matrix3<f64> {
        let c = cross_matrix(&self.com);
        self.tensor - self.mass * c * c
    }

    /// This body in the coordinates of another frame, given as `other_from_self`.
    pub fn transformed(&self, other_from_self: &Pose) -> Self {
        let r = other_from_self.rotation;
        Self {
            mass: self.mass,
            com: other_from_self.transform_point(&self.com),
            tensor: r * self.tensor * r.transpose(),
        }
    }

    /// The combination of two bodies that are fixed to each other, in their common frame.
    pub fn merged(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        let com = if mass > 0.0 {
            (self.mass * self.com + other.mass * other.com) / mass
        } else {
            Vector3::zeros()
        };
        let about = |body: &Self| {
            let c = cross_matrix(&(body.com - com));
            body.tensor - body.mass * c * c
        };
        Self {
            mass,
            com,
            tensor: about(self) + about(other),
        }
    }

    /// The ten inertial parameters in which the torque is linear: m, m c (3), and Ixx, Ixy, Iyy, Ixz, Iyz, Izz about
    /// the link frame's origin (the order of Pinocchio's `Inertia::toDynamicParameters`).
    pub fn parameters(&self) -> [f64; 10] {
        let h = self.mass * self.com;
        let i = self.tensor_about_origin();
        [
            self.mass,
            h.x,
            h.y,
            h.z,
            i[(0, 0)],
            i[(0, 1)],
            i[(1, 1)],
            i[(0, 2)],
            i[(1, 2)],
            i[(2, 2)],
        ]
    }

    /// The `<inertial>` element of this body in a URDF. The numbers read back to the same bits.
    pub fn to_urdf(&self) -> String {
        let (c, i) = (self.com, self.tensor);
        format!(
            "<inertial><origin xyz=\"{} {} {}\" rpy=\"0 0 0\"/><mass value=\"{}\"/><inertia ixx=\"{}\" ixy=\"{}\" \
             ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/></inertial>",
            c.x,
            c.y,
            c.z,
            self.mass,
            i[(0, 0)],
            i[(0, 1)],
            i[(0, 2)],
            i[(1, 1)],
            i[(1, 2)],
            i[(2, 2)]
        )
    }
}

/// A body as the algorithms use it: the moments of its mass about its link frame's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moments {
    /// ∫ r dm = m c (kg m).
    pub first: Vector3<f64>,
    /// ∫ r rᵀ dm (kg m²).
    pub second: Matrix3<f64>,
    /// The inertia tensor about the origin, tr(second) 1 − second (kg m²).
    pub tensor: Matrix3<f64>,
}

impl Moments {
    pub(crate) fn of(body: &Inertia) -> Self {
        let tensor = body.tensor_about_origin();
        Self {
            first: body.mass * body.com,
            second: Matrix3::from_diagonal_element(0.5 * tensor.trace()) - tensor,
            tensor,
        }
    }
}

/// One moving joint and the link that it carries, with which the links beyond fixed joints are merged.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// The URDF joint's name.
    pub name: String,
    /// The URDF name of the link it carries.
    pub link_name: String,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Pose of the link frame in the parent link's frame at q = 0.
    pub parent_from_joint: Pose,
    /// Unit axis in the link's frame.
    pub axis: Vector3<f64>,
    /// Position, velocity and effort limits.
    pub limits: Limits,
    /// Inertia of the drive's rotor reflected to the joint (kg m² or kg); 0 from a URDF.
    pub rotor_inertia: f64,
    /// Viscous friction from URDF `<dynamics damping>` (N m s/rad or N s/m). Not part of the rigid dynamics.
    pub damping: f64,
    /// Dry friction from URDF `<dynamics friction>` (N m or N). Not part of the rigid dynamics.
    pub friction: f64,
    /// The link's inertia.
    pub inertia: Inertia,
    /// The moments of that inertia; [`Self::set_inertia`] updates them.
    pub(crate) moments: Moments,
    /// R₀, R₀\[a\]×, R₀\[a\]×²: the rotation is R₀ + sin q R₀\[a\]× + (1 − cos q) R₀\[a\]×² (Rodrigues).
    pub(crate) rotation_terms: [Matrix3<f64>; 3],
    /// R₀ a, the sliding direction in the parent's frame.
    pub(crate) axis_in_parent: Vector3<f64>,
}

impl Joint {
    /// Replaces the link's inertia.
    pub(crate) fn set_inertia(&mut self, inertia: Inertia) {
        self.inertia = inertia;
        self.moments = Moments::of(&inertia);
    }

    /// Pose of the link in its parent at joint position `q` (rad or m).
    #[inline]
    pub fn parent_from_link(&self, q: f64) -> Pose {
        match self.kind {
            JointKind::Revolute => {
                let (sin, cos) = q.sin_cos();
                let [r0, r1, r2] = &self.rotation_terms;
                Pose {
                    rotation: r0 + r1 * sin + r2 * (1.0 - cos),
                    translation: self.parent_from_joint.translation,
                }
            }
            JointKind::Prismatic => Pose {
                rotation: self.rotation_terms[0],
                translation: self.parent_from_joint.translation + self.axis_in_parent * q,
            },
        }
    }
}

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
        self.tool
            .map(|tool| self.frames[tool].clone())
            .unwrap_or_else(|| Frame {
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
        self.joints
            .iter()
            .flat_map(|joint| joint.inertia.parameters())
            .collect()
    }
}
