//! The numbers that the recursions compute with: one state, or several states side by side.
//!
//! Every operation is a single operation of IEEE 754, without fused multiply-add, and each recursion is written once.
//! Therefore a lane has the same bits as the same state computed alone, whatever the width of the processor's vectors.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};
use std::slice::from_mut;

use pulp::Simd;
use pulp::bytemuck::cast_slice_mut;

mod sine;

/// A number, or one of several states that are computed together.
pub(crate) trait Real:
    Copy
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A context for making constants, such as the processor's instruction set.
    type Context: Copy;

    /// A number that is the same in every state.
    fn constant(context: Self::Context, value: f64) -> Self;

    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
}

impl Real for f64 {
    type Context = ();

    #[inline(always)]
    fn constant((): (), value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        if self.abs() > sine::LARGEST {
            return f64::sin_cos(self);
        }
        sine::sin_cos((), self)
    }
}

/// The states in one vector of the processor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<S: Simd> {
    pub simd: S,
    pub values: S::f64s,
}

impl<S: Simd> Real for Lanes<S> {
    type Context = S;

    #[inline(always)]
    fn constant(simd: S, value: f64) -> Self {
        Self { simd, values: simd.splat_f64s(value) }
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let simd = self.simd;
        let is_large = simd.greater_than_f64s(simd.abs_f64s(self.values), simd.splat_f64s(sine::LARGEST));
        if simd.first_true_m64s(is_large) < S::F64_LANES {
            return self.sin_cos_one_by_one();
        }
        sine::sin_cos(simd, self)
    }
}

impl<S: Simd> Lanes<S> {
    /// Sine and cosine if an angle is too large for the polynomials.
    #[cold]
    fn sin_cos_one_by_one(self) -> (Self, Self) {
        let (mut sin, mut cos) = (self, self);
        for (sin, cos) in sin.each_mut().iter_mut().zip(cos.each_mut()) {
            (*sin, *cos) = Real::sin_cos(*sin);
        }
        (sin, cos)
    }

    #[inline(always)]
    fn each_mut(&mut self) -> &mut [f64] {
        cast_slice_mut(from_mut(&mut self.values))
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let values = self.simd.add_f64s(self.values, other.values);
        Self { values, ..self }
    }
}

impl<S: Simd> AddAssign for Lanes<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let values = self.simd.sub_f64s(self.values, other.values);
        Self { values, ..self }
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let values = self.simd.mul_f64s(self.values, other.values);
        Self { values, ..self }
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let values = self.simd.div_f64s(self.values, other.values);
        Self { values, ..self }
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let values = self.simd.neg_f64s(self.values);
        Self { values, ..self }
    }
}
