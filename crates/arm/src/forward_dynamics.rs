//! Forward dynamics by the articulated-body algorithm.

use crate::joint::JointKind;
use crate::model::Arm;
use crate::real::Real;
use crate::scratch::{LinkPose, Scratch};
use crate::small::{
    Mat3, Vec3, cross, cross_columns, cross_matrix, less_outer, mul, product, product_tr, rotate_symmetric, symmetric,
    tr_mul,
};
use crate::workspace::Workspace;

impl Arm {
    /// The accelerations `qdd` (rad/s² or m/s²) under the torques `tau` at `q`, `qd`: q̈ = M⁻¹ (τ − C q̇ − g).
    ///
    /// The cost is linear in the number of joints. Source: Featherstone 2008, table 7.1, in link coordinates.
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn forward_dynamics(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], tau: &[f64], qdd: &mut [f64]) {
        workspace.check(self, &[q, qd, tau, qdd]);
        self.articulated_bodies((), &mut workspace.scratch, q, qd, tau, qdd);
    }

    /// The recursion of [`Self::forward_dynamics`] over `scratch`.
    #[inline(always)]
    pub(crate) fn articulated_bodies<T: Real>(
        &self,
        context: T::Context,
        scratch: &mut Scratch<T>,
        q: &[T],
        qd: &[T],
        tau: &[T],
        qdd: &mut [T],
    ) {
        self.propagate_velocities(context, scratch, q, qd);
        self.articulate(context, scratch, tau);
        self.accelerate(context, scratch, qdd);
    }

    /// The last joint, if any, that can move without moving a mass or a rotor. Forward dynamics is not defined for
    /// such an arm.
    pub fn massless_joint(&self) -> Option<usize> {
        let mut workspace = Workspace::new(self);
        let zeros = vec![0.0; self.dof()];
        let mut qdd = zeros.clone();
        // An arbitrary posture that is not singular.
        let q: Vec<f64> = (0..self.dof()).map(|i| 0.3 + 0.1 * i as f64).collect();
        self.forward_dynamics(&mut workspace, &q, &zeros, &zeros, &mut qdd);
        let links = &workspace.scratch.articulated;
        let inertias = links.iter().map(|link| link.d);
        let largest = inertias.clone().fold(0.0, f64::max);
        // The recursion goes from the tip to the base: beyond the last such joint, it has not yet divided by zero.
        (0..self.dof()).rev().find(|&i| links[i].d.is_nan() || links[i].d <= 1e-12 * largest)
    }

    /// Base to tip: velocities, velocity products c, bias wrenches p^A and the links' own inertias.
    #[inline(always)]
    fn propagate_velocities<T: Real>(&self, context: T::Context, scratch: &mut Scratch<T>, q: &[T], qd: &[T]) {
        self.place(context, scratch, q, 0);
        let Scratch { places, articulated, .. } = scratch;
        let mut w = Vec3::zeros(context);
        let mut v = Vec3::zeros(context);
        for (((joint, place), link), &qd) in self.joints.iter().zip(places).zip(articulated).zip(qd) {
            v = tr_mul(&place.rotation, &(v + cross(&w, &place.translation)));
            w = tr_mul(&place.rotation, &w);
            let velocity = Vec3::constant(context, &joint.axis) * qd;
            match joint.kind {
                JointKind::Revolute => {
                    // v × S q̇ for S = (a, 0) is (ω × a q̇, v × a q̇); the joint's own velocity contributes nothing.
                    link.c_angular = cross(&w, &velocity);
                    link.c_linear = cross(&v, &velocity);
                    w += velocity;
                }
                JointKind::Prismatic => {
                    link.c_angular = Vec3::zeros(context);
                    link.c_linear = cross(&w, &velocity);
                    v += velocity;
                }
            }

            let mass = T::constant(context, joint.inertia.mass);
            let first = Vec3::constant(context, &joint.moments.first);
            let (zero, tensor) = (T::constant(context, 0.0), Mat3::constant(context, &joint.moments.tensor));
            link.rotational = tensor;
            link.coupling = cross_matrix(context, &first);
            link.translational = symmetric(mass, zero, zero, mass, zero, mass);
            // p = v ×* (I v): (ω × n + v × f, ω × f) with the momentum (n, f).
            let n = mul(&tensor, &w) + cross(&first, &v);
            let f = v * mass + cross(&w, &first);
            link.moment = cross(&w, &n) + cross(&v, &f);
            link.force = cross(&w, &f);
        }
    }

    /// Tip to base: articulated inertias and bias wrenches.
    #[inline(always)]
    fn articulate<T: Real>(&self, context: T::Context, scratch: &mut Scratch<T>, tau: &[T]) {
        let Scratch { places, articulated, .. } = scratch;
        for (i, joint) in self.joints.iter().enumerate().rev() {
            let (proximal, distal) = articulated.split_at_mut(i);
            let link = &mut distal[0];
            let a = &Vec3::constant(context, &joint.axis);
            let rotor = T::constant(context, joint.rotor_inertia);
            match joint.kind {
                JointKind::Revolute => {
                    link.u_moment = mul(&link.rotational, a);
                    link.u_force = tr_mul(&link.coupling, a);
                    link.d = a.dot(&link.u_moment) + rotor;
                    link.u = tau[i] - a.dot(&link.moment);
                }
                JointKind::Prismatic => {
                    link.u_moment = mul(&link.coupling, a);
                    link.u_force = mul(&link.translational, a);
                    link.d = a.dot(&link.u_force) + rotor;
                    link.u = tau[i] - a.dot(&link.force);
                }
            }
            let Some(parent) = proximal.last_mut() else { continue };
            let (um, uf) = (&link.u_moment, &link.u_force);
            let inverse = T::constant(context, 1.0) / link.d;
            let (sm, sf) = (*um * inverse, *uf * inverse);
            let rotational = less_outer(&link.rotational, um, &sm);
            let c = &link.coupling;
            let coupling = Mat3::new([
                [c.m11 - um.x * sf.x, c.m12 - um.x * sf.y, c.m13 - um.x * sf.z],
                [c.m21 - um.y * sf.x, c.m22 - um.y * sf.y, c.m23 - um.y * sf.z],
                [c.m31 - um.z * sf.x, c.m32 - um.z * sf.y, c.m33 - um.z * sf.z],
            ]);
            let translational = less_outer(&link.translational, uf, &sf);
            let (cw, cv) = (&link.c_angular, &link.c_linear);
            let moment = link.moment + mul(&rotational, cw) + mul(&coupling, cv) + sm * link.u;
            let force = link.force + tr_mul(&coupling, cw) + mul(&translational, cv) + sf * link.u;

            // To the parent's frame: rotate the blocks, then shift the origin by p. With C' = C + [p]× M, the shifted
            // rotational block is I + [p]× C'ᵀ + ([p]× Cᵀ)ᵀ.
            let LinkPose { rotation: r, translation: p } = &places[i];
            let rotational = rotate_symmetric(r, &rotational);
            let coupling = product_tr(&product(r, &coupling), r);
            let translational = rotate_symmetric(r, &translational);
            let shifted = coupling + cross_columns(p, &translational);
            let near = cross_columns(p, &shifted.transpose());
            let far = cross_columns(p, &coupling.transpose());
            parent.rotational += symmetric(
                rotational.m11 + near.m11 + far.m11,
                rotational.m12 + near.m12 + far.m21,
                rotational.m13 + near.m13 + far.m31,
                rotational.m22 + near.m22 + far.m22,
                rotational.m23 + near.m23 + far.m32,
                rotational.m33 + near.m33 + far.m33,
            );
            parent.coupling += shifted;
            parent.translational += translational;
            let force = mul(r, &force);
            parent.moment += mul(r, &moment) + cross(p, &force);
            parent.force += force;
        }
    }

    /// Base to tip: the accelerations.
    #[inline(always)]
    fn accelerate<T: Real>(&self, context: T::Context, scratch: &Scratch<T>, qdd: &mut [T]) {
        let mut wd = Vec3::zeros(context);
        let mut vd = Vec3::constant(context, &-self.gravity);
        let links = scratch.places.iter().zip(&scratch.articulated);
        for ((joint, (place, link)), qdd) in self.joints.iter().zip(links).zip(qdd) {
            vd = tr_mul(&place.rotation, &(vd + cross(&wd, &place.translation))) + link.c_linear;
            wd = tr_mul(&place.rotation, &wd) + link.c_angular;
            *qdd = (link.u - link.u_moment.dot(&wd) - link.u_force.dot(&vd)) / link.d;
            let own = Vec3::constant(context, &joint.axis) * *qdd;
            match joint.kind {
                JointKind::Revolute => wd += own,
                JointKind::Prismatic => vd += own,
            }
        }
    }
}
