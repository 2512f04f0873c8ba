//! The articulated bodies of forward dynamics.

use crate::real::Real;
use crate::small::{Mat3, Vec3};

/// The articulated-body inertia and bias of a link and all that it carries, in the link's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Articulated<T> {
    /// The articulated-body inertia in blocks, [n; f] = [I H; Hᵀ M] [ω̇; v̇].
    pub rotational: Mat3<T>,
    pub coupling: Mat3<T>,
    pub translational: Mat3<T>,
    /// The bias wrench p^A (N m, N).
    pub moment: Vec3<T>,
    pub force: Vec3<T>,
    /// U = I^A S, D = Sᵀ U, u = τ − Sᵀ p^A and the velocity product c, in Featherstone's notation.
    pub u_moment: Vec3<T>,
    pub u_force: Vec3<T>,
    pub d: T,
    pub u: T,
    pub c_angular: Vec3<T>,
    pub c_linear: Vec3<T>,
}

impl<T: Real> Articulated<T> {
    /// A body without mass at rest.
    pub fn zeros(context: T::Context) -> Self {
        let (vector, matrix) = (Vec3::zeros(context), Mat3::zeros(context));
        Self {
            rotational: matrix,
            coupling: matrix,
            translational: matrix,
            moment: vector,
            force: vector,
            u_moment: vector,
            u_force: vector,
            d: vector.x,
            u: vector.x,
            c_angular: vector,
            c_linear: vector,
        }
    }
}
