//! The torque regressor: joint torques as a matrix times the links' inertial parameters.

use nalgebra::{DMatrix, Vector3};

use crate::model::{Arm, JointKind};
use crate::workspace::Workspace;

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
        regressor.fill(0.0);
        self.propagate_motion(workspace, q, qd, qdd);
        for i in 0..n {
            // The unit motion of joint i as a twist (angular, linear) in link j's frame, j = i, i+1, …:
            // its power against the wrench that link j needs is joint i's torque (virtual work).
            let axis = self.joints[i].axis;
            let (mut angular, mut linear) = match self.joints[i].kind {
                JointKind::Revolute => (axis, Vector3::zeros()),
                JointKind::Prismatic => (Vector3::zeros(), axis),
            };
            for j in i..n {
                let link = &workspace.links[j];
                if j > i {
                    let pose = &link.parent_from_link;
                    linear = pose.rotation.tr_mul(&(linear + angular.cross(&pose.translation)));
                    angular = pose.rotation.tr_mul(&angular);
                }
                let row = wrench_row(
                    &link.angular_velocity,
                    &link.angular_acceleration,
                    &link.linear_acceleration,
                    &angular,
                    &linear,
                );
                for (k, value) in row.iter().enumerate() {
                    regressor[(i, j * PARAMETERS_PER_LINK + k)] = *value;
                }
            }
        }
    }
}

/// The power of the twist (`angular`, `linear`) against the inertial wrench of one link, per unit of
/// each of its ten parameters. With a = v̇ of the origin less gravity:
/// f = m a + (ω̇× + ω×ω×) mc, n = mc × a + I ω̇ + ω × I ω.
fn wrench_row(
    w: &Vector3<f64>,
    wd: &Vector3<f64>,
    a: &Vector3<f64>,
    angular: &Vector3<f64>,
    linear: &Vector3<f64>,
) -> [f64; PARAMETERS_PER_LINK] {
    // linear · (ω̇ × h + ω × (ω × h)) + angular · (h × a), as a vector dotted with h = mc.
    let h = linear.cross(wd) + w.cross(&w.cross(linear)) + a.cross(angular);
    // angular · (I ω̇) + (angular × ω) · (I ω): a symmetric bilinear form in I.
    let s = angular.cross(w);
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
