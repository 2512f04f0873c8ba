//! The pose of each link in its parent, for the recursions.

use super::Scratch;
use crate::joint::{Joint, JointKind};
use crate::model::Arm;
use crate::real::Real;
use crate::small::{Mat3, Vec3};

/// A pose `parent_from_link`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LinkPose<T> {
    pub rotation: Mat3<T>,
    pub translation: Vec3<T>,
}

impl<T: Real> LinkPose<T> {
    /// The identity.
    pub fn zeros(context: T::Context) -> Self {
        Self { rotation: Mat3::zeros(context), translation: Vec3::zeros(context) }
    }

    /// [`Joint::parent_from_link`] at q.
    #[inline(always)]
    fn of(context: T::Context, joint: &Joint, q: T) -> Self {
        let at = Vec3::constant(context, &joint.parent_from_joint.translation);
        match joint.kind {
            JointKind::Revolute => {
                let (sin, cos) = q.sin_cos();
                let [r0, r1, r2] = &joint.rotation_terms;
                let (r0, r1) = (Mat3::constant(context, r0), Mat3::constant(context, r1));
                let r2 = Mat3::constant(context, r2);
                Self { rotation: r0 + r1 * sin + r2 * (T::constant(context, 1.0) - cos), translation: at }
            }
            JointKind::Prismatic => Self {
                rotation: Mat3::constant(context, &joint.rotation_terms[0]),
                translation: at + Vec3::constant(context, &joint.axis_in_parent) * q,
            },
        }
    }
}

impl Arm {
    /// Writes the pose in its parent of each link from `first` on into `scratch`.
    #[inline(always)]
    pub(crate) fn place<T: Real>(&self, context: T::Context, scratch: &mut Scratch<T>, q: &[T], first: usize) {
        for ((joint, place), &q) in self.joints.iter().zip(&mut scratch.places).zip(q).skip(first) {
            *place = LinkPose::of(context, joint, q);
        }
    }
}
