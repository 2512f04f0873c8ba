//! Recursive Newton-Euler inverse dynamics, and the features Independent Joint Learning takes from it.

use nalgebra::{Matrix3, Vector3};

use crate::model::{Arm, JointKind};
use crate::small::{acceleration_tensor, cross, field_moment, mul, tr_mul};
use crate::workspace::Workspace;

/// How many Newton-Euler features a joint has: the paper's twelve, and its own torque as the thirteenth.
pub const FEATURES: usize = 13;

/// What joint i feels, in the order ω_i, ω̇_i (link i's frame), τ_{i+1}, f_{i+1} (link i+1's frame,
/// about joint i+1's origin; zero at the tip), τ_i: rad/s, rad/s², N m, N, N m (or N, if prismatic).
///
/// The first twelve are the inputs of equation 19 and Table I of the paper, all thirteen those of
/// its algorithms 1 to 3.
pub type NewtonEulerFeatures = [f64; FEATURES];

impl Arm {
    /// The joint torques (N m or N) that produce `qdd` at `q`, `qd`: τ = M(q) q̈ + C(q, q̇) q̇ + g(q).
    ///
    /// All slices have one entry a joint. Source: Luh, Walker and Paul 1980; Um, Park and Park,
    /// equations 10 to 16, gravity entering as an upward acceleration of the base.
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn inverse_dynamics(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        workspace.check(self, &[q, qd, qdd, tau]);
        self.propagate_motion(workspace, q, qd, qdd);
        self.propagate_wrenches(workspace, qdd, tau);
    }

    /// [`Self::inverse_dynamics`], and the Newton-Euler features of every joint (algorithm 1 of the paper).
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn newton_euler_features(
        &self,
        workspace: &mut Workspace,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        tau: &mut [f64],
        features: &mut [NewtonEulerFeatures],
    ) {
        self.inverse_dynamics(workspace, q, qd, qdd, tau);
        assert_eq!(features.len(), self.dof(), "one set of features a joint");
        let zero = Vector3::zeros();
        for (i, feature) in features.iter_mut().enumerate() {
            let link = &workspace.links[i];
            let (moment, force) = workspace
                .links
                .get(i + 1)
                .map_or((zero, zero), |next| (next.moment, next.force));
            feature[0..3].copy_from_slice(link.angular_velocity.as_slice());
            feature[3..6].copy_from_slice(link.angular_acceleration.as_slice());
            feature[6..9].copy_from_slice(moment.as_slice());
            feature[9..12].copy_from_slice(force.as_slice());
            feature[12] = tau[i];
        }
    }

    /// C(q, q̇) q̇ + g(q), the torque at no acceleration (N m or N).
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn bias_torque(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], tau: &mut [f64]) {
        let zeros = std::mem::take(&mut workspace.zeros);
        self.inverse_dynamics(workspace, q, qd, &zeros, tau);
        workspace.zeros = zeros;
    }

    /// g(q), the torque that holds the arm at rest (N m or N).
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn gravity_torque(&self, workspace: &mut Workspace, q: &[f64], tau: &mut [f64]) {
        let zeros = std::mem::take(&mut workspace.zeros);
        self.inverse_dynamics(workspace, q, &zeros, &zeros, tau);
        workspace.zeros = zeros;
    }

    /// Base to tip: each link's pose in its parent, ω, ω̇, and v̇ less gravity, in its own frame.
    pub(crate) fn propagate_motion(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64]) {
        let mut w = Vector3::zeros();
        let mut vd = -self.gravity;
        let mut field = Matrix3::zeros();
        let mut wd = Vector3::zeros();
        let joints = self.joints.iter().zip(&mut workspace.links);
        for (((joint, link), (&q, &qd)), &qdd) in joints.zip(q.iter().zip(qd)).zip(qdd) {
            let pose = joint.parent_from_link(q);
            vd = tr_mul(&pose.rotation, &(vd + mul(&field, &pose.translation)));
            w = tr_mul(&pose.rotation, &w);
            wd = tr_mul(&pose.rotation, &wd);
            let velocity = joint.axis * qd;
            let acceleration = joint.axis * qdd;
            match joint.kind {
                JointKind::Revolute => {
                    wd += acceleration + cross(&w, &velocity);
                    w += velocity;
                }
                JointKind::Prismatic => vd += acceleration + 2.0 * cross(&w, &velocity),
            }
            field = acceleration_tensor(&w, &wd);
            link.parent_from_link = pose;
            link.angular_velocity = w;
            link.angular_acceleration = wd;
            link.linear_acceleration = vd;
            link.field = field;
        }
    }

    /// Tip to base: the wrench each joint transmits, and its component along the axis.
    ///
    /// A point r of a link accelerates by v̇ + W r, W = [ω̇]× + [ω]×²: its inertial force is m v̇ + W ∫ r dm, its moment
    /// ∫ r × (v̇ + W r) dm, linear in the moments of its mass (Balafoutis and Patel 1991).
    fn propagate_wrenches(&self, workspace: &mut Workspace, qdd: &[f64], tau: &mut [f64]) {
        // The wrench of link i+1 in link i's axes, about link i's origin.
        let mut force = Vector3::zeros();
        let mut moment = Vector3::zeros();
        let joints = self.joints.iter().zip(&mut workspace.links);
        for (((joint, link), &qdd), tau) in joints.zip(qdd).zip(tau).rev() {
            let body = &joint.moments;
            let vd = &link.linear_acceleration;
            force += joint.inertia.mass * vd + mul(&link.field, &body.first);
            moment += cross(&body.first, vd) + field_moment(&link.field, &body.second);
            link.force = force;
            link.moment = moment;
            let along_axis = match joint.kind {
                JointKind::Revolute => joint.axis.dot(&moment),
                JointKind::Prismatic => joint.axis.dot(&force),
            };
            *tau = along_axis + joint.rotor_inertia * qdd;
            let pose = &link.parent_from_link;
            force = mul(&pose.rotation, &force);
            moment = mul(&pose.rotation, &moment) + cross(&pose.translation, &force);
        }
    }
}
