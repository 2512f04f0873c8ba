//! The derivatives of inverse dynamics with respect to positions and velocities.

use crate::joint::JointKind;
use crate::model::Arm;
use crate::real::Real;
use crate::scratch::{Body, LinkPose, Scratch, Spatial};
use crate::small::{
    Mat3, Vec3, acceleration_tensor, cross, cross_columns, field_moment, mul, outer, product, rotate_symmetric,
};

impl Arm {
    /// The recursion of [`Self::inverse_dynamics_derivatives_batch`]; the matrices are stored column after column.
    ///
    /// If joint j moves by dq, everything that it carries moves rigidly. Relative to that, the velocity of the base
    /// side changes by v_{j−1} × s_j dq, its acceleration accordingly, and with them the wrenches beyond joint j;
    /// towards the base, the wrench turns with the carried links. In the base's axes these changes are the same for
    /// all links, so that sums from the tip suffice. Source: Carpentier and Mansard 2018; the Coriolis terms of the
    /// links as in Singh, Russo and Wensing 2022.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "three inputs and two outputs, as the public function")]
    pub(crate) fn tangents<T: Real>(
        &self,
        context: T::Context,
        scratch: &mut Scratch<T>,
        q: &[T],
        qd: &[T],
        qdd: &[T],
        by_position: &mut [T],
        by_velocity: &mut [T],
    ) {
        let n = self.dof();
        self.place(context, scratch, q, 0);
        self.propagate_tangents(context, scratch, qd, qdd);
        let tangents = &scratch.tangents;
        let mut body = Body::none(context);
        for (i, at) in tangents.iter().enumerate().rev() {
            body.add(&at.body);
            let s = &at.unit;
            // The derivatives of this joint's torque with respect to itself and the joints before it.
            let inertial = body.inertia_times(s);
            let coriolis = body.coriolis_along(context, s);
            for (j, by) in tangents[..=i].iter().enumerate() {
                by_position[j * n + i] = inertial.dot(&by.acceleration) + coriolis.dot(&by.velocity.0);
                by_velocity[j * n + i] = inertial.dot(&by.by_speed) + coriolis.dot(&by.unit.0);
            }
            // The derivatives of the earlier joints' torques with respect to this joint.
            let moved = body
                .inertia_times(&at.acceleration)
                .plus(&body.coriolis_times(context, &at.velocity.0))
                .plus(&s.cross_wrench(&body.wrench));
            let faster = body.inertia_times(&at.by_speed).plus(&body.coriolis_times(context, &s.0));
            for (k, before) in tangents[..i].iter().enumerate() {
                by_position[i * n + k] = before.unit.dot(&moved);
                by_velocity[i * n + k] = before.unit.dot(&faster);
            }
        }
    }

    /// Base to tip: the motions of joints and links, and the moments and wrenches of the links, in the base's axes.
    #[inline(always)]
    fn propagate_tangents<T: Real>(&self, context: T::Context, scratch: &mut Scratch<T>, qd: &[T], qdd: &[T]) {
        let zero = Vec3::zeros(context);
        let (mut v, mut a) = (Spatial::zeros(context), Spatial(zero, Vec3::constant(context, &-self.gravity)));
        let mut r = Mat3::constant(context, &nalgebra::Matrix3::identity());
        let mut o = zero;
        let Scratch { places, tangents, .. } = scratch;
        for (i, ((joint, place), tangent)) in self.joints.iter().zip(places.iter()).zip(tangents).enumerate() {
            let LinkPose { rotation, translation } = place;
            (r, o) = (product(&r, rotation), mul(&r, translation) + o);
            let axis = mul(&r, &Vec3::constant(context, &joint.axis));
            let s = match joint.kind {
                JointKind::Revolute => Spatial(axis, cross(&o, &axis)),
                JointKind::Prismatic => Spatial(zero, axis),
            };
            let velocity = v.cross(&s);
            tangent.unit = s;
            tangent.velocity = velocity;
            tangent.acceleration = a.cross(&s).plus(&v.cross(&velocity));
            // v_j × s_j = v_{j−1} × s_j, because s_j × s_j = 0.
            tangent.by_speed = velocity.times(T::constant(context, 2.0));
            a = a.plus(&s.times(qdd[i])).plus(&velocity.times(qd[i]));
            v = v.plus(&s.times(qd[i]));

            let mass = T::constant(context, joint.inertia.mass);
            let turned = mul(&r, &Vec3::constant(context, &joint.moments.first));
            let first = turned + o * mass;
            let second = rotate_symmetric(&r, &Mat3::constant(context, &joint.moments.second))
                + outer(&o, &turned)
                + outer(&first, &o);
            let field = acceleration_tensor(&v.0, &a.0);
            let at_origin = a.1 + cross(&v.0, &v.1);
            tangent.body = Body {
                mass,
                first,
                second,
                momentum: v.1 * mass + cross(&v.0, &first),
                flow: outer(&v.1, &first) + cross_columns(&v.0, &second),
                wrench: Spatial(
                    cross(&first, &at_origin) + field_moment(&field, &second),
                    at_origin * mass + mul(&field, &first),
                ),
            };
        }
    }
}
