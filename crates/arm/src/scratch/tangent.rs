//! The changes of motion and wrench that are summed to the derivatives of inverse dynamics.

use crate::real::Real;
use crate::small::{Mat3, Vec3, cross, mul, tr_mul};

/// A twist, a spatial acceleration or a wrench in the base's axes about its origin: the angular part (or moment)
/// first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spatial<T>(pub Vec3<T>, pub Vec3<T>);

impl<T: Real> Spatial<T> {
    #[inline(always)]
    pub fn zeros(context: T::Context) -> Self {
        Self(Vec3::zeros(context), Vec3::zeros(context))
    }

    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }

    #[inline(always)]
    pub fn times(&self, factor: T) -> Self {
        Self(self.0 * factor, self.1 * factor)
    }

    #[inline(always)]
    pub fn dot(&self, other: &Self) -> T {
        self.0.dot(&other.0) + self.1.dot(&other.1)
    }

    /// Motion cross product v × m: the rate of change of the motion `m` that is fixed to a body with this twist.
    #[inline(always)]
    pub fn cross(&self, motion: &Self) -> Self {
        Self(cross(&self.0, &motion.0), cross(&self.0, &motion.1) + cross(&self.1, &motion.0))
    }

    /// Force cross product v ×* f: the rate of change of the wrench `f` that is fixed to a body with this twist.
    #[inline(always)]
    pub fn cross_wrench(&self, wrench: &Self) -> Self {
        Self(cross(&self.0, &wrench.0) + cross(&self.1, &wrench.1), cross(&self.0, &wrench.1))
    }
}

/// Inertia, momentum and wrench of one link, or of all links from one on, in the base's axes about its origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<T> {
    pub mass: T,
    pub first: Vec3<T>,
    pub second: Mat3<T>,
    /// ∫ v dm and ∫ v rᵀ dm, v the velocity of the point r.
    pub momentum: Vec3<T>,
    pub flow: Mat3<T>,
    pub wrench: Spatial<T>,
}

impl<T: Real> Body<T> {
    #[inline(always)]
    pub fn none(context: T::Context) -> Self {
        Self {
            mass: T::constant(context, 0.0),
            first: Vec3::zeros(context),
            second: Mat3::zeros(context),
            momentum: Vec3::zeros(context),
            flow: Mat3::zeros(context),
            wrench: Spatial::zeros(context),
        }
    }

    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.first += other.first;
        self.second += other.second;
        self.momentum += other.momentum;
        self.flow += other.flow;
        self.wrench = self.wrench.plus(&other.wrench);
    }

    /// I x.
    #[inline(always)]
    pub fn inertia_times(&self, x: &Spatial<T>) -> Spatial<T> {
        let turned = x.0 * self.second.trace() - mul(&self.second, &x.0);
        Spatial(turned + cross(&self.first, &x.1), x.1 * self.mass + cross(&x.0, &self.first))
    }

    /// ∫ (r ×; 1) 2 x × v dm of a turn x: x ×* I v + v ×* I x − I (v × x) of any motion with that angular part.
    #[inline(always)]
    pub fn coriolis_times(&self, context: T::Context, x: &Vec3<T>) -> Spatial<T> {
        let two = T::constant(context, 2.0);
        Spatial((*x * self.flow.trace() - mul(&self.flow, x)) * two, cross(x, &self.momentum) * two)
    }

    /// The e with e · x = s · [`Self::coriolis_times`] x.
    #[inline(always)]
    pub fn coriolis_along(&self, context: T::Context, s: &Spatial<T>) -> Vec3<T> {
        (s.0 * self.flow.trace() - tr_mul(&self.flow, &s.0) + cross(&self.momentum, &s.1)) * T::constant(context, 2.0)
    }
}

/// Scratch of one joint, in the base's axes about its origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tangent<T> {
    /// The joint's unit motion s.
    pub unit: Spatial<T>,
    /// The change of velocity and acceleration by q, as seen from what the joint carries.
    pub velocity: Spatial<T>,
    pub acceleration: Spatial<T>,
    /// The change of the acceleration by q̇, without a part that belongs to the Coriolis term.
    pub by_speed: Spatial<T>,
    pub body: Body<T>,
}

impl<T: Real> Tangent<T> {
    #[inline(always)]
    pub fn zeros(context: T::Context) -> Self {
        let zero = Spatial::zeros(context);
        Self { unit: zero, velocity: zero, acceleration: zero, by_speed: zero, body: Body::none(context) }
    }
}
