//! Products of 3-vectors and 3 × 3 matrices written out, for the loops over the joints.

use nalgebra::{Matrix3, Vector3};

/// M v.
#[inline(always)]
pub(crate) fn mul(m: &Matrix3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(
        m.m11 * v.x + m.m12 * v.y + m.m13 * v.z,
        m.m21 * v.x + m.m22 * v.y + m.m23 * v.z,
        m.m31 * v.x + m.m32 * v.y + m.m33 * v.z,
    )
}

/// Mᵀ v.
#[inline(always)]
pub(crate) fn tr_mul(m: &Matrix3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(
        m.m11 * v.x + m.m21 * v.y + m.m31 * v.z,
        m.m12 * v.x + m.m22 * v.y + m.m32 * v.z,
        m.m13 * v.x + m.m23 * v.y + m.m33 * v.z,
    )
}

/// a × b.
#[inline(always)]
pub(crate) fn cross(a: &Vector3<f64>, b: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// A B.
#[inline(always)]
pub(crate) fn product(a: &Matrix3<f64>, b: &Matrix3<f64>) -> Matrix3<f64> {
    let column = |x: f64, y: f64, z: f64| mul(a, &Vector3::new(x, y, z));
    Matrix3::from_columns(&[
        column(b.m11, b.m21, b.m31),
        column(b.m12, b.m22, b.m32),
        column(b.m13, b.m23, b.m33),
    ])
}

/// A Bᵀ.
#[inline(always)]
pub(crate) fn product_tr(a: &Matrix3<f64>, b: &Matrix3<f64>) -> Matrix3<f64> {
    let column = |x: f64, y: f64, z: f64| mul(a, &Vector3::new(x, y, z));
    Matrix3::from_columns(&[
        column(b.m11, b.m12, b.m13),
        column(b.m21, b.m22, b.m23),
        column(b.m31, b.m32, b.m33),
    ])
}

/// The symmetric matrix with these entries.
#[inline(always)]
pub(crate) fn symmetric(xx: f64, xy: f64, xz: f64, yy: f64, yz: f64, zz: f64) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// R S Rᵀ of a symmetric S.
#[inline(always)]
pub(crate) fn rotate_symmetric(r: &Matrix3<f64>, s: &Matrix3<f64>) -> Matrix3<f64> {
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
pub(crate) fn less_outer(s: &Matrix3<f64>, u: &Vector3<f64>, v: &Vector3<f64>) -> Matrix3<f64> {
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
pub(crate) fn cross_columns(v: &Vector3<f64>, m: &Matrix3<f64>) -> Matrix3<f64> {
    let column = |x: f64, y: f64, z: f64| cross(v, &Vector3::new(x, y, z));
    Matrix3::from_columns(&[
        column(m.m11, m.m21, m.m31),
        column(m.m12, m.m22, m.m32),
        column(m.m13, m.m23, m.m33),
    ])
}

/// [ω̇]× + [ω]× [ω]×: the acceleration of a point r of a body beyond that of its origin is this matrix times r.
#[inline(always)]
pub(crate) fn acceleration_tensor(w: &Vector3<f64>, wd: &Vector3<f64>) -> Matrix3<f64> {
    let (xx, yy, zz) = (w.x * w.x, w.y * w.y, w.z * w.z);
    let (xy, xz, yz) = (w.x * w.y, w.x * w.z, w.y * w.z);
    Matrix3::new(
        -(yy + zz),
        xy - wd.z,
        xz + wd.y,
        xy + wd.z,
        -(xx + zz),
        yz - wd.x,
        xz - wd.y,
        yz + wd.x,
        -(xx + yy),
    )
}

/// ∫ r × (W r) dm of a body with the second moments ∫ r rᵀ dm.
#[inline(always)]
pub(crate) fn field_moment(w: &Matrix3<f64>, second: &Matrix3<f64>) -> Vector3<f64> {
    let s = second;
    Vector3::new(
        (w.m31 * s.m12 + w.m32 * s.m22 + w.m33 * s.m23) - (w.m21 * s.m13 + w.m22 * s.m23 + w.m23 * s.m33),
        (w.m11 * s.m13 + w.m12 * s.m23 + w.m13 * s.m33) - (w.m31 * s.m11 + w.m32 * s.m12 + w.m33 * s.m13),
        (w.m21 * s.m11 + w.m22 * s.m12 + w.m23 * s.m13) - (w.m11 * s.m12 + w.m12 * s.m22 + w.m13 * s.m23),
    )
}
