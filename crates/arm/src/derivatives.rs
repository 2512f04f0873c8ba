//! The derivatives of inverse dynamics by the positions and the velocities.

use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::model::{Arm, JointKind};
use crate::pose::Pose;
use crate::small::{acceleration_tensor, cross, cross_columns, field_moment, mul, rotate_symmetric, tr_mul};
use crate::workspace::Workspace;

/// A twist, a spatial acceleration or a wrench along the base's axes about its origin: the angular part (or moment) first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spatial(pub Vector3<f64>, pub Vector3<f64>);

impl Spatial {
    pub fn zero() -> Self {
        Self(Vector3::zeros(), Vector3::zeros())
    }

    fn plus(&self, other: &Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }

    fn times(&self, factor: f64) -> Self {
        Self(self.0 * factor, self.1 * factor)
    }

    fn dot(&self, other: &Self) -> f64 {
        self.0.dot(&other.0) + self.1.dot(&other.1)
    }

    /// How a motion that a body with this twist carries changes.
    fn cross(&self, motion: &Self) -> Self {
        Self(
            cross(&self.0, &motion.0),
            cross(&self.0, &motion.1) + cross(&self.1, &motion.0),
        )
    }

    /// How a wrench that a body with this twist carries changes.
    fn cross_wrench(&self, wrench: &Self) -> Self {
        Self(
            cross(&self.0, &wrench.0) + cross(&self.1, &wrench.1),
            cross(&self.0, &wrench.1),
        )
    }
}

/// What one link, or all links from one on, contribute; along the base's axes about its origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body {
    mass: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
    /// ∫ v dm and ∫ v rᵀ dm, v the velocity of the point r.
    momentum: Vector3<f64>,
    flow: Matrix3<f64>,
    wrench: Spatial,
}

impl Body {
    pub fn none() -> Self {
        Self {
            mass: 0.0,
            first: Vector3::zeros(),
            second: Matrix3::zeros(),
            momentum: Vector3::zeros(),
            flow: Matrix3::zeros(),
            wrench: Spatial::zero(),
        }
    }

    fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.first += other.first;
        self.second += other.second;
        self.momentum += other.momentum;
        self.flow += other.flow;
        self.wrench = self.wrench.plus(&other.wrench);
    }

    /// I x.
    fn inertia_times(&self, x: &Spatial) -> Spatial {
        let turned = self.second.trace() * x.0 - mul(&self.second, &x.0);
        Spatial(
            turned + cross(&self.first, &x.1),
            self.mass * x.1 + cross(&x.0, &self.first),
        )
    }

    /// ∫ (r ×; 1) 2 x × v dm of a turn x: x ×* I v + v ×* I x − I (v × x) of any motion with that angular part.
    fn coriolis_times(&self, x: &Vector3<f64>) -> Spatial {
        Spatial(
            2.0 * (self.flow.trace() * x - mul(&self.flow, x)),
            2.0 * cross(x, &self.momentum),
        )
    }

    /// The e with e · x = s · [`Self::coriolis_times`] x.
    fn coriolis_along(&self, s: &Spatial) -> Vector3<f64> {
        2.0 * (self.flow.trace() * s.0 - tr_mul(&self.flow, &s.0) + cross(&self.momentum, &s.1))
    }
}

/// Scratch of one joint; along the base's axes about its origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tangent {
    /// The joint's unit motion s.
    unit: Spatial,
    /// How the motion of all that it carries changes by q, seen from there: velocity and acceleration.
    velocity: Spatial,
    acceleration: Spatial,
    /// How the acceleration changes by q̇, less a part that belongs to the Coriolis term.
    by_speed: Spatial,
    body: Body,
}

impl Tangent {
    pub fn zero() -> Self {
        let zero = Spatial::zero();
        Self {
            unit: zero,
            velocity: zero,
            acceleration: zero,
            by_speed: zero,
            body: Body::none(),
        }
    }
}

impl Arm {
    /// ∂τ/∂q and ∂τ/∂q̇ of [`Self::inverse_dynamics`], dof × dof each: row joint, column by. N m or N per rad or m, and
    /// per rad/s or m/s. (∂τ/∂q̈ is the mass matrix.)
    ///
    /// If joint j moves by dq, all that it carries moves rigidly. Seen from there, the velocity of the base side changes by
    /// v_{j−1} × s_j dq, its acceleration accordingly, and with them the wrenches beyond; towards the base the wrench turns
    /// along. In the base's axes all links change alike, and what they need adds up from the tip. Source: Carpentier and
    /// Mansard 2018; the Coriolis terms of the links as in Singh, Russo and Wensing 2022.
    ///
    /// # Panics
    /// If a slice, the workspace or a matrix is of another size than the arm.
    pub fn inverse_dynamics_derivatives(
        &self,
        workspace: &mut Workspace,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        by_position: &mut DMatrix<f64>,
        by_velocity: &mut DMatrix<f64>,
    ) {
        workspace.check(self, &[q, qd, qdd]);
        let n = self.dof();
        assert_eq!(by_position.shape(), (n, n), "the derivatives are dof × dof");
        assert_eq!(by_velocity.shape(), (n, n), "the derivatives are dof × dof");
        self.propagate_tangents(&mut workspace.tangents, q, qd, qdd);
        let tangents = &workspace.tangents;
        let mut body = Body::none();
        for (i, at) in tangents.iter().enumerate().rev() {
            body.add(&at.body);
            let s = &at.unit;
            // By the joints before this one, and by itself.
            let inertial = body.inertia_times(s);
            let coriolis = body.coriolis_along(s);
            for (j, by) in tangents[..=i].iter().enumerate() {
                by_position[(i, j)] = inertial.dot(&by.acceleration) + coriolis.dot(&by.velocity.0);
                by_velocity[(i, j)] = inertial.dot(&by.by_speed) + coriolis.dot(&by.unit.0);
            }
            // The joints before this one, by it.
            let moved = body
                .inertia_times(&at.acceleration)
                .plus(&body.coriolis_times(&at.velocity.0))
                .plus(&s.cross_wrench(&body.wrench));
            let faster = body.inertia_times(&at.by_speed).plus(&body.coriolis_times(&s.0));
            for (k, before) in tangents[..i].iter().enumerate() {
                by_position[(k, i)] = before.unit.dot(&moved);
                by_velocity[(k, i)] = before.unit.dot(&faster);
            }
        }
    }

    /// Base to tip: the motions of the joints and links, and the links' moments and wrenches, in the base's axes.
    fn propagate_tangents(&self, tangents: &mut [Tangent], q: &[f64], qd: &[f64], qdd: &[f64]) {
        let mut base_from_link = Pose::identity();
        let mut v = Spatial::zero();
        let mut a = Spatial(Vector3::zeros(), -self.gravity);
        for (i, (joint, tangent)) in self.joints.iter().zip(tangents).enumerate() {
            base_from_link = base_from_link.compose(&joint.parent_from_link(q[i]));
            let (r, o) = (&base_from_link.rotation, &base_from_link.translation);
            let axis = mul(r, &joint.axis);
            let s = match joint.kind {
                JointKind::Revolute => Spatial(axis, cross(o, &axis)),
                JointKind::Prismatic => Spatial(Vector3::zeros(), axis),
            };
            let velocity = v.cross(&s);
            tangent.unit = s;
            tangent.velocity = velocity;
            tangent.acceleration = a.cross(&s).plus(&v.cross(&velocity));
            // v_j × s_j = v_{j−1} × s_j: the own share drops out.
            tangent.by_speed = velocity.times(2.0);
            a = a.plus(&s.times(qdd[i])).plus(&velocity.times(qd[i]));
            v = v.plus(&s.times(qd[i]));

            let mass = joint.inertia.mass;
            let turned = mul(r, &joint.moments.first);
            let first = turned + mass * o;
            let second = rotate_symmetric(r, &joint.moments.second) + o * turned.transpose() + first * o.transpose();
            let field = acceleration_tensor(&v.0, &a.0);
            let at_origin = a.1 + cross(&v.0, &v.1);
            tangent.body = Body {
                mass,
                first,
                second,
                momentum: mass * v.1 + cross(&v.0, &first),
                flow: v.1 * first.transpose() + cross_columns(&v.0, &second),
                wrench: Spatial(
                    cross(&first, &at_origin) + field_moment(&field, &second),
                    mass * at_origin + mul(&field, &first),
                ),
            };
        }
    }
}
