//! The joint-space mass matrix by the composite-rigid-body algorithm.

use nalgebra::DMatrix;

use crate::joint::JointKind;
use crate::model::Arm;
use crate::real::Real;
use crate::scratch::Scratch;
use crate::small::{Mat3, Vec3, cross, mul, rotate_symmetric, symmetric, tr_mul};
use crate::workspace::Workspace;

impl Arm {
    /// The mass matrix M(q), dof × dof, symmetric positive definite (kg m², kg m, kg), with the rotor inertias on its
    /// diagonal.
    ///
    /// Source: Walker and Orin 1982, method 3; Featherstone 2008, table 6.2.
    ///
    /// # Panics
    /// If a slice, the workspace or `mass_matrix` is of another size than the arm.
    pub fn mass_matrix(&self, workspace: &mut Workspace, q: &[f64], mass_matrix: &mut DMatrix<f64>) {
        workspace.check(self, &[q]);
        let n = self.dof();
        assert_eq!(mass_matrix.shape(), (n, n), "the mass matrix is dof × dof");
        self.composite_bodies((), &mut workspace.scratch, q, mass_matrix.as_mut_slice());
    }

    /// The recursion of [`Self::mass_matrix`]; `mass_matrix` is stored column after column.
    #[inline(always)]
    pub(crate) fn composite_bodies<T: Real>(
        &self,
        context: T::Context,
        scratch: &mut Scratch<T>,
        q: &[T],
        mass_matrix: &mut [T],
    ) {
        let n = self.dof();
        // The composite body beyond joint i: mass, first moment m c and inertia about link i's origin. `distal` is the
        // part beyond link i, in link i's frame.
        let mut distal_mass = 0.0;
        let mut distal_moment = Vec3::zeros(context);
        let mut distal_tensor = Mat3::zeros(context);
        // The mass matrix does not depend on the pose of the first link in the base, which is therefore not computed.
        self.place(context, scratch, q, 1);
        let places = &scratch.places;
        let base = &self.joints[0];
        let base_axis = Vec3::constant(context, &base.axis);
        // The unit motion of the first joint at link 1, about its origin and in its frame: angular and linear part. The wrenches
        // need not be carried farther than to link 1.
        let base_motion = match (places.get(1), base.kind) {
            (None, _) => (base_axis, base_axis),
            (Some(place), JointKind::Revolute) => {
                (tr_mul(&place.rotation, &base_axis), tr_mul(&place.rotation, &cross(&base_axis, &place.translation)))
            }
            (Some(place), JointKind::Prismatic) => (Vec3::zeros(context), tr_mul(&place.rotation, &base_axis)),
        };
        for i in (0..n).rev() {
            let joint = &self.joints[i];
            let joint_mass = joint.inertia.mass + distal_mass;
            let mass = T::constant(context, joint_mass);
            let first_moment = Vec3::constant(context, &joint.moments.first) + distal_moment;
            let tensor = Mat3::constant(context, &joint.moments.tensor) + distal_tensor;

            // The wrench (about link i's origin) of a unit acceleration of joint i, carried to the base.
            let axis = Vec3::constant(context, &joint.axis);
            let (mut force, mut moment) = match joint.kind {
                JointKind::Revolute => (cross(&axis, &first_moment), mul(&tensor, &axis)),
                JointKind::Prismatic => (axis * mass, cross(&first_moment, &axis)),
            };
            for (j, (other, place)) in self.joints[..=i].iter().zip(places).enumerate().skip(1).rev() {
                let axis = Vec3::constant(context, &other.axis);
                let entry = match other.kind {
                    JointKind::Revolute => axis.dot(&moment),
                    JointKind::Prismatic => axis.dot(&force),
                };
                mass_matrix[i * n + j] = entry;
                mass_matrix[j * n + i] = entry;
                if j > 1 {
                    force = mul(&place.rotation, &force);
                    moment = mul(&place.rotation, &moment) + cross(&place.translation, &force);
                }
            }
            let entry = match base.kind {
                _ if i > 0 => base_motion.0.dot(&moment) + base_motion.1.dot(&force),
                JointKind::Revolute => base_axis.dot(&moment),
                JointKind::Prismatic => base_axis.dot(&force),
            };
            mass_matrix[i * n] = entry;
            mass_matrix[i] = entry;
            mass_matrix[i * n + i] += T::constant(context, joint.rotor_inertia);
            if i == 0 {
                break;
            }

            // The composite body in the parent's frame, about the parent's origin: with the first moment h about the
            // link's origin and p to it, I' = I + (2 p·h + m p²) 1 − (p hᵀ + h pᵀ) − m p pᵀ.
            let place = &places[i];
            let (p, h) = (&place.translation, mul(&place.rotation, &first_moment));
            let moved = h + *p * mass;
            let both = h + moved;
            let (xx, yy, zz) = (p.x * both.x, p.y * both.y, p.z * both.z);
            distal_tensor = rotate_symmetric(&place.rotation, &tensor)
                + symmetric(
                    yy + zz,
                    -(p.x * moved.y + h.x * p.y),
                    -(p.x * moved.z + h.x * p.z),
                    xx + zz,
                    -(p.y * moved.z + h.y * p.z),
                    xx + yy,
                );
            distal_moment = moved;
            distal_mass = joint_mass;
        }
    }
}
