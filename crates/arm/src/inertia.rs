//! The mass of a body and how it is distributed.

use nalgebra::{Matrix3, Vector3};

use crate::pose::{Pose, cross_matrix};

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
        Self { mass: 0.0, com: Vector3::zeros(), tensor: Matrix3::zeros() }
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
        let com = if mass > 0.0 { (self.mass * self.com + other.mass * other.com) / mass } else { Vector3::zeros() };
        let about = |body: &Self| {
            let c = cross_matrix(&(body.com - com));
            body.tensor - body.mass * c * c
        };
        Self { mass, com, tensor: about(self) + about(other) }
    }

    /// The ten inertial parameters in which the torque is linear: m, m c (3), and Ixx, Ixy, Iyy, Ixz, Iyz, Izz about
    /// the link frame's origin (the order of Pinocchio's `Inertia::toDynamicParameters`).
    pub fn parameters(&self) -> [f64; 10] {
        let h = self.mass * self.com;
        let i = self.tensor_about_origin();
        [self.mass, h.x, h.y, h.z, i[(0, 0)], i[(0, 1)], i[(1, 1)], i[(0, 2)], i[(1, 2)], i[(2, 2)]]
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
