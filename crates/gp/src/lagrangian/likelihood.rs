//! The log marginal likelihood of torques under the covariance of prior, with its exact gradient.

use faer::Mat;
use faer::linalg::matmul::triangular::BlockStructure;
use faer::{Accum, MatRef};

use super::contraction::Contraction;
use super::covariance::Covariance;
use super::lanes::LANES;
use super::prior::LagrangianPrior;
use super::samples::{Motions, TorqueSamples};
use crate::algebra::{
    cholesky, inverse_of_lower, log_determinant, solve_lower, solve_lower_transposed, sum_of_squares, triangular_matmul,
};
use crate::climb;
use crate::starts::Bounds;

/// Gains in the likelihood that are no gain, nats an observation.
const TOLERANCE: f64 = 1e-6;

/// C = K / t + diag(ρ), with K the covariance matrix of torques in `units`, t its mean diagonal entry and ρ one relative noise a
/// joint; factored and solved for the torques y.
pub(crate) struct Factored {
    /// G, lower triangular, with G Gᵀ = C.
    pub(crate) outer: Mat<f64>,
    /// C⁻¹ y.
    pub(crate) alpha: Vec<f64>,
    pub(crate) quadratic: f64,
    /// t.
    pub(crate) mean_variance: f64,
}

impl Factored {
    /// `None` if rounding makes C indefinite, or if y is not finite in it.
    pub(crate) fn new(
        prior: &LagrangianPrior,
        rho: &[f64],
        units: &[f64],
        motions: &Motions,
        y: &[f64],
    ) -> Option<Self> {
        let n = y.len();
        let mut outer = Mat::zeros(n, n);
        Covariance { prior, units, first: motions, second: motions, lower_only: true, to: outer.as_mut() }.write();
        let mean_variance = (0..n).map(|at| outer[(at, at)]).sum::<f64>() / n as f64;
        if !(mean_variance.is_normal() && mean_variance > 0.0) {
            return None;
        }
        let share = mean_variance.recip();
        for column in 0..n {
            for value in &mut outer.col_as_slice_mut(column)[column..] {
                *value *= share;
            }
            outer.col_as_slice_mut(column)[..column].fill(0.0);
        }
        for sample in 0..motions.len() {
            for (joint, rho) in rho.iter().enumerate() {
                let at = motions.entry(sample, joint);
                outer[(at, at)] += rho;
            }
        }
        if !cholesky(outer.as_mut()) {
            return None;
        }
        let mut alpha = y.to_vec();
        solve_lower(outer.as_ref(), &mut alpha);
        let quadratic = sum_of_squares(&alpha);
        solve_lower_transposed(outer.as_ref(), &mut alpha);
        Some(Self { outer, alpha, quadratic, mean_variance })
    }

    /// The log marginal likelihood at the amplitude that maximises it, nats.
    pub(crate) fn profiled(&self) -> f64 {
        let n = self.alpha.len() as f64;
        let constant = (self.quadratic / n).ln() + 1.0 + std::f64::consts::TAU.ln();
        -0.5 * (n * constant + log_determinant(self.outer.as_ref()))
    }

    /// The matrix ∂ likelihood / ∂C, of which the lower triangle and whole blocks on the diagonal are set.
    ///
    /// Source: Rasmussen and Williams 2006, eq. 5.9, at the amplitude that maximises the likelihood.
    fn by_matrix(&self, motions: &Motions) -> Mat<f64> {
        let n = self.alpha.len();
        let inverse = inverse_of_lower(self.outer.as_ref());
        let mut by_matrix = Mat::zeros(n, n);
        triangular_matmul(
            (by_matrix.as_mut(), BlockStructure::TriangularLower),
            Accum::Replace,
            (inverse.transpose(), BlockStructure::TriangularUpper),
            (inverse.as_ref(), BlockStructure::TriangularLower),
            -0.5,
        );
        let amplitude_squared = self.quadratic / n as f64;
        for column in 0..n {
            let scale = 0.5 * self.alpha[column] / amplitude_squared;
            let values = &mut by_matrix.col_as_slice_mut(column)[column..];
            for (value, alpha) in values.iter_mut().zip(&self.alpha[column..]) {
                *value += alpha * scale;
            }
        }
        let dof = motions.joints().len();
        for block in 0..motions.blocks() {
            let start = motions.entry(block * LANES, 0);
            let end = motions.entries(block, dof - 1).end;
            for column in start..end {
                for row in start..column {
                    by_matrix[(row, column)] = by_matrix[(column, row)];
                }
            }
        }
        by_matrix
    }
}

/// The likelihood of some samples as a function of [`LagrangianPrior::to_free`] and of the logarithms of ρ, within bounds.
pub(crate) struct Objective<'a> {
    units: &'a [f64],
    bounds: &'a Bounds,
    motions: Motions,
    targets: Vec<f64>,
}

impl<'a> Objective<'a> {
    pub(crate) fn new(samples: &TorqueSamples, scales: &[f64], units: &'a [f64], bounds: &'a Bounds) -> Self {
        let motions = samples.motions(scales);
        Self { units, bounds, targets: samples.targets(&motions, units), motions }
    }

    fn split(&self, free: &[f64]) -> (LagrangianPrior, Vec<f64>) {
        split(&self.bounds.log_from_free(free), self.units.len())
    }

    fn factored(&self, prior: &LagrangianPrior, rho: &[f64]) -> Option<Factored> {
        Factored::new(prior, rho, self.units, &self.motions, &self.targets)
    }

    /// The log marginal likelihood; minus infinity where it cannot be computed.
    pub(crate) fn value(&self, free: &[f64]) -> f64 {
        let (prior, rho) = self.split(free);
        let value = self.factored(&prior, &rho).map(|factored| factored.profiled());
        value.filter(|value| !value.is_nan()).unwrap_or(f64::NEG_INFINITY)
    }
}

/// The energies and the relative noises of the variables of the search.
pub(crate) fn split(values: &[f64], dof: usize) -> (LagrangianPrior, Vec<f64>) {
    let rho = values[LagrangianPrior::count(dof)..].iter().map(|log| log.exp());
    (LagrangianPrior::from_free(values, dof), rho.collect())
}

impl climb::Likelihood for Objective<'_> {
    fn value_and_gradient(&self, free: &[f64]) -> Option<(f64, Vec<f64>)> {
        let (prior, rho) = self.split(free);
        let factored = self.factored(&prior, &rho)?;
        let mut by_matrix = factored.by_matrix(&self.motions);
        let mut by_rho = vec![0.0; rho.len()];
        for sample in 0..self.motions.len() {
            for (joint, by_rho) in by_rho.iter_mut().enumerate() {
                let at = self.motions.entry(sample, joint);
                *by_rho += by_matrix[(at, at)] * rho[joint];
            }
        }
        // Σ ∂L/∂C ∘ C is zero at the best amplitude, so that Σ ∂L/∂C ∘ K / t, by which t changes the likelihood, is minus the noise's part.
        let n = self.targets.len();
        let shift = by_rho.iter().sum::<f64>() / n as f64;
        for at in 0..n {
            by_matrix[(at, at)] += shift;
        }
        let weights: MatRef<'_, f64> = by_matrix.as_ref();
        let mut gradient = Contraction { prior: &prior, units: self.units, motions: &self.motions, weights }.value();
        for by_energy in &mut gradient {
            *by_energy /= factored.mean_variance;
        }
        gradient.extend(by_rho);
        for (gradient, slope) in gradient.iter_mut().zip(self.bounds.slopes(free)) {
            *gradient *= slope;
        }
        let value = factored.profiled();
        let finite = value.is_finite() && gradient.iter().all(|by| by.is_finite());
        finite.then_some((value, gradient))
    }

    fn observations(&self) -> f64 {
        self.targets.len() as f64
    }

    fn negligible(&self, free: &[f64]) -> f64 {
        let n = self.observations();
        let (_, rho) = self.split(free);
        let least = rho.iter().copied().fold(f64::INFINITY, f64::min);
        TOLERANCE * n + 0.5 * f64::EPSILON * n / least
    }
}
