//! Kinetic and potential energy.

use nalgebra::Vector3;

use crate::model::Arm;
use crate::workspace::Workspace;

impl Arm {
    /// The kinetic energy ½ q̇ᵀ M(q) q̇ (J), rotors included, computed from the links' velocities and not from the
    /// mass matrix.
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn kinetic_energy(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64]) -> f64 {
        workspace.check(self, &[q, qd]);
        let mut w = Vector3::zeros();
        let mut v = Vector3::zeros();
        let mut energy = 0.0;
        for (i, joint) in self.joints.iter().enumerate() {
            let pose = joint.parent_from_link(q[i]);
            v = pose.rotation.tr_mul(&(v + w.cross(&pose.translation)));
            w = pose.rotation.tr_mul(&w);
            match joint.kind {
                crate::JointKind::Revolute => w += joint.axis * qd[i],
                crate::JointKind::Prismatic => v += joint.axis * qd[i],
            }
            let body = &joint.inertia;
            let v_com = v + w.cross(&body.com);
            energy += 0.5 * (body.mass * v_com.norm_squared() + w.dot(&(body.tensor * w)));
            energy += 0.5 * joint.rotor_inertia * qd[i] * qd[i];
        }
        energy
    }

    /// The potential energy −Σ m gᵀ c (J); it is zero for masses at the height of the base's origin.
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn potential_energy(&self, workspace: &mut Workspace, q: &[f64]) -> f64 {
        self.forward_kinematics(workspace, q);
        let links = self.joints.iter().zip(&workspace.base_from_link);
        links
            .map(|(joint, base_from_link)| {
                let com = base_from_link.transform_point(&joint.inertia.com);
                -joint.inertia.mass * self.gravity.dot(&com)
            })
            .sum()
    }
}
