//! The range of a regression: its variance as a share of the prior variance, from a few points, fast enough for a
//! control step.

use crate::algebra::{inverse_of_lower, qr_factor};
use crate::kernel::{LANES, Points, kernel_column, multiply_add};
use crate::pivoted::{PivotedCholesky, Stopping};
use crate::posterior::Posterior;
use crate::wide::{Wide, on_widest};

/// The largest number of points of a [`Range`].
const MOST: usize = 64;

/// Points are added until the mean share of the prior variance at the training data is at most this.
const LARGEST_SHARE: f64 = 0.01;

/// The relative noise above which it is taken into account: below, it adds less to the share than [`LARGEST_SHARE`].
const NOISY: f64 = 1e-4;

/// An upper bound of the remaining share of the prior variance at a point: 0 at the data, 1 far from them.
///
/// The variance is that of the regression conditioned on a few of its points, those which the pivoted Cholesky
/// factorisation takes first. With fewer points the variance is larger, so that the share is never below the exact
/// one, except for noise, which the approximation by inducing points underestimates where the points leave a large
/// variance. Points are added until they leave 0.01 at the training data, up to 64 points: short length scales need
/// more, and [`Range::mean_variance_share`] is the remaining share. The cost is that number of kernel values and half its square of
/// multiplications; nothing is allocated.
#[derive(Clone, Debug)]
pub struct Range {
    points: Points,
    lengths: Vec<f64>,
    /// L⁻¹, with L Lᵀ the kernel matrix of the points.
    inner: Columns,
    /// √ρ G⁻¹ L⁻¹, with G Gᵀ = Fᵀ F + ρ I; `None` if the noise is negligible.
    outer: Option<Columns>,
    mean_variance_share: f64,
}

/// A lower triangular matrix by columns, each padded to whole blocks.
#[derive(Clone, Debug)]
pub(crate) struct Columns {
    values: Vec<f64>,
    padded: usize,
}

impl Columns {
    pub(crate) fn new(matrix: faer::MatRef<'_, f64>, scale: f64) -> Self {
        let n = matrix.nrows();
        let padded = n.div_ceil(LANES) * LANES;
        let mut values = vec![0.0; padded * n];
        for j in 0..n {
            for i in j..n {
                values[j * padded + i] = scale * matrix[(i, j)];
            }
        }
        Self { values, padded }
    }

    /// The squared norm of the product with `x`.
    pub(crate) fn square_of_product(&self, x: &[f64]) -> f64 {
        on_widest(Product { columns: self, x })
    }
}

struct Product<'a> {
    columns: &'a Columns,
    x: &'a [f64],
}

impl Wide for Product<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> f64 {
        let padded = self.columns.padded;
        let mut square = [0.0; LANES];
        for first in (0..padded).step_by(LANES) {
            // In these rows, the columns up to the diagonal.
            let columns = self.columns.values.chunks_exact(padded).zip(self.x);
            let mut sums = [0.0; LANES];
            for (column, &x) in columns.take(first + LANES) {
                let rows = &column[first..first + LANES];
                for lane in 0..LANES {
                    sums[lane] = multiply_add::<FUSED>(rows[lane], x, sums[lane]);
                }
            }
            for lane in 0..LANES {
                square[lane] = multiply_add::<FUSED>(sums[lane], sums[lane], square[lane]);
            }
        }
        square.iter().sum()
    }
}

impl Range {
    /// The range of the regression with this posterior, with the noise `rho` relative to the amplitude.
    pub(crate) fn of(posterior: &Posterior, rho: f64) -> Self {
        let stopping = Stopping {
            trace: 0.0,
            pivot: LARGEST_SHARE,
            max_rank: MOST.min(posterior.points.len()),
            truncates: true,
            keeps_kernel: false,
        };
        let pivoted = PivotedCholesky::new(&posterior.points, stopping).expect("a truncated factor is a factor");
        let inverse = inverse_of_lower(pivoted.triangle().as_ref());
        let outer = (rho > NOISY).then(|| {
            let outer = inverse_of_lower(qr_factor(pivoted.factor(), rho).as_ref());
            Columns::new((&outer * &inverse).as_ref(), rho.sqrt())
        });
        Self {
            points: posterior.points.subset(&pivoted.pivots),
            lengths: posterior.lengths.clone(),
            inner: Columns::new(inverse.as_ref(), 1.0),
            outer,
            mean_variance_share: pivoted.neglected / posterior.points.len().max(1) as f64,
        }
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// The mean remaining share at the training data (at those that carry the posterior).
    pub fn mean_variance_share(&self) -> f64 {
        self.mean_variance_share
    }

    /// The remaining share of the prior variance at `x`, from 0 to 1; NaN if an input is NaN, and 0 for a function
    /// that is known to be zero.
    ///
    /// # Panics
    /// If `x` does not have one value per input.
    pub fn variance_share(&self, x: &[f64]) -> f64 {
        assert_eq!(x.len(), self.lengths.len(), "inputs given and expected");
        if self.points.len() == 0 {
            return 0.0;
        }
        let mut kernel = [0.0; MOST];
        let kernel = &mut kernel[..self.points.len()];
        kernel_column(&self.points, x, &self.lengths, kernel);
        let mut share = 1.0 - self.inner.square_of_product(kernel);
        if let Some(outer) = &self.outer {
            share += outer.square_of_product(kernel);
        }
        share.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Gp, Hyperparameters, Lengths, TrainingSet, Workspace};

    /// Samples of a smooth path in three inputs, with a target.
    fn gp(length: f64, noise: f64) -> Gp {
        let inputs: Vec<f64> =
            (0..600).map(|at| (f64::from(at / 3) * 0.05 * (1.0 + 0.4 * f64::from(at % 3))).sin()).collect();
        let targets: Vec<f64> = inputs.chunks_exact(3).map(|x| x[0] * x[1] + x[2]).collect();
        let training = TrainingSet::new(3, &inputs, &targets).expect("valid");
        let hyperparameters = Hyperparameters { amplitude: 2.0, lengths: Lengths::Isotropic(length), noise };
        Gp::with_hyperparameters(&training, &hyperparameters).expect("valid")
    }

    /// The share is an upper bound, and close: at the data, near them and far away, with and without noise, for few
    /// points and for the largest number.
    #[test]
    fn the_share_bounds_the_variance() {
        for (length, noise) in [(2.0, 0.0), (2.0, 0.4), (0.6, 0.0), (0.1, 0.0), (0.1, 0.4)] {
            let gp = gp(length, noise);
            let range = gp.range();
            assert!(range.points() <= MOST);
            let mut workspace = Workspace::default();
            for step in 0..100 {
                let far = 0.1 * f64::from(step) * length;
                let x = [0.3 + far, 0.4 - 0.5 * far, 0.2 + far];
                let exact = gp.mean_and_variance(&x, &mut workspace).1 / 4.0;
                let share = range.variance_share(&x);
                let tolerance = if noise > 0.0 { 0.01 * exact } else { 1e-9 };
                assert!(share > exact - tolerance, "{length} {noise} {step}: {share} below {exact}");
                assert!((0.0..=1.0).contains(&share));
            }
            assert_eq!(range.variance_share(&[1e6; 3]), 1.0);
            assert!(range.variance_share(&[f64::NAN, 0.0, 0.0]).is_nan());
        }
        let range = gp(2.0, 0.0).range();
        assert!(range.points() < MOST && range.mean_variance_share() < LARGEST_SHARE, "{range:?}");
        // On the path itself, between samples.
        let at = |time: f64| [time.sin(), (1.4 * time).sin(), (1.8 * time).sin()];
        for step in 0..90 {
            let share = range.variance_share(&at(0.1 * f64::from(step)));
            assert!(share < 0.05, "{step}: {share}");
        }
        assert!(gp(0.03, 0.0).range().mean_variance_share() > LARGEST_SHARE, "too many points would be needed");
    }

    #[test]
    fn a_function_known_to_be_zero_has_no_variance() {
        let training = TrainingSet::new(2, &[0.0, 1.0, 2.0, 3.0], &[0.0, 0.0]).expect("valid");
        let gp = Gp::fit(&training, &crate::FitOptions::default()).expect("fits");
        assert_eq!(gp.range().variance_share(&[9.0, 9.0]), 0.0);
    }
}
