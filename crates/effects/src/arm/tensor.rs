//! Tensors of inertia as six numbers, and their second moments.

use ::arm::Matrix3;

/// The tensor that six numbers (Ixx Ixy Iyy Ixz Iyz Izz) define.
pub fn tensor([xx, xy, yy, xz, yz, zz]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// The six numbers of a tensor, in the order of [`tensor`].
pub fn entries(tensor: &Matrix3<f64>) -> [f64; 6] {
    [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)].map(|at| tensor[at])
}

/// The second moments of mass Σ = ½ tr(I) 1 − I of a tensor about the centre of mass; those of a body are not negative.
pub fn second_moments(tensor: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * (0.5 * tensor.trace()) - tensor
}
