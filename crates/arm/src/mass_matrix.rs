//! The joint-space mass matrix by the composite-rigid-body algorithm.

use nalgebra::{DMatrix, Vector3};

use crate::model::{Arm, JointKind};
use crate::pose::cross_matrix;
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
        for (i, joint) in self.joints.iter().enumerate() {
            workspace.links[i].parent_from_link = joint.parent_from_link(q[i]);
        }
        for i in (0..n).rev() {
            let joint = &self.joints[i];
            let body = &joint.inertia;
            let mass = body.mass + distal_mass;
            let first_moment = body.mass * body.com + distal_moment;
            let tensor = body.tensor_about_origin() + distal_tensor;

            // The wrench (about link i's origin) of a unit acceleration of joint i, carried to the base.
            let (mut force, mut moment) = match joint.kind {
                JointKind::Revolute => (joint.axis.cross(&first_moment), tensor * joint.axis),
                JointKind::Prismatic => (mass * joint.axis, first_moment.cross(&joint.axis)),
            };
            for j in (0..=i).rev() {
                let other = &self.joints[j];
                let element = match other.kind {
                    JointKind::Revolute => other.axis.dot(&moment),
                    JointKind::Prismatic => other.axis.dot(&force),
                };
                mass_matrix[(i, j)] = element;
                mass_matrix[(j, i)] = element;
                let pose = &workspace.links[j].parent_from_link;
                force = pose.rotation * force;
                moment = pose.rotation * moment + pose.translation.cross(&force);
            }
            mass_matrix[(i, i)] += joint.rotor_inertia;

            // The composite body in the parent's frame, about the parent's origin.
            let pose = &workspace.links[i].parent_from_link;
            let rotated = pose.rotation * first_moment;
            let p = cross_matrix(&pose.translation);
            let h = cross_matrix(&rotated);
            distal_tensor = pose.rotation * tensor * pose.rotation.transpose() - (p * h + h * p) - mass * p * p;
            distal_moment = rotated + mass * pose.translation;
            distal_mass = mass;
        }
    }
}
