//! The motions and wrenches of inverse dynamics.

use crate::real::Real;
use crate::small::{Mat3, Vec3};

/// A link's motion and the wrench on it, in its own frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LinkMotion<T> {
    /// ω, ω̇ (rad/s, rad/s²).
    pub angular_velocity: Vec3<T>,
    pub angular_acceleration: Vec3<T>,
    /// \[ω̇\]× + \[ω\]×²: times the position r of a point, this is its acceleration relative to the origin (1/s²).
    pub field: Mat3<T>,
    /// v̇ of the frame's origin minus gravity (m/s²).
    pub linear_acceleration: Vec3<T>,
    /// f, τ that the parent exerts on the link, about the frame's origin (N, N m).
    pub force: Vec3<T>,
    pub moment: Vec3<T>,
}

impl<T: Real> LinkMotion<T> {
    /// At rest and without load.
    pub fn zeros(context: T::Context) -> Self {
        let zero = Vec3::zeros(context);
        Self {
            angular_velocity: zero,
            angular_acceleration: zero,
            field: Mat3::zeros(context),
            linear_acceleration: zero,
            force: zero,
            moment: zero,
        }
    }
}
