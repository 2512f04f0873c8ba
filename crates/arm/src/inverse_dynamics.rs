//! Recursive Newton-Euler inverse dynamics, and the Newton-Euler features of Independent Joint Learning.

use crate::joint::JointKind;
use crate::model::Arm;
use crate::real::Real;
use crate::scratch::{LinkMotion, Scratch};
use crate::small::{Mat3, Vec3, acceleration_tensor, cross, field_moment, mul, tr_mul};
use crate::workspace::Workspace;

/// The number of Newton-Euler features of a joint: the paper's twelve, and the joint's own torque.
pub const FEATURES: usize = 13;

/// The features of joint i in the order ω_i, ω̇_i (in link i's frame), τ_{i+1}, f_{i+1} (in link i+1's frame, about
/// joint i+1's origin; zero at the tip), τ_i: rad/s, rad/s², N m, N, N m (or N, if prismatic).
///
/// The first twelve are the inputs of equation 19 and Table I of the paper, all thirteen are the inputs of its
/// algorithms 1 to 3.
pub type NewtonEulerFeatures = [f64; FEATURES];

impl Arm {
    /// The joint torques (N m or N) that produce `qdd` at `q`, `qd`: τ = M(q) q̈ + C(q, q̇) q̇ + g(q).
    ///
    /// All slices have one entry per joint. Source: Luh, Walker and Paul 1980; Um, Park and Park,
    /// equations 10 to 16, gravity entering as an upward acceleration of the base.
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn inverse_dynamics(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        workspace.check(self, &[q, qd, qdd, tau]);
        self.newton_euler((), &mut workspace.scratch, q, qd, qdd, tau);
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
        for (i, feature) in features.iter_mut().enumerate() {
            *feature = workspace.scratch.features((), i, tau[i]);
        }
    }

    /// Turns τ_{i+1} and f_{i+1} of the `features` that [`Self::newton_euler_features`] computed last with `workspace` into link i's frame
    /// (ⁱR_{i+1} τ_{i+1} and ⁱR_{i+1} f_{i+1}, the terms of equation 15 of the paper). Their component along the axis of a revolute joint i
    /// is then a linear function of the features that does not depend on q_{i+1}.
    ///
    /// # Panics
    /// If `features` or the workspace is of another size than the arm.
    pub fn turn_loads_into_own_frames(&self, workspace: &Workspace, features: &mut [NewtonEulerFeatures]) {
        assert_eq!(features.len(), self.dof(), "one set of features a joint");
        for (feature, next) in features.iter_mut().zip(&workspace.scratch.places[1..]) {
            for from in [6, 9] {
                let load = Vec3::new(feature[from], feature[from + 1], feature[from + 2]);
                let Vec3 { x, y, z } = mul(&next.rotation, &load);
                feature[from..from + 3].copy_from_slice(&[x, y, z]);
            }
        }
    }

    /// The bias torque C(q, q̇) q̇ + g(q), which is the torque at zero acceleration (N m or N).
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn bias_torque(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], tau: &mut [f64]) {
        let zeros = std::mem::take(&mut workspace.zeros);
        self.inverse_dynamics(workspace, q, qd, &zeros, tau);
        workspace.zeros = zeros;
    }

    /// The gravity torque g(q), which holds the arm at rest (N m or N).
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn gravity_torque(&self, workspace: &mut Workspace, q: &[f64], tau: &mut [f64]) {
        let zeros = std::mem::take(&mut workspace.zeros);
        self.inverse_dynamics(workspace, q, &zeros, &zeros, tau);
        workspace.zeros = zeros;
    }

    /// The recursion of [`Self::inverse_dynamics`] over `scratch`.
    #[inline(always)]
    pub(crate) fn newton_euler<T: Real>(
        &self,
        context: T::Context,
        scratch: &mut Scratch<T>,
        q: &[T],
        qd: &[T],
        qdd: &[T],
        tau: &mut [T],
    ) {
        self.propagate_motion(context, scratch, q, qd, qdd);
        self.propagate_wrenches(context, scratch, qdd, tau);
    }

    /// Base to tip: for each link its pose in its parent, and ω, ω̇ and v̇ minus gravity in its own frame.
    #[inline(always)]
    pub(crate) fn propagate_motion<T: Real>(
        &self,
        context: T::Context,
        scratch: &mut Scratch<T>,
        q: &[T],
        qd: &[T],
        qdd: &[T],
    ) {
        self.place(context, scratch, q, 0);
        let Scratch { places, motions, .. } = scratch;
        let mut w = Vec3::zeros(context);
        let mut vd = Vec3::constant(context, &-self.gravity);
        let mut field = Mat3::zeros(context);
        let mut wd = Vec3::zeros(context);
        let joints = self.joints.iter().zip(places).zip(motions);
        for (((joint, place), link), (&qd, &qdd)) in joints.zip(qd.iter().zip(qdd)) {
            vd = tr_mul(&place.rotation, &(vd + mul(&field, &place.translation)));
            w = tr_mul(&place.rotation, &w);
            wd = tr_mul(&place.rotation, &wd);
            let axis = Vec3::constant(context, &joint.axis);
            let velocity = axis * qd;
            let acceleration = axis * qdd;
            match joint.kind {
                JointKind::Revolute => {
                    wd += acceleration + cross(&w, &velocity);
                    w += velocity;
                }
                JointKind::Prismatic => vd += acceleration + cross(&w, &velocity) * T::constant(context, 2.0),
            }
            field = acceleration_tensor(&w, &wd);
            link.angular_velocity = w;
            link.angular_acceleration = wd;
            link.linear_acceleration = vd;
            link.field = field;
        }
    }

    /// Tip to base: the wrench that each joint transmits, and its component along the joint's axis.
    ///
    /// A point r of a link accelerates by v̇ + W r, W = \[ω̇\]× + \[ω\]×²: its inertial force is m v̇ + W ∫ r dm, its moment
    /// ∫ r × (v̇ + W r) dm, linear in the moments of its mass (Balafoutis and Patel 1991).
    #[inline(always)]
    fn propagate_wrenches<T: Real>(&self, context: T::Context, scratch: &mut Scratch<T>, qdd: &[T], tau: &mut [T]) {
        // The wrench of link i+1 in link i's axes, about link i's origin.
        let mut force = Vec3::zeros(context);
        let mut moment = Vec3::zeros(context);
        let links = scratch.places.iter().zip(&mut scratch.motions);
        let joints = self.joints.iter().zip(links).zip(qdd.iter().zip(tau));
        for (i, ((joint, (place, link)), (&qdd, tau))) in joints.enumerate().rev() {
            let first = Vec3::constant(context, &joint.moments.first);
            let second = Mat3::constant(context, &joint.moments.second);
            let vd = &link.linear_acceleration;
            force += *vd * T::constant(context, joint.inertia.mass) + mul(&link.field, &first);
            moment += cross(&first, vd) + field_moment(&link.field, &second);
            link.force = force;
            link.moment = moment;
            let axis = Vec3::constant(context, &joint.axis);
            let along_axis = match joint.kind {
                JointKind::Revolute => axis.dot(&moment),
                JointKind::Prismatic => axis.dot(&force),
            };
            *tau = along_axis + T::constant(context, joint.rotor_inertia) * qdd;
            if i > 0 {
                force = mul(&place.rotation, &force);
                moment = mul(&place.rotation, &moment) + cross(&place.translation, &force);
            }
        }
    }
}

impl<T: Real> Scratch<T> {
    /// The features of joint `i` with the torque `tau`, after the recursion.
    #[inline(always)]
    pub(crate) fn features(&self, context: T::Context, i: usize, tau: T) -> [T; FEATURES] {
        let LinkMotion { angular_velocity: w, angular_acceleration: wd, .. } = self.motions[i];
        let zero = Vec3::zeros(context);
        let next = self.motions.get(i + 1).map(|next| (next.moment, next.force));
        let (n, f) = next.unwrap_or((zero, zero));
        [w.x, w.y, w.z, wd.x, wd.y, wd.z, n.x, n.y, n.z, f.x, f.y, f.z, tau]
    }
}
