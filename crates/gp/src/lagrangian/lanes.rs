//! Several numbers at a time: arithmetic on the samples of a block, written once and compiled for the widest vectors.

use std::ops::{Add, AddAssign, Mul, MulAssign, Sub, SubAssign};

/// Samples in a block.
pub(crate) const LANES: usize = 8;

/// One number for each sample of a block. No multiply-add is fused, so that all processors give the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes(pub(crate) [f64; LANES]);

impl Lanes {
    pub(crate) const ZERO: Self = Self([0.0; LANES]);
    pub(crate) const ONE: Self = Self([1.0; LANES]);

    /// `value` in every lane.
    #[inline(always)]
    pub(crate) fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    /// The first lanes from `values`, zero in the others.
    #[inline(always)]
    pub(crate) fn read(values: &[f64]) -> Self {
        let mut lanes = [0.0; LANES];
        let count = values.len().min(LANES);
        lanes[..count].copy_from_slice(&values[..count]);
        Self(lanes)
    }

    /// 1, −1 or 0 by the sign of each number.
    #[inline(always)]
    pub(crate) fn sign(self) -> Self {
        Self(self.0.map(sign))
    }

    /// The sum over the lanes, in their order.
    pub(crate) fn sum(self) -> f64 {
        self.0.iter().sum()
    }
}

/// 1, −1 or 0.
#[inline(always)]
pub(crate) fn sign(value: f64) -> f64 {
    f64::from(i8::from(value > 0.0) - i8::from(value < 0.0))
}

macro_rules! each_lane {
    ($operation:ident, $method:ident, $assignment:ident, $in_place:ident, $sign:tt) => {
        impl $operation for Lanes {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let mut lanes = self.0;
                for lane in 0..LANES {
                    lanes[lane] = self.0[lane] $sign other.0[lane];
                }
                Self(lanes)
            }
        }

        impl $assignment for Lanes {
            #[inline(always)]
            fn $in_place(&mut self, other: Self) {
                *self = *self $sign other;
            }
        }
    };
}

each_lane!(Add, add, AddAssign, add_assign, +);
each_lane!(Sub, sub, SubAssign, sub_assign, -);
each_lane!(Mul, mul, MulAssign, mul_assign, *);

impl Mul<f64> for Lanes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self::splat(factor)
    }
}
