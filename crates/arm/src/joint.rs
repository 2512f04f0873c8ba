//! A joint and the link that it moves.

use nalgebra::{Matrix3, Vector3};

use crate::inertia::{Inertia, Moments};
use crate::pose::{Pose, cross_matrix};
use crate::real::Real;

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
    /// A revolute joint about `axis` at the origin of its parent, without limits and friction, that carries a link without mass.
    pub(crate) fn without_link(name: &str, axis: Vector3<f64>) -> Self {
        let inertia = Inertia { mass: 0.0, com: Vector3::zeros(), tensor: Matrix3::zeros() };
        let cross = cross_matrix(&axis);
        Self {
            name: name.to_owned(),
            link_name: name.to_owned(),
            kind: JointKind::Revolute,
            parent_from_joint: Pose::identity(),
            axis,
            limits: Limits {
                lower: f64::NEG_INFINITY,
                upper: f64::INFINITY,
                velocity: f64::INFINITY,
                effort: f64::INFINITY,
            },
            rotor_inertia: 0.0,
            damping: 0.0,
            friction: 0.0,
            moments: Moments::of(&inertia),
            inertia,
            rotation_terms: [Matrix3::identity(), cross, cross * cross],
            axis_in_parent: axis,
        }
    }

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
                let (sin, cos) = Real::sin_cos(q);
                let [r0, r1, r2] = &self.rotation_terms;
                Pose { rotation: r0 + r1 * sin + r2 * (1.0 - cos), translation: self.parent_from_joint.translation }
            }
            JointKind::Prismatic => Pose {
                rotation: self.rotation_terms[0],
                translation: self.parent_from_joint.translation + self.axis_in_parent * q,
            },
        }
    }
}
