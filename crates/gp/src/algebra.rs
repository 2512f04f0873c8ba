//! The few dense-matrix operations needed, single-threaded throughout.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::BlockStructure;
use faer::linalg::qr::no_pivoting::factor::{qr_in_place, qr_in_place_scratch, recommended_block_size};
use faer::linalg::triangular_inverse::invert_lower_triangular;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, ColMut, Mat, MatMut, MatRef, Par};

use crate::wide::release_vectors;

/// Replaces the lower triangle of a symmetric matrix by its Cholesky factor; `false` if the matrix is not positive definite.
pub(crate) fn cholesky(matrix: MatMut<'_, f64>) -> bool {
    let request = cholesky_in_place_scratch::<f64>(matrix.nrows(), Par::Seq, Default::default());
    let mut buffer = MemBuffer::new(request);
    let factored = cholesky_in_place(
        matrix,
        LltRegularization::default(),
        Par::Seq,
        MemStack::new(&mut buffer),
        Default::default(),
    );
    release_vectors();
    factored.is_ok()
}

/// Writes or adds the product of two matrices times `scale` to `to`.
pub(crate) fn matmul(to: MatMut<'_, f64>, accum: Accum, a: MatRef<'_, f64>, b: MatRef<'_, f64>, scale: f64) {
    faer::linalg::matmul::matmul(to, accum, a, b, scale, Par::Seq);
    release_vectors();
}

/// Writes or adds the product of two matrices with structure (such as triangular ones) times `scale` to `to`.
pub(crate) fn triangular_matmul(
    (to, shape): (MatMut<'_, f64>, BlockStructure),
    accum: Accum,
    (a, a_shape): (MatRef<'_, f64>, BlockStructure),
    (b, b_shape): (MatRef<'_, f64>, BlockStructure),
    scale: f64,
) {
    faer::linalg::matmul::triangular::matmul(to, shape, accum, a, a_shape, b, b_shape, scale, Par::Seq);
    release_vectors();
}

/// B ← G⁻¹ B.
pub(crate) fn solve_lower_all(lower: MatRef<'_, f64>, b: MatMut<'_, f64>) {
    solve_lower_triangular_in_place(lower, b, Par::Seq);
    release_vectors();
}

/// The lower triangular factor G with G Gᵀ = Fᵀ F + ρ I, by Householder QR of F above √ρ I, whose error is that of
/// rounding F and not of rounding Fᵀ F.
pub(crate) fn qr_factor(factor: MatRef<'_, f64>, rho: f64) -> Mat<f64> {
    let (n, r) = (factor.nrows(), factor.ncols());
    let mut stacked = Mat::from_fn(n + r, r, |i, j| match i.checked_sub(n) {
        None => factor[(i, j)],
        Some(k) if k == j => rho.sqrt(),
        Some(_) => 0.0,
    });
    let block = recommended_block_size::<f64>(n + r, r);
    let mut coefficients = Mat::zeros(block, r);
    let request = qr_in_place_scratch::<f64>(n + r, r, block, Par::Seq, Default::default());
    let mut buffer = MemBuffer::new(request);
    qr_in_place(stacked.as_mut(), coefficients.as_mut(), Par::Seq, MemStack::new(&mut buffer), Default::default());
    release_vectors();
    // The R of Householder's method may have negative diagonal entries; the Cholesky factor has none.
    Mat::from_fn(r, r, |i, j| if i >= j { stacked[(j, i)] * stacked[(j, j)].signum() } else { 0.0 })
}

/// The inverse of a lower triangular matrix.
pub(crate) fn inverse_of_lower(lower: MatRef<'_, f64>) -> Mat<f64> {
    let mut inverse = Mat::zeros(lower.nrows(), lower.ncols());
    invert_lower_triangular(inverse.as_mut(), lower, Par::Seq);
    release_vectors();
    inverse
}

/// b ← G⁻¹ b.
pub(crate) fn solve_lower(lower: MatRef<'_, f64>, b: &mut [f64]) {
    let b = ColMut::from_slice_mut(b);
    solve_lower_all(lower, b.as_mat_mut());
}

/// b ← G⁻ᵀ b.
pub(crate) fn solve_lower_transposed(lower: MatRef<'_, f64>, b: &mut [f64]) {
    let b = ColMut::from_slice_mut(b);
    solve_upper_triangular_in_place(lower.transpose(), b.as_mat_mut(), Par::Seq);
    release_vectors();
}

/// Writes b + scale · A x to b.
pub(crate) fn add_product(b: &mut [f64], scale: f64, a: MatRef<'_, f64>, x: &[f64]) {
    let b = ColMut::from_slice_mut(b);
    let x = faer::ColRef::from_slice(x);
    faer::linalg::matmul::matmul(b, Accum::Add, a, x, scale, Par::Seq);
    release_vectors();
}

/// log det of G Gᵀ.
pub(crate) fn log_determinant(lower: MatRef<'_, f64>) -> f64 {
    let logs = (0..lower.nrows()).map(|i| lower[(i, i)].ln());
    2.0 * logs.sum::<f64>()
}

pub(crate) fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
