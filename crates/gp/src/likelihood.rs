//! The log marginal likelihood, amplitude profiled out, as a function of length scales and relative noise.

use crate::dense::Dense;
use crate::evaluation::Evaluation;
use crate::kernel::Points;
use crate::low_rank::{LowRank, Method};
use crate::pivoted::{PivotedCholesky, Stopping};

/// The matrix C = K / amplitude² + ρ I, factored in the way that suits it.
pub(crate) enum Factored {
    LowRank(LowRank),
    Dense(Dense),
}

/// How precisely C is wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Precision {
    /// The trace neglected, in units of ρ.
    pub(crate) neglected: f64,
    pub(crate) method: Method,
    /// Whether the gradient is wanted, too.
    pub(crate) gradient: bool,
}

impl Precision {
    /// For the search: the likelihood to 1e-5 of its terms where rounding allows.
    pub(crate) const SEARCH: Self = Self { neglected: 1e-5, method: Method::Normal, gradient: true };
    /// For a search that needs no gradient.
    pub(crate) const VALUE: Self = Self { gradient: false, ..Self::SEARCH };
    /// For the posterior: as exact as rounding allows.
    pub(crate) const POSTERIOR: Self = Self { neglected: 1e-11, method: Method::Orthogonal, gradient: false };
}

/// Whether ρ is far enough above the rounding of the kernel matrix, n ε, that a solution of C α = y can be refined against the kernel itself.
pub(crate) fn well_conditioned(rho: f64, samples: usize) -> bool {
    rho >= 64.0 * f64::EPSILON * samples as f64
}

/// Residuals of the pivoted factorisation below this are taken for rounding of the kernel values, and columns made of them for noise.
///
/// Measured on the paper's data (joint 2, n = 800, ρ = 1e-13) against the likelihood in 80-bit arithmetic: with 16 ε it is 0.1 to 0.9 nats
/// low, with 4 ε 1.4 to 2 nats, with 1 ε 3 to 4 nats and its gradient useless; the dense factorisation is 0.7 to 1.8 nats high.
const PIVOT_FLOOR: f64 = 16.0 * f64::EPSILON;

impl Factored {
    /// Factors C for points scaled by the length scales and solves for the targets. If there are more samples than
    /// `inducing`, C is approximated by as many of them at most.
    pub(crate) fn new(
        points: &Points,
        targets: &[f64],
        rho: f64,
        precision: Precision,
        inducing: Option<usize>,
    ) -> Self {
        if let Some(inducing) = inducing
            && inducing < targets.len()
        {
            let stopping = Stopping {
                trace: precision.neglected * rho,
                pivot: PIVOT_FLOOR,
                max_rank: inducing,
                truncates: true,
                keeps_kernel: precision.gradient,
            };
            let pivoted = PivotedCholesky::new(points, stopping).expect("a truncated factor is a factor");
            return Self::LowRank(LowRank::new(pivoted, targets, rho, Method::Normal));
        }
        // Beyond about this rank the dense factorisation is the faster one (benches/fit.rs).
        Self::up_to_rank(targets.len() * 2 / 5, points, targets, rho, precision)
    }

    /// Factors C, densely if its rank is above `max_rank`.
    pub(crate) fn up_to_rank(
        max_rank: usize,
        points: &Points,
        targets: &[f64],
        rho: f64,
        precision: Precision,
    ) -> Self {
        let stopping = Stopping {
            trace: precision.neglected * rho,
            pivot: PIVOT_FLOOR,
            max_rank,
            truncates: false,
            keeps_kernel: precision.gradient,
        };
        if let Some(pivoted) = PivotedCholesky::new(points, stopping) {
            let mut low_rank = LowRank::new(pivoted, targets, rho, precision.method);
            if precision.method == Method::Orthogonal && well_conditioned(rho, targets.len()) {
                low_rank.refine(points, targets);
            }
            return Self::LowRank(low_rank);
        }
        if let Some(dense) = Dense::new(points, targets, rho) {
            return Self::Dense(dense);
        }
        // Rounding made C indefinite: ρ is near its floor and the rank high. Slower, but sure.
        let stopping = Stopping { max_rank: targets.len(), ..stopping };
        let pivoted = PivotedCholesky::new(points, stopping);
        let pivoted = pivoted.expect("a rank is at most the number of points");
        Self::LowRank(LowRank::new(pivoted, targets, rho, Method::Orthogonal))
    }

    pub(crate) fn evaluation(&self) -> Evaluation {
        match self {
            Self::LowRank(low_rank) => low_rank.evaluation(),
            Self::Dense(dense) => dense.evaluation(),
        }
    }

    /// The number of columns of the factor, and the trace of the part of K that it neglects.
    pub(crate) fn rank_and_neglected(&self) -> (usize, f64) {
        match self {
            Self::LowRank(low_rank) => (low_rank.pivoted().rank(), low_rank.pivoted().neglected),
            Self::Dense(dense) => (dense.alpha.len(), 0.0),
        }
    }

    /// How far below the exact log marginal likelihood the approximation's bound can be, at amplitude², nats; `None` if it
    /// is exact.
    pub(crate) fn gap(&self, targets: &[f64], amplitude_squared: f64) -> Option<f64> {
        match self {
            Self::LowRank(low_rank) => low_rank.gap(targets, amplitude_squared),
            Self::Dense(_) => None,
        }
    }

    /// Derivatives of the profiled log marginal likelihood by the logarithms of every length scale, then by log ρ.
    pub(crate) fn gradient(&self, points: &Points) -> Vec<f64> {
        match self {
            Self::LowRank(low_rank) => low_rank.gradient(points),
            Self::Dense(dense) => dense.gradient(points),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIM: usize = 3;

    /// A smooth path, whose kernel matrix has a low rank at these lengths, or the same with points thrown about.
    fn coordinate(i: usize, d: usize, scatter: f64) -> f64 {
        let time = 0.05 * i as f64;
        (time * (1.0 + 0.3 * d as f64)).sin() + scatter * ((i * 37 + d * 11) % 101) as f64 / 101.0
    }

    fn points(n: usize, scatter: f64, log_lengths: &[f64]) -> Points {
        Points::new(n, DIM, |i, d| coordinate(i, d, scatter) / log_lengths[d].exp())
    }

    fn targets(n: usize, noise: f64) -> Vec<f64> {
        (0..n).map(|i| (0.11 * i as f64).sin() + noise * ((i * 53 % 97) as f64 / 97.0 - 0.5)).collect()
    }

    #[test]
    fn gradient_agrees_with_finite_differences() {
        // Scatter, noise, ρ, trace neglected / ρ, whether low rank, tolerance relative to the largest component. The low-rank gradient sums
        // large terms of both signs, which are larger for smaller last pivots: the neglected part and rounding, ε n / pivot, balance.
        for (scatter, noise, rho, neglected, low_rank, tolerance) in [
            (0.0, 1e-1, 1e-2, 1e-7, true, 1e-6),
            (0.0, 1e-2, 1e-4, 1e-6, true, 1e-5),
            (0.0, 1e-2, 1e-4, Precision::SEARCH.neglected, true, 1e-4),
            (0.0, 0.0, 1e-8, Precision::SEARCH.neglected, true, 1e-3),
            (3.0, 1e-1, 1e-2, 0.0, false, 1e-7),
            (3.0, 1e-1, 1.0, 0.0, false, 1e-7),
        ] {
            let n = 200;
            let y = targets(n, noise);
            let at = [0.3, -0.2, 0.5, f64::ln(rho)];
            let factored = |at: &[f64], neglected: f64| {
                let points = points(n, scatter, &at[..DIM]);
                let precision = Precision { neglected, method: Method::Orthogonal, gradient: true };
                let factored = Factored::new(&points, &y, at[DIM].exp(), precision, None);
                (factored, points)
            };
            let (here, points) = factored(&at, neglected);
            assert_eq!(matches!(here, Factored::LowRank(_)), low_rank);
            let gradient = here.gradient(&points);
            let largest = gradient.iter().fold(0.0_f64, |a, g| a.max(g.abs()));
            for k in 0..=DIM {
                let step = 2e-3;
                let value = |steps: f64| {
                    let mut there = at;
                    there[k] += steps * step;
                    let exact = Precision::POSTERIOR.neglected;
                    factored(&there, exact).0.evaluation().profiled()
                };
                // Fourth order: (8 (f(h) - f(-h)) - (f(2h) - f(-2h))) / 12 h.
                let near = value(1.0) - value(-1.0);
                let far = value(2.0) - value(-2.0);
                let slope = (8.0 * near - far) / (12.0 * step);
                let error = (gradient[k] - slope).abs() / largest;
                println!("ρ {rho:e}, neglected {neglected:e}, component {k}: {slope}, off by {error:.1e}");
                assert!(error < tolerance, "component {k}: {} and {slope}", gradient[k]);
            }
        }
    }

    #[test]
    fn the_bounds_gradient_agrees_with_finite_differences() {
        let (n, inducing) = (200, 40);
        let y = targets(n, 0.3);
        let factored = |at: &[f64]| {
            let points = points(n, 3.0, &at[..DIM]);
            let factored = Factored::new(&points, &y, at[DIM].exp(), Precision::SEARCH, Some(inducing));
            (factored, points)
        };
        let at = [0.6, 0.4, 0.8, f64::ln(1e-1)];
        let (here, points) = factored(&at);
        let Factored::LowRank(low_rank) = &here else {
            panic!("an approximation has a low rank");
        };
        assert!(low_rank.pivoted().truncated);
        let pivots = low_rank.pivoted().pivots.clone();
        let gradient = here.gradient(&points);
        let largest = gradient.iter().fold(0.0_f64, |a, g| a.max(g.abs()));
        for k in 0..=DIM {
            let step = 1e-5;
            let value = |steps: f64| {
                let mut there = at;
                there[k] += steps * step;
                let (factored, _) = factored(&there);
                let Factored::LowRank(low_rank) = &factored else {
                    panic!("an approximation has a low rank");
                };
                assert_eq!(low_rank.pivoted().pivots, pivots, "the step is small enough");
                factored.evaluation().profiled()
            };
            let slope = (value(1.0) - value(-1.0)) / (2.0 * step);
            let error = (gradient[k] - slope).abs() / largest;
            assert!(error < 1e-6, "component {k}: {} and {slope}", gradient[k]);
        }
    }

    #[test]
    fn the_exact_likelihood_is_between_the_bounds() {
        let n = 200;
        let y = targets(n, 0.3);
        let points = points(n, 3.0, &[0.6, 0.4, 0.8]);
        let exact = Factored::new(&points, &y, 0.1, Precision::POSTERIOR, None).evaluation();
        let amplitude_squared = exact.best_amplitude_squared();
        let exact = exact.log_likelihood(amplitude_squared);
        let mut last = f64::NEG_INFINITY;
        for inducing in [20, 80, 160] {
            let bound = Factored::new(&points, &y, 0.1, Precision::POSTERIOR, Some(inducing));
            let below = bound.evaluation().log_likelihood(amplitude_squared);
            let gap = bound.gap(&y, amplitude_squared).expect("an approximation");
            assert!(below < exact && exact < below + gap, "{below} {exact} {gap}");
            assert!(below > last, "more inducing points, a closer bound: {below} after {last}");
            last = below;
        }
    }

    #[test]
    fn low_rank_and_dense_agree() {
        let n = 150;
        // ρ, and the tolerance: rounding of the kernel, n ε / ρ, is in both.
        for (scatter, rho, tolerance) in [(0.0, 1e-2, 1e-11), (0.0, 1e-6, 1e-9), (2.0, 1e-3, 1e-10)] {
            let y = targets(n, 0.1);
            let points = points(n, scatter, &[0.1, 0.2, 0.3]);
            let stopping =
                Stopping { trace: 1e-11 * rho, pivot: PIVOT_FLOOR, max_rank: n, truncates: false, keeps_kernel: false };
            let dense = Dense::new(&points, &y, rho).expect("definite");
            let expected = dense.evaluation().profiled();
            for method in [Method::Normal, Method::Orthogonal] {
                let pivoted = PivotedCholesky::new(&points, stopping).expect("within n");
                let low_rank = LowRank::new(pivoted, &y, rho, method);
                let value = low_rank.evaluation().profiled();
                let error = (value / expected - 1.0).abs();
                assert!(error < tolerance, "ρ {rho:e} {method:?}: {value} and {expected}");
            }
        }
    }

    #[test]
    fn pivoted_factor_reproduces_the_kernel_matrix() {
        let n = 120;
        let points = points(n, 0.5, &[0.0, 0.0, 0.0]);
        let stopping = Stopping { trace: 0.0, pivot: PIVOT_FLOOR, max_rank: n, truncates: false, keeps_kernel: false };
        let pivoted = PivotedCholesky::new(&points, stopping).expect("within n");
        let product = pivoted.factor() * pivoted.factor().transpose();
        for i in 0..n {
            for j in 0..n {
                let square: f64 = (0..DIM).map(|d| (points.coordinate(i, d) - points.coordinate(j, d)).powi(2)).sum();
                assert!((product[(i, j)] - (-0.5 * square).exp()).abs() < 1e-13);
            }
        }
        assert!(pivoted.neglected < 1e-12);
    }
}
