//! Forward dynamics by the articulated-body algorithm.

use nalgebra::{Matrix3, Vector3};

use crate::model::{Arm, JointKind};
use crate::pose::cross_matrix;
use crate::small::{cross, cross_columns, less_outer, mul, product, product_tr, rotate_symmetric, symmetric, tr_mul};
use crate::workspace::Workspace;

impl Arm {
    /// The accelerations `qdd` (rad/s² or m/s²) under the torques `tau` at `q`, `qd`: q̈ = M⁻¹ (τ − C q̇ − g).
    ///
    /// Linear in the number of joints. Source: Featherstone 2008, table 7.1, in link coordinates.
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn forward_dynamics(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], tau: &[f64], qdd: &mut [f64]) {
        workspace.check(self, &[q, qd, tau, qdd]);
        self.propagate_velocities(workspace, q, qd);
        self.articulate(workspace, tau);
        self.accelerate(workspace, qdd);
    }

    /// The last joint, if any, that can move without moving mass or a rotor; forward dynamics is not defined then.
    pub fn massless_joint(&self) -> Option<usize> {
        let mut workspace = Workspace::new(self);
        let zeros = vec![0.0; self.dof()];
        let mut qdd = zeros.clone();
        // Any posture will do that is not a special one.
        let q: Vec<f64> = (0..self.dof()).map(|i| 0.3 + 0.1 * i as f64).collect();
        self.forward_dynamics(&mut workspace, &q, &zeros, &zeros, &mut qdd);
        let inertias = workspace.links.iter().map(|link| link.d);
        let largest = inertias.clone().fold(0.0, f64::max);
        // Beyond the first such joint from the tip, towards the base, the recursion has divided by nothing.
        (0..self.dof())
            .rev()
            .find(|&i| workspace.links[i].d.is_nan() || workspace.links[i].d <= 1e-12 * largest)
    }

    /// Base to tip: velocities, velocity products c, bias wrenches p^A and the links' own inertias.
    fn propagate_velocities(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64]) {
        let mut w = Vector3::zeros();
        let mut v = Vector3::zeros();
        for ((joint, link), (&q, &qd)) in self.joints.iter().zip(&mut workspace.links).zip(q.iter().zip(qd)) {
            let pose = joint.parent_from_link(q);
            v = tr_mul(&pose.rotation, &(v + cross(&w, &pose.translation)));
            w = tr_mul(&pose.rotation, &w);
            link.parent_from_link = pose;
            let velocity = joint.axis * qd;
            match joint.kind {
                JointKind::Revolute => {
                    // v × S q̇ for S = (a, 0): (ω × a q̇, v × a q̇); the own share drops out.
                    link.c_angular = cross(&w, &velocity);
                    link.c_linear = cross(&v, &velocity);
                    w += velocity;
                }
                JointKind::Prismatic => {
                    link.c_angular = Vector3::zeros();
                    link.c_linear = cross(&w, &velocity);
                    v += velocity;
                }
            }

            let (mass, first) = (joint.inertia.mass, &joint.moments.first);
            link.rotational = joint.moments.tensor;
            link.coupling = cross_matrix(first);
            link.translational = Matrix3::from_diagonal_element(mass);
            // p = v ×* (I v): (ω × n + v × f, ω × f) with the momentum (n, f).
            let n = mul(&joint.moments.tensor, &w) + cross(first, &v);
            let f = mass * v + cross(&w, first);
            link.moment = cross(&w, &n) + cross(&v, &f);
            link.force = cross(&w, &f);
        }
    }

    /// Tip to base: articulated inertias and bias wrenches.
    fn articulate(&self, workspace: &mut Workspace, tau: &[f64]) {
        for (i, joint) in self.joints.iter().enumerate().rev() {
            let (proximal, distal) = workspace.links.split_at_mut(i);
            let link = &mut distal[0];
            let a = &joint.axis;
            match joint.kind {
                JointKind::Revolute => {
                    link.u_moment = mul(&link.rotational, a);
                    link.u_force = tr_mul(&link.coupling, a);
                    link.d = a.dot(&link.u_moment) + joint.rotor_inertia;
                    link.u = tau[i] - a.dot(&link.moment);
                }
                JointKind::Prismatic => {
                    link.u_moment = mul(&link.coupling, a);
                    link.u_force = mul(&link.translational, a);
                    link.d = a.dot(&link.u_force) + joint.rotor_inertia;
                    link.u = tau[i] - a.dot(&link.force);
                }
            }
            let Some(parent) = proximal.last_mut() else { continue };
            let (um, uf) = (&link.u_moment, &link.u_force);
            let inverse = 1.0 / link.d;
            let (sm, sf) = (um * inverse, uf * inverse);
            let rotational = less_outer(&link.rotational, um, &sm);
            let c = &link.coupling;
            let coupling = Matrix3::new(
                c.m11 - um.x * sf.x,
                c.m12 - um.x * sf.y,
                c.m13 - um.x * sf.z,
                c.m21 - um.y * sf.x,
                c.m22 - um.y * sf.y,
                c.m23 - um.y * sf.z,
                c.m31 - um.z * sf.x,
                c.m32 - um.z * sf.y,
                c.m33 - um.z * sf.z,
            );
            let translational = less_outer(&link.translational, uf, &sf);
            let (cw, cv) = (&link.c_angular, &link.c_linear);
            let moment = link.moment + mul(&rotational, cw) + mul(&coupling, cv) + sm * link.u;
            let force = link.force + tr_mul(&coupling, cw) + mul(&translational, cv) + sf * link.u;

            // To the parent's frame: rotate the blocks, then shift the origin by p. With C' = C + [p]× M, the shifted
            // rotational block is I + [p]× C'ᵀ + ([p]× Cᵀ)ᵀ.
            let r = &link.parent_from_link.rotation;
            let p = &link.parent_from_link.translation;
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
    fn accelerate(&self, workspace: &mut Workspace, qdd: &mut [f64]) {
        let mut wd = Vector3::zeros();
        let mut vd = -self.gravity;
        for ((joint, link), qdd) in self.joints.iter().zip(&workspace.links).zip(qdd) {
            let pose = &link.parent_from_link;
            vd = tr_mul(&pose.rotation, &(vd + cross(&wd, &pose.translation))) + link.c_linear;
            wd = tr_mul(&pose.rotation, &wd) + link.c_angular;
            *qdd = (link.u - link.u_moment.dot(&wd) - link.u_force.dot(&vd)) / link.d;
            match joint.kind {
                JointKind::Revolute => wd += joint.axis * *qdd,
                JointKind::Prismatic => vd += joint.axis * *qdd,
            }
        }
    }
}
