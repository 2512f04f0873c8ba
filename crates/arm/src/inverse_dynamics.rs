//! Recursive Newton-Euler inverse dynamics, and the features Independent Joint Learning takes from it.

use nalgebra::Vector3;

use crate::model::{Arm, JointKind};
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
        let mut w_parent = Vector3::zeros();
        let mut wd_parent = Vector3::zeros();
        let mut vd_parent = -self.gravity;
        for (i, joint) in self.joints.iter().enumerate() {
            let link = &mut workspace.links[i];
            link.parent_from_link = joint.parent_from_link(q[i]);
            let r = &link.parent_from_link.rotation;
            let p = &link.parent_from_link.translation;
            let vd_origin = vd_parent + wd_parent.cross(p) + w_parent.cross(&w_parent.cross(p));
            let mut w = r.tr_mul(&w_parent);
            let mut wd = r.tr_mul(&wd_parent);
            let mut vd = r.tr_mul(&vd_origin);
            let velocity = joint.axis * qd[i];
            let acceleration = joint.axis * qdd[i];
            match joint.kind {
                JointKind::Revolute => {
                    wd += acceleration + w.cross(&velocity);
                    w += velocity;
                }
                JointKind::Prismatic => vd += acceleration + 2.0 * w.cross(&velocity),
            }
            link.angular_velocity = w;
            link.angular_acceleration = wd;
            link.linear_acceleration = vd;
            (w_parent, wd_parent, vd_parent) = (w, wd, vd);
        }
    }

    /// Tip to base: the wrench each joint transmits, and its component along the axis.
    fn propagate_wrenches(&self, workspace: &mut Workspace, qdd: &[f64], tau: &mut [f64]) {
        // The wrench of link i+1 in link i's axes, about link i's origin.
        let mut distal_force = Vector3::zeros();
        let mut distal_moment = Vector3::zeros();
        for (i, joint) in self.joints.iter().enumerate().rev() {
            let link = &mut workspace.links[i];
            let (w, wd) = (&link.angular_velocity, &link.angular_acceleration);
            let body = &joint.inertia;
            let vd_com = link.linear_acceleration + wd.cross(&body.com) + w.cross(&w.cross(&body.com));
            let inertial_force = body.mass * vd_com;
            let inertial_moment = body.tensor * wd + w.cross(&(body.tensor * w));
            link.force = inertial_force + distal_force;
            link.moment = inertial_moment + body.com.cross(&inertial_force) + distal_moment;
            let along_axis = match joint.kind {
                JointKind::Revolute => joint.axis.dot(&link.moment),
                JointKind::Prismatic => joint.axis.dot(&link.force),
            };
            tau[i] = along_axis + joint.rotor_inertia * qdd[i];
            let r = &link.parent_from_link.rotation;
            distal_force = r * link.force;
            distal_moment = r * link.moment + link.parent_from_link.translation.cross(&distal_force);
        }
    }
}
