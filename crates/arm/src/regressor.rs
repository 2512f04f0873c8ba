//! The torque regressor: joint torques as a matrix times the links' inertial parameters.

use nalgebra::{DMatrix, Vector3};

use crate::model::{Arm, JointKind};
use crate::small::{cross, tr_mul};
use crate::workspace::{LinkState, Workspace};

/// m, m c (3), Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the link frame's origin.
pub const PARAMETERS_PER_LINK: usize = 10;

impl Arm {
    /// Y(q, q̇, q̈), dof × 10 dof, with τ = Y π for π = [`Arm::inertial_parameters`] (rotor inertias apart).
    ///
    /// Columns come link by link, base to tip, in the order of [`crate::Inertia::parameters`].
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
        assert_eq!(
            regressor.shape(),
            (n, n * PARAMETERS_PER_LINK),
            "the regressor is dof × 10 dof"
        );
        self.propagate_motion(workspace, q, qd, qdd);
        // For link j, the unit motions of joints 0 … j as twists in link j's frame: their power against the wrench that
        // the link needs is the joints' torque (virtual work).
        let Workspace { links, twists, .. } = workspace;
        let links = self.joints.iter().zip(links.iter());
        for (j, ((joint, link), columns)) in links
            .zip(regressor.as_mut_slice().chunks_exact_mut(n * PARAMETERS_PER_LINK))
            .enumerate()
        {
            let pose = &link.parent_from_link;
            for (angular, linear) in &mut twists[..j] {
                *linear = tr_mul(&pose.rotation, &(*linear + cross(angular, &pose.translation)));
                *angular = tr_mul(&pose.rotation, angular);
            }
            twists[j] = match joint.kind {
                JointKind::Revolute => (joint.axis, Vector3::zeros()),
                JointKind::Prismatic => (Vector3::zeros(), joint.axis),
            };
            for (i, (angular, linear)) in twists[..=j].iter().enumerate() {
                let row = wrench_row(link, angular, linear);
                for (column, value) in columns.chunks_exact_mut(n).zip(row) {
                    column[i] = value;
                }
            }
            for column in columns.chunks_exact_mut(n) {
                column[j + 1..].fill(0.0);
            }
        }
    }
}

/// The power of the twist (`angular`, `linear`) against the inertial wrench of one link, per unit of
/// each of its ten parameters. With a = v̇ of the origin less gravity and W = [ω̇]× + [ω]×²:
/// f = m a + W mc, n = mc × a + I ω̇ + ω × I ω.
#[inline(always)]
fn wrench_row(link: &LinkState, angular: &Vector3<f64>, linear: &Vector3<f64>) -> [f64; PARAMETERS_PER_LINK] {
    let (w, wd, a) = (
        &link.angular_velocity,
        &link.angular_acceleration,
        &link.linear_acceleration,
    );
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
