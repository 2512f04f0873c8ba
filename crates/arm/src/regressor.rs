//! The torque regressor: joint torques as a matrix times the links' inertial parameters.

use nalgebra::DMatrix;

use crate::joint::JointKind;
use crate::model::Arm;
use crate::real::Real;
use crate::scratch::{LinkMotion, Scratch};
use crate::small::{Vec3, cross, tr_mul};
use crate::workspace::Workspace;

/// The inertial parameters m, m c (3), Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the link frame's origin.
pub const PARAMETERS_PER_LINK: usize = 10;

impl Arm {
    /// Y(q, q̇, q̈), dof × 10 dof, with τ = Y π for π = [`Arm::inertial_parameters`]; the torque of the rotor inertias
    /// is not part of it.
    ///
    /// The columns are ordered by link, base to tip, and within a link as in [`crate::Inertia::parameters`].
    /// Source: Atkeson, An and Hollerbach 1986, equations 15 to 21.
    ///
    /// # Panics
    /// If a slice, the workspace or `regressor` is of another size than the arm.
    pub fn torque_regressor(
        &self,
        workspace: &mut Workspace,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        regressor: &mut DMatrix<f64>,
    ) {
        workspace.check(self, &[q, qd, qdd]);
        let n = self.dof();
        assert_eq!(regressor.shape(), (n, n * PARAMETERS_PER_LINK), "the regressor is dof × 10 dof");
        regressor.as_mut_slice().fill(0.0);
        self.link_powers((), &mut workspace.scratch, q, qd, qdd, regressor.as_mut_slice());
    }

    /// The recursion of [`Self::torque_regressor`]; `regressor` is stored column after column. Its entries for the
    /// joints beyond each link are zero and are not written.
    #[inline(always)]
    pub(crate) fn link_powers<T: Real>(
        &self,
        context: T::Context,
        scratch: &mut Scratch<T>,
        q: &[T],
        qd: &[T],
        qdd: &[T],
        regressor: &mut [T],
    ) {
        let n = self.dof();
        self.propagate_motion(context, scratch, q, qd, qdd);
        // For link j, the unit motions of joints 0 … j as twists in link j's frame. The power of such a twist with the
        // wrench that accelerates the link is the joint's torque (virtual work).
        let Scratch { places, motions, twists, .. } = scratch;
        let zero = Vec3::zeros(context);
        let links = self.joints.iter().zip(places.iter().zip(motions.iter()));
        for (j, ((joint, (place, link)), columns)) in
            links.zip(regressor.chunks_exact_mut(n * PARAMETERS_PER_LINK)).enumerate()
        {
            for (angular, linear) in &mut twists[..j] {
                *linear = tr_mul(&place.rotation, &(*linear + cross(angular, &place.translation)));
                *angular = tr_mul(&place.rotation, angular);
            }
            let axis = Vec3::constant(context, &joint.axis);
            twists[j] = match joint.kind {
                JointKind::Revolute => (axis, zero),
                JointKind::Prismatic => (zero, axis),
            };
            for (i, (angular, linear)) in twists[..=j].iter().enumerate() {
                let row = wrench_row(link, angular, linear);
                for (column, value) in columns.chunks_exact_mut(n).zip(row) {
                    column[i] = value;
                }
            }
        }
    }
}

/// The power of the twist (`angular`, `linear`) with the inertial wrench of one link, per unit of each of its ten
/// parameters. With a = v̇ of the origin minus gravity and W = \[ω̇\]× + \[ω\]×²: f = m a + W mc, n = mc × a + I ω̇ + ω ×
/// I ω.
#[inline(always)]
fn wrench_row<T: Real>(link: &LinkMotion<T>, angular: &Vec3<T>, linear: &Vec3<T>) -> [T; PARAMETERS_PER_LINK] {
    let (w, wd, a) = (&link.angular_velocity, &link.angular_acceleration, &link.linear_acceleration);
    // linear · W h + angular · (h × a), as a vector dotted with h = mc.
    let h = tr_mul(&link.field, linear) + cross(a, angular);
    // angular · (I ω̇) + (angular × ω) · (I ω): a symmetric bilinear form in I.
    let s = cross(angular, w);
    [
        linear.dot(a),
        h.x,
        h.y,
        h.z,
        angular.x * wd.x + s.x * w.x,
        angular.x * wd.y + angular.y * wd.x + s.x * w.y + s.y * w.x,
        angular.y * wd.y + s.y * w.y,
        angular.x * wd.z + angular.z * wd.x + s.x * w.z + s.z * w.x,
        angular.y * wd.z + angular.z * wd.y + s.y * w.z + s.z * w.y,
        angular.z * wd.z + s.z * w.z,
    ]
}
