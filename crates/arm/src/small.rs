//! 3-vectors and 3 × 3 matrices with their products written out, for the loops over the joints.

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

use nalgebra::{Matrix3, Vector3};

use crate::real::Real;

/// A 3-vector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vec3<T> {
    pub x: T,
    pub y: T,
    pub z: T,
}

/// A 3 × 3 matrix, column after column.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mat3<T> {
    pub m11: T,
    pub m21: T,
    pub m31: T,
    pub m12: T,
    pub m22: T,
    pub m32: T,
    pub m13: T,
    pub m23: T,
    pub m33: T,
}

impl<T: Real> Vec3<T> {
    #[inline(always)]
    pub fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }

    #[inline(always)]
    pub fn zeros(context: T::Context) -> Self {
        let zero = T::constant(context, 0.0);
        Self::new(zero, zero, zero)
    }

    /// A vector that is the same in every state.
    #[inline(always)]
    pub fn constant(context: T::Context, v: &Vector3<f64>) -> Self {
        let of = |value| T::constant(context, value);
        Self::new(of(v.x), of(v.y), of(v.z))
    }

    #[inline(always)]
    pub fn dot(&self, other: &Self) -> T {
        self.x * other.x + self.y * other.y + self.z * other.z
    }
}

impl<T: Real> Mat3<T> {
    /// From its rows.
    #[inline(always)]
    pub fn new(rows: [[T; 3]; 3]) -> Self {
        let [[m11, m12, m13], [m21, m22, m23], [m31, m32, m33]] = rows;
        Self { m11, m21, m31, m12, m22, m32, m13, m23, m33 }
    }

    #[inline(always)]
    fn from_columns(a: Vec3<T>, b: Vec3<T>, c: Vec3<T>) -> Self {
        Self::new([[a.x, b.x, c.x], [a.y, b.y, c.y], [a.z, b.z, c.z]])
    }

    #[inline(always)]
    pub fn zeros(context: T::Context) -> Self {
        Self::new([[T::constant(context, 0.0); 3]; 3])
    }

    /// A matrix that is the same in every state.
    #[inline(always)]
    pub fn constant(context: T::Context, m: &Matrix3<f64>) -> Self {
        let of = |value| T::constant(context, value);
        Self::new([
            [of(m.m11), of(m.m12), of(m.m13)],
            [of(m.m21), of(m.m22), of(m.m23)],
            [of(m.m31), of(m.m32), of(m.m33)],
        ])
    }

    #[inline(always)]
    pub fn transpose(&self) -> Self {
        Self::new([[self.m11, self.m21, self.m31], [self.m12, self.m22, self.m32], [self.m13, self.m23, self.m33]])
    }

    #[inline(always)]
    pub fn trace(&self) -> T {
        self.m11 + self.m22 + self.m33
    }
}

impl<T: Real> Add for Vec3<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<T: Real> AddAssign for Vec3<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real> Sub for Vec3<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<T: Real> Mul<T> for Vec3<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl<T: Real> Neg for Vec3<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<T: Real> Add for Mat3<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            m11: self.m11 + other.m11,
            m21: self.m21 + other.m21,
            m31: self.m31 + other.m31,
            m12: self.m12 + other.m12,
            m22: self.m22 + other.m22,
            m32: self.m32 + other.m32,
            m13: self.m13 + other.m13,
            m23: self.m23 + other.m23,
            m33: self.m33 + other.m33,
        }
    }
}

impl<T: Real> AddAssign for Mat3<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real> Mul<T> for Mat3<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self {
            m11: self.m11 * factor,
            m21: self.m21 * factor,
            m31: self.m31 * factor,
            m12: self.m12 * factor,
            m22: self.m22 * factor,
            m32: self.m32 * factor,
            m13: self.m13 * factor,
            m23: self.m23 * factor,
            m33: self.m33 * factor,
        }
    }
}

/// M v.
#[inline(always)]
pub(crate) fn mul<T: Real>(m: &Mat3<T>, v: &Vec3<T>) -> Vec3<T> {
    Vec3::new(
        m.m11 * v.x + m.m12 * v.y + m.m13 * v.z,
        m.m21 * v.x + m.m22 * v.y + m.m23 * v.z,
        m.m31 * v.x + m.m32 * v.y + m.m33 * v.z,
    )
}

/// Mᵀ v.
#[inline(always)]
pub(crate) fn tr_mul<T: Real>(m: &Mat3<T>, v: &Vec3<T>) -> Vec3<T> {
    Vec3::new(
        m.m11 * v.x + m.m21 * v.y + m.m31 * v.z,
        m.m12 * v.x + m.m22 * v.y + m.m32 * v.z,
        m.m13 * v.x + m.m23 * v.y + m.m33 * v.z,
    )
}

/// a × b.
#[inline(always)]
pub(crate) fn cross<T: Real>(a: &Vec3<T>, b: &Vec3<T>) -> Vec3<T> {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// The matrix of v × (·).
#[inline(always)]
pub(crate) fn cross_matrix<T: Real>(context: T::Context, v: &Vec3<T>) -> Mat3<T> {
    let zero = T::constant(context, 0.0);
    Mat3::new([[zero, -v.z, v.y], [v.z, zero, -v.x], [-v.y, v.x, zero]])
}

/// a bᵀ.
#[inline(always)]
pub(crate) fn outer<T: Real>(a: &Vec3<T>, b: &Vec3<T>) -> Mat3<T> {
    Mat3::from_columns(*a * b.x, *a * b.y, *a * b.z)
}

/// A B.
#[inline(always)]
pub(crate) fn product<T: Real>(a: &Mat3<T>, b: &Mat3<T>) -> Mat3<T> {
    let column = |x: T, y: T, z: T| mul(a, &Vec3::new(x, y, z));
    Mat3::from_columns(column(b.m11, b.m21, b.m31), column(b.m12, b.m22, b.m32), column(b.m13, b.m23, b.m33))
}

/// A Bᵀ.
#[inline(always)]
pub(crate) fn product_tr<T: Real>(a: &Mat3<T>, b: &Mat3<T>) -> Mat3<T> {
    let column = |x: T, y: T, z: T| mul(a, &Vec3::new(x, y, z));
    Mat3::from_columns(column(b.m11, b.m12, b.m13), column(b.m21, b.m22, b.m23), column(b.m31, b.m32, b.m33))
}

/// The symmetric matrix with these entries.
#[inline(always)]
pub(crate) fn symmetric<T: Real>(xx: T, xy: T, xz: T, yy: T, yz: T, zz: T) -> Mat3<T> {
    Mat3::new([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
}

/// R S Rᵀ of a symmetric S.
#[inline(always)]
pub(crate) fn rotate_symmetric<T: Real>(r: &Mat3<T>, s: &Mat3<T>) -> Mat3<T> {
    let t = product(r, s);
    symmetric(
        t.m11 * r.m11 + t.m12 * r.m12 + t.m13 * r.m13,
        t.m11 * r.m21 + t.m12 * r.m22 + t.m13 * r.m23,
        t.m11 * r.m31 + t.m12 * r.m32 + t.m13 * r.m33,
        t.m21 * r.m21 + t.m22 * r.m22 + t.m23 * r.m23,
        t.m21 * r.m31 + t.m22 * r.m32 + t.m23 * r.m33,
        t.m31 * r.m31 + t.m32 * r.m32 + t.m33 * r.m33,
    )
}

/// S − u uᵀ / d of a symmetric S, with u / d given as `v`.
#[inline(always)]
pub(crate) fn less_outer<T: Real>(s: &Mat3<T>, u: &Vec3<T>, v: &Vec3<T>) -> Mat3<T> {
    symmetric(
        s.m11 - u.x * v.x,
        s.m12 - u.x * v.y,
        s.m13 - u.x * v.z,
        s.m22 - u.y * v.y,
        s.m23 - u.y * v.z,
        s.m33 - u.z * v.z,
    )
}

/// v × (the columns of M).
#[inline(always)]
pub(crate) fn cross_columns<T: Real>(v: &Vec3<T>, m: &Mat3<T>) -> Mat3<T> {
    let column = |x: T, y: T, z: T| cross(v, &Vec3::new(x, y, z));
    Mat3::from_columns(column(m.m11, m.m21, m.m31), column(m.m12, m.m22, m.m32), column(m.m13, m.m23, m.m33))
}

/// \[ω̇\]× + \[ω\]× \[ω\]×: times r, this is the acceleration of point r of a body relative to that of its origin.
#[inline(always)]
pub(crate) fn acceleration_tensor<T: Real>(w: &Vec3<T>, wd: &Vec3<T>) -> Mat3<T> {
    let (xx, yy, zz) = (w.x * w.x, w.y * w.y, w.z * w.z);
    let (xy, xz, yz) = (w.x * w.y, w.x * w.z, w.y * w.z);
    Mat3::new([
        [-(yy + zz), xy - wd.z, xz + wd.y],
        [xy + wd.z, -(xx + zz), yz - wd.x],
        [xz - wd.y, yz + wd.x, -(xx + yy)],
    ])
}

/// ∫ r × (W r) dm of a body with the second moments `second` = ∫ r rᵀ dm.
#[inline(always)]
pub(crate) fn field_moment<T: Real>(w: &Mat3<T>, second: &Mat3<T>) -> Vec3<T> {
    let s = second;
    Vec3::new(
        (w.m31 * s.m12 + w.m32 * s.m22 + w.m33 * s.m23) - (w.m21 * s.m13 + w.m22 * s.m23 + w.m23 * s.m33),
        (w.m11 * s.m13 + w.m12 * s.m23 + w.m13 * s.m33) - (w.m31 * s.m11 + w.m32 * s.m12 + w.m33 * s.m13),
        (w.m21 * s.m11 + w.m22 * s.m12 + w.m23 * s.m13) - (w.m11 * s.m12 + w.m12 * s.m22 + w.m13 * s.m23),
    )
}
