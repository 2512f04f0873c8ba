//! The joint-space mass matrix by the composite-rigid-body algorithm.

use nalgebra::{DMatrix, Vector3};

use crate::model::{Arm, JointKind};
use crate::small::{cross, mul, rotate_symmetric, symmetric};
use crate::workspace::Workspace;

impl Arm {
    /// M(q), dof × dof, symmetric positive definite (kg m², kg m, kg); rotor inertias on its diagonal.
    ///
    /// Source: Walker and Orin 1982, method 3; Featherstone 2008, table 6.2.
    ///
    /// # Panics
    /// If a slice, the workspace or `mass_matrix` is of another size than the arm.
    pub fn mass_matrix(&self, workspace: &mut Workspace, q: &[f64], mass_matrix: &mut DMatrix<f64>) {
        workspace.check(self, &[q]);
        let n = self.dof();
        assert_eq!(mass_matrix.shape(), (n, n), "the mass matrix is dof × dof");
        // The composite body beyond joint i: mass, first moment m c and inertia about link i's
        // origin. `distal` is the part beyond link i, already in link i's frame.
        let mut distal_mass = 0.0;
        let mut distal_moment = Vector3::zeros();
        let mut distal_tensor = nalgebra::Matrix3::zeros();
        // The joints' inertia does not depend on where the first one stands: its pose is not needed.
        for ((joint, link), &q) in self.joints.iter().zip(&mut workspace.links).zip(q).skip(1) {
            link.parent_from_link = joint.parent_from_link(q);
        }
        for i in (0..n).rev() {
            let joint = &self.joints[i];
            let mass = joint.inertia.mass + distal_mass;
            let first_moment = joint.moments.first + distal_moment;
            let tensor = joint.moments.tensor + distal_tensor;

            // The wrench (about link i's origin) of a unit acceleration of joint i, carried to the base.
            let (mut force, mut moment) = match joint.kind {
                JointKind::Revolute => (cross(&joint.axis, &first_moment), mul(&tensor, &joint.axis)),
                JointKind::Prismatic => (mass * joint.axis, cross(&first_moment, &joint.axis)),
            };
            let column = &mut mass_matrix.as_mut_slice()[i * n..][..=i];
            for ((other, link), element) in self.joints.iter().zip(&workspace.links).zip(column).rev() {
                *element = match other.kind {
                    JointKind::Revolute => other.axis.dot(&moment),
                    JointKind::Prismatic => other.axis.dot(&force),
                };
                let pose = &link.parent_from_link;
                force = mul(&pose.rotation, &force);
                moment = mul(&pose.rotation, &moment) + cross(&pose.translation, &force);
            }
            mass_matrix[(i, i)] += joint.rotor_inertia;

            // The composite body in the parent's frame, about the parent's origin: with the first moment h about the
            // link's origin and p to it, I' = I + (2 p·h + m p²) 1 − (p hᵀ + h pᵀ) − m p pᵀ.
            let pose = &workspace.links[i].parent_from_link;
            let (p, h) = (&pose.translation, mul(&pose.rotation, &first_moment));
            let moved = h + mass * p;
            let both = h + moved;
            let (xx, yy, zz) = (p.x * both.x, p.y * both.y, p.z * both.z);
            distal_tensor = rotate_symmetric(&pose.rotation, &tensor)
                + symmetric(
                    yy + zz,
                    -(p.x * moved.y + h.x * p.y),
                    -(p.x * moved.z + h.x * p.z),
                    xx + zz,
                    -(p.y * moved.z + h.y * p.z),
                    xx + yy,
                );
            distal_moment = moved;
            distal_mass = mass;
        }
        for i in 0..n {
            for j in 0..i {
                mass_matrix[(i, j)] = mass_matrix[(j, i)];
            }
        }
    }
}
