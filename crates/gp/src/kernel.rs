//! The squared-exponential kernel over blocks of points, laid out so that the compiler vectorises it.

use crate::wide::{Wide, on_widest};

/// Points in one block; the innermost loops run over a block. Sixteen doubles fill four AVX2 registers.
pub(crate) const LANES: usize = 16;

/// Points divided by the length scales, in blocks of [`LANES`], inputs outermost within a block.
///
/// Coordinate `d` of point `i` is at index `((i / LANES) * dim + d) * LANES + i % LANES`. The last block is padded
/// with zeros.
#[derive(Clone, Debug)]
pub(crate) struct Points {
    dim: usize,
    len: usize,
    values: Vec<f64>,
}

impl Points {
    /// Lays out `len` points of `dim` coordinates; `coordinate(i, d)` is coordinate `d` of point `i`.
    pub(crate) fn new(len: usize, dim: usize, coordinate: impl Fn(usize, usize) -> f64) -> Self {
        let mut values = vec![0.0; len.div_ceil(LANES) * LANES * dim];
        for i in 0..len {
            for d in 0..dim {
                values[((i / LANES) * dim + d) * LANES + i % LANES] = coordinate(i, d);
            }
        }
        Self { dim, len, values }
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn dim(&self) -> usize {
        self.dim
    }

    /// Number of points including the padding.
    pub(crate) fn padded_len(&self) -> usize {
        self.len.div_ceil(LANES) * LANES
    }

    pub(crate) fn coordinate(&self, i: usize, d: usize) -> f64 {
        self.values[((i / LANES) * self.dim + d) * LANES + i % LANES]
    }

    /// The points with these indices.
    pub(crate) fn subset(&self, indices: &[usize]) -> Self {
        Self::new(indices.len(), self.dim, |t, d| self.coordinate(indices[t], d))
    }

    /// Copies point `i` into `point`.
    pub(crate) fn copy_point(&self, i: usize, point: &mut [f64]) {
        for (d, value) in point.iter_mut().enumerate() {
            *value = self.coordinate(i, d);
        }
    }
}

/// Kernel values, at unit amplitude, between the point `x` (unscaled) and all `points` (divided by `lengths`); `out` has `points.len()` values.
pub(crate) fn kernel_column(points: &Points, x: &[f64], lengths: &[f64], out: &mut [f64]) {
    debug_assert_eq!(out.len(), points.len());
    on_widest(Column { points, x, lengths, out });
}

/// Sum over all `points` of weight times kernel value at unit amplitude; `weights` has `points.padded_len()` values, zero in the padding.
pub(crate) fn kernel_sum(points: &Points, x: &[f64], lengths: &[f64], weights: &[f64]) -> f64 {
    on_widest(Sum { points, x, lengths, weights })
}

/// Adds to `out[d]`, for every input `d`, the sum over `points` of weight times squared scaled distance along `d` from the scaled point `x`.
pub(crate) fn weighted_squares(points: &Points, x: &[f64], weights: &[f64], out: &mut [f64]) {
    on_widest(Squares { points, x, weights, out });
}

struct Column<'a> {
    points: &'a Points,
    x: &'a [f64],
    lengths: &'a [f64],
    out: &'a mut [f64],
}

impl Wide for Column<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let mut scaled = Scaled::new(self.x, self.lengths);
        let blocks = self.points.values.chunks_exact(LANES * self.points.dim);
        for (block, out) in blocks.zip(self.out.chunks_mut(LANES)) {
            let values = kernel_block::<FUSED>(block, &mut scaled);
            out.copy_from_slice(&values[..out.len()]);
        }
    }
}

struct Sum<'a> {
    points: &'a Points,
    x: &'a [f64],
    lengths: &'a [f64],
    weights: &'a [f64],
}

impl Wide for Sum<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> f64 {
        let mut scaled = Scaled::new(self.x, self.lengths);
        let blocks = self.points.values.chunks_exact(LANES * self.points.dim);
        let mut sums = [0.0; LANES];
        for (block, weights) in blocks.zip(self.weights.chunks_exact(LANES)) {
            let values = kernel_block::<FUSED>(block, &mut scaled);
            for lane in 0..LANES {
                sums[lane] = multiply_add::<FUSED>(weights[lane], values[lane], sums[lane]);
            }
        }
        sums.iter().sum()
    }
}

struct Squares<'a> {
    points: &'a Points,
    x: &'a [f64],
    weights: &'a [f64],
    out: &'a mut [f64],
}

impl Wide for Squares<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let dim = self.points.dim;
        let blocks = self.points.values.chunks_exact(LANES * dim);
        let mut padded = [0.0; LANES];
        for (block, weights) in blocks.zip(self.weights.chunks(LANES)) {
            padded[..weights.len()].copy_from_slice(weights);
            padded[weights.len()..].fill(0.0);
            let rows = block.chunks_exact(LANES);
            for ((row, &x), out) in rows.zip(self.x).zip(self.out.iter_mut()) {
                let mut sums = [0.0; 4];
                for lane in 0..LANES {
                    let difference = row[lane] - x;
                    sums[lane % 4] = multiply_add::<FUSED>(padded[lane] * difference, difference, sums[lane % 4]);
                }
                *out += (sums[0] + sums[1]) + (sums[2] + sums[3]);
            }
        }
    }
}

/// The number of inputs that are divided together.
const CHUNK: usize = 32;

/// A point divided by the length scales, [`CHUNK`] inputs at a time, so that nothing is allocated. Up to that number
/// of inputs, they are divided only once.
struct Scaled<'a> {
    x: &'a [f64],
    lengths: &'a [f64],
    values: [f64; CHUNK],
}

impl<'a> Scaled<'a> {
    #[inline(always)]
    fn new(x: &'a [f64], lengths: &'a [f64]) -> Self {
        let mut this = Self { x, lengths, values: [0.0; CHUNK] };
        this.divide(0);
        this
    }

    /// Divides the inputs from `first` on in the same way as the points were divided: at the smallest noise, a
    /// difference in rounding changes the mean noticeably.
    #[inline(always)]
    fn divide(&mut self, first: usize) {
        let inputs = self.x[first..].iter().zip(&self.lengths[first..]);
        for (value, (x, length)) in self.values.iter_mut().zip(inputs) {
            *value = x / length;
        }
    }
}

/// exp(-½ Σ_d (x_d / l_d - z_d)²) for the points z of one block.
#[inline(always)]
fn kernel_block<const FUSED: bool>(block: &[f64], x: &mut Scaled<'_>) -> [f64; LANES] {
    let mut squares = [0.0; LANES];
    if x.x.len() <= CHUNK {
        add_squares::<FUSED>(block, &x.values, &mut squares);
    } else {
        for (chunk, rows) in block.chunks(LANES * CHUNK).enumerate() {
            x.divide(chunk * CHUNK);
            add_squares::<FUSED>(rows, &x.values, &mut squares);
        }
    }
    for square in &mut squares {
        *square *= -0.5;
    }
    exp_of_negative::<FUSED, LANES>(squares)
}

/// Adds the squared distances of the points in `rows`, along as many inputs, from `x`.
#[inline(always)]
fn add_squares<const FUSED: bool>(rows: &[f64], x: &[f64; CHUNK], squares: &mut [f64; LANES]) {
    for (row, &x) in rows.chunks_exact(LANES).zip(x) {
        for lane in 0..LANES {
            let difference = x - row[lane];
            squares[lane] = multiply_add::<FUSED>(difference, difference, squares[lane]);
        }
    }
}

/// `a * b + c`, with a single rounding where the processor has the instruction; `mul_add` would otherwise be a slow
/// library call.
#[inline(always)]
pub(crate) fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// exp(x) for x ≤ 0 to about one unit in the last place; exact at 0, at most 4e-308 below -708, NaN for NaN.
///
/// The standard library's `exp` is a call for each value, which no compiler vectorises; this one is arithmetic only.
/// Source: the usual reduction x = k ln 2 + r, |r| ≤ ½ ln 2 (ln 2 in two parts), and the Taylor polynomial of degree 13,
/// whose remainder there is 4e-18.
#[inline(always)]
fn exp_of_negative<const FUSED: bool, const N: usize>(mut x: [f64; N]) -> [f64; N] {
    /// 1.5 · 2^52: adding it rounds to an integer, which then stands in the low bits.
    const ROUNDER: f64 = 6_755_399_441_055_744.0;
    const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
    const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    const COEFFICIENTS: [f64; 13] = [
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ];
    let mut powers = [0.0; N];
    for (x, power) in x.iter_mut().zip(&mut powers) {
        // A comparison instead of `max`, which would replace NaN by a number.
        let bounded = if *x < -708.0 { -708.0 } else { *x };
        let shifted = multiply_add::<FUSED>(bounded, std::f64::consts::LOG2_E, ROUNDER);
        let k = shifted - ROUNDER;
        *x = multiply_add::<FUSED>(k, -LN_2_HIGH, bounded);
        *x = multiply_add::<FUSED>(k, -LN_2_LOW, *x);
        *power = f64::from_bits((shifted.to_bits().wrapping_add(1023)) << 52);
    }
    // One coefficient after the other for all numbers, so that none waits for its own product.
    let mut values = [1.0 / 6_227_020_800.0; N];
    for coefficient in COEFFICIENTS {
        for (value, r) in values.iter_mut().zip(&x) {
            *value = multiply_add::<FUSED>(*value, *r, coefficient);
        }
    }
    for (value, power) in values.iter_mut().zip(&powers) {
        *value *= power;
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_agrees_with_the_standard_library() {
        let mut worst = 0.0_f64;
        for i in 0..700_000 {
            let x = -f64::from(i) * 1e-3;
            for [value] in [exp_of_negative::<false, 1>([x]), exp_of_negative::<true, 1>([x])] {
                worst = worst.max((value / x.exp() - 1.0).abs());
            }
        }
        assert!(worst < 4.5e-16, "relative error {worst:e}");
        let [at_zero, far, farthest, of_nan] = exp_of_negative::<true, 4>([0.0, -1e9, f64::NEG_INFINITY, f64::NAN]);
        assert_eq!(at_zero, 1.0);
        assert!(far < 1e-300);
        assert!(farthest < 1e-300);
        assert!(of_nan.is_nan());
    }

    #[test]
    fn column_and_sum_agree_with_the_formula() {
        // Few inputs, a chunk of them, and chunks and a part of one.
        for dim in [3, CHUNK, 2 * CHUNK + 5] {
            compare_with_the_formula(dim);
        }
    }

    fn compare_with_the_formula(dim: usize) {
        let lengths: Vec<f64> = (0..dim).map(|d| [0.5, 2.0, 1.25][d % 3] * (1.0 + dim as f64 / 10.0)).collect();
        let coordinate = |i: usize, d: usize| ((i * 7 + d * 3) % 11) as f64 * 0.1;
        let points = Points::new(37, dim, |i, d| coordinate(i, d) / lengths[d]);
        let x: Vec<f64> = (0..dim).map(|d| [0.3, -0.2, 0.9][d % 3]).collect();
        let mut column = vec![0.0; 37];
        kernel_column(&points, &x, &lengths, &mut column);
        let mut weights = vec![0.0; points.padded_len()];
        let mut expected_sum = 0.0;
        for i in 0..37 {
            let square: f64 = (0..dim).map(|d| ((x[d] - coordinate(i, d)) / lengths[d]).powi(2)).sum();
            let expected = (-0.5 * square).exp();
            assert!((column[i] - expected).abs() < 1e-15);
            weights[i] = 1.0 - 0.1 * i as f64;
            expected_sum += weights[i] * expected;
        }
        assert!((kernel_sum(&points, &x, &lengths, &weights) - expected_sum).abs() < 1e-13);
    }
}
