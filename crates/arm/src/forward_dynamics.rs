//! Forward dynamics by the articulated-body algorithm.

use nalgebra::{Matrix3, Vector3};

use crate::model::{Arm, JointKind};
use crate::pose::cross_matrix;
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
        let mut w_parent = Vector3::zeros();
        let mut v_parent = Vector3::zeros();
        for (i, joint) in self.joints.iter().enumerate() {
            let link = &mut workspace.links[i];
            link.parent_from_link = joint.parent_from_link(q[i]);
            let r = &link.parent_from_link.rotation;
            let p = &link.parent_from_link.translation;
            let mut w = r.tr_mul(&w_parent);
            let mut v = r.tr_mul(&(v_parent + w_parent.cross(p)));
            let velocity = joint.axis * qd[i];
            match joint.kind {
                JointKind::Revolute => {
                    // v × S q̇ for S = (a, 0): (ω × a q̇, v × a q̇); the own share drops out.
                    link.c_angular = w.cross(&velocity);
                    link.c_linear = v.cross(&velocity);
                    w += velocity;
                }
                JointKind::Prismatic => {
                    link.c_angular = Vector3::zeros();
                    link.c_linear = w.cross(&velocity);
                    v += velocity;
                }
            }
            link.angular_velocity = w;
            link.linear_velocity = v;

            let body = &joint.inertia;
            let first_moment = body.mass * body.com;
            link.rotational = body.tensor_about_origin();
            link.coupling = cross_matrix(&first_moment);
            link.translational = Matrix3::from_diagonal_element(body.mass);
            // p = v ×* (I v): (ω × n + v × f, ω × f) with the momentum (n, f).
            let n = link.rotational * w + first_moment.cross(&v);
            let f = body.mass * v + w.cross(&first_moment);
            link.moment = w.cross(&n) + v.cross(&f);
            link.force = w.cross(&f);
            (w_parent, v_parent) = (w, v);
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
                    link.u_moment = link.rotational * a;
                    link.u_force = link.coupling.tr_mul(a);
                    link.d = a.dot(&link.u_moment) + joint.rotor_inertia;
                    link.u = tau[i] - a.dot(&link.moment);
                }
                JointKind::Prismatic => {
                    link.u_moment = link.coupling * a;
                    link.u_force = link.translational * a;
                    link.d = a.dot(&link.u_force) + joint.rotor_inertia;
                    link.u = tau[i] - a.dot(&link.force);
                }
            }
            let Some(parent) = proximal.last_mut() else { continue };
            let (um, uf) = (link.u_moment, link.u_force);
            let rotational = link.rotational - um * (um / link.d).transpose();
            let coupling = link.coupling - um * (uf / link.d).transpose();
            let translational = link.translational - uf * (uf / link.d).transpose();
            let moment = link.moment + rotational * link.c_angular + coupling * link.c_linear + um * (link.u / link.d);
            let force =
                link.force + coupling.tr_mul(&link.c_angular) + translational * link.c_linear + uf * (link.u / link.d);

            // To the parent's frame: rotate the blocks, then shift the origin by p.
            let r = &link.parent_from_link.rotation;
            let rt = r.transpose();
            let p = cross_matrix(&link.parent_from_link.translation);
            let rotational = r * rotational * rt;
            let coupling = r * coupling * rt;
            let translational = r * translational * rt;
            let shifted = p * translational;
            let cross = p * coupling.transpose();
            parent.rotational += rotational + cross + cross.transpose() - shifted * p;
            parent.coupling += coupling + shifted;
            parent.translational += translational;
            let force = r * force;
            parent.moment += r * moment + link.parent_from_link.translation.cross(&force);
            parent.force += force;
        }
    }

    /// Base to tip: the accelerations.
    fn accelerate(&self, workspace: &mut Workspace, qdd: &mut [f64]) {
        let mut wd_parent = Vector3::zeros();
        let mut vd_parent = -self.gravity;
        for (i, joint) in self.joints.iter().enumerate() {
            let link = &workspace.links[i];
            let r = &link.parent_from_link.rotation;
            let p = &link.parent_from_link.translation;
            let mut wd = r.tr_mul(&wd_parent) + link.c_angular;
            let mut vd = r.tr_mul(&(vd_parent + wd_parent.cross(p))) + link.c_linear;
            qdd[i] = (link.u - link.u_moment.dot(&wd) - link.u_force.dot(&vd)) / link.d;
            match joint.kind {
                JointKind::Revolute => wd += joint.axis * qdd[i],
                JointKind::Prismatic => vd += joint.axis * qdd[i],
            }
            (wd_parent, vd_parent) = (wd, vd);
        }
    }
}
