//! Derivatives of the covariances by the hyperparameters, contracted with a symmetric matrix: exact, in reverse mode.

use faer::MatRef;

use super::covariance::{Scratch, Speeds};
use super::factors::Factor;
use super::lanes::{LANES, Lanes};
use super::prior::LagrangianPrior;
use super::samples::{Motions, Spread};
use crate::wide::{Wide, on_widest};

/// Σ W ∘ ∂K/∂θ for every entry θ of [`LagrangianPrior::to_free`], with K the covariance matrix of torques divided by `units`, of
/// `motions` with themselves, and W given by its lower triangle and whole blocks on the diagonal.
pub(crate) struct Contraction<'a> {
    pub(crate) prior: &'a LagrangianPrior,
    pub(crate) units: &'a [f64],
    pub(crate) motions: &'a Motions,
    pub(crate) weights: MatRef<'a, f64>,
}

impl Contraction<'_> {
    pub(crate) fn value(self) -> Vec<f64> {
        on_widest(self)
    }
}

impl Wide for Contraction<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Vec<f64> {
        let Self { prior, units, motions, weights } = self;
        let dof = units.len();
        let mut reverse = Reverse::new(dof);
        let mut spread = Spread::new(dof);
        for sample in 0..motions.len() {
            motions.spread(sample, &mut spread);
            for block in sample / LANES..motions.blocks() {
                // Pairs of different blocks stand for those in the other order, too.
                let times = if block == sample / LANES { 1.0 } else { 2.0 };
                for l in 0..dof {
                    let column = weights.col(motions.entry(sample, l));
                    let column = column.try_as_col_major().expect("columns are contiguous").as_slice();
                    for j in 0..dof {
                        let scale = times / (units[j] * units[l]);
                        reverse.weights[j * dof + l] = Lanes::read(&column[motions.entries(block, j)]) * scale;
                    }
                }
                reverse.add(prior, motions, block, &spread);
            }
        }
        let mut gradient: Vec<f64> = reverse.gradient.iter().map(|lanes| lanes.sum()).collect();
        let variances = [&prior.kinetic, &prior.potential, &prior.viscous, &prior.coulomb];
        // By their logarithms; the shares, which follow, have theirs already.
        for (gradient, value) in gradient.iter_mut().zip(variances.into_iter().flatten()) {
            *gradient *= value;
        }
        gradient
    }
}

/// The derivatives for one pair of blocks after the other.
struct Reverse {
    forward: Scratch,
    /// W between the two blocks, entry (j, l) at j · dof + l.
    weights: Vec<Lanes>,
    /// By all variances, and by the logarithms of share / (1 − share).
    gradient: Vec<Lanes>,
    vectors: [Vec<Lanes>; 8],
    kinetic: Leave,
    potential: Leave,
}

/// Writes W x to `to`, for the first `n` joints.
#[inline(always)]
fn multiply(to: &mut [Lanes], w: &[Lanes], dof: usize, n: usize, x: impl Fn(usize) -> Lanes) {
    to[..n].fill(Lanes::ZERO);
    for l in 0..n {
        let x = x(l);
        for j in 0..n {
            to[j] += w[j * dof + l] * x;
        }
    }
}

/// Writes Wᵀ x to `to`, for the first `n` joints.
#[inline(always)]
fn multiply_transposed(to: &mut [Lanes], w: &[Lanes], dof: usize, n: usize, x: impl Fn(usize) -> Lanes) {
    to[..n].fill(Lanes::ZERO);
    for j in 0..n {
        let x = x(j);
        for l in 0..n {
            to[l] += w[j * dof + l] * x;
        }
    }
}

impl Reverse {
    fn new(dof: usize) -> Self {
        Self {
            forward: Scratch::new(dof),
            weights: vec![Lanes::ZERO; dof * dof],
            gradient: vec![Lanes::ZERO; LagrangianPrior::count(dof)],
            vectors: std::array::from_fn(|_| vec![Lanes::ZERO; dof]),
            kinetic: Leave::new(dof),
            potential: Leave::new(dof),
        }
    }

    #[inline(always)]
    fn add(&mut self, prior: &LagrangianPrior, first: &Motions, block: usize, second: &Spread) {
        let Self { forward, weights: w, gradient, vectors, kinetic, potential } = self;
        let dof = prior.potential.len();
        let pairs = dof * (dof + 1) / 2;
        forward.factors.compute(first, block, &second.position, &prior.kinetic_share, &prior.potential_share);
        kinetic.partial.fill(Factor::ZERO);
        potential.partial.fill(Factor::ZERO);
        for i in 0..dof {
            let n = i + 1;
            let sigma = prior.sigma(i);
            forward.kinetic.grow(i, &forward.factors.kinetic[i]);
            forward.potential.grow(i, &forward.factors.potential[i]);
            let [g_t, g_u, g_tu] = forward.along(i, first, block, second);
            let Speeds { s, t, u, tu } = Speeds::new(sigma, first, block, second);
            let (product, g_au, g_tb) = (&forward.kinetic, &forward.g_au, &forward.g_tb);
            let g = product.g;
            // x, y: accelerations of the second and the first motion, times σ; m, p: speeds of the second and the first one.
            let x = |c: usize| second.acceleration[c] * sigma[c];
            let m = |c: usize| second.velocity[c] * sigma[c];
            let y = |c: usize| first.acceleration(block, c) * sigma[c];
            let p = |c: usize| first.velocity(block, c) * sigma[c];
            let [w_y, w_p, w_gb, w_gtb, x_w, m_w, ga_w, gau_w] = vectors;
            multiply(w_y, w, dof, n, y);
            multiply(w_p, w, dof, n, p);
            multiply(w_gb, w, dof, n, |c| product.g_b[c]);
            multiply(w_gtb, w, dof, n, |c| g_tb[c]);
            multiply_transposed(x_w, w, dof, n, x);
            multiply_transposed(m_w, w, dof, n, m);
            multiply_transposed(ga_w, w, dof, n, |c| product.g_a[c]);
            multiply_transposed(gau_w, w, dof, n, |c| g_au[c]);
            let dot = |a: &dyn Fn(usize) -> Lanes, b: &[Lanes]| {
                let mut sum = Lanes::ZERO;
                for c in 0..n {
                    sum += a(c) * b[c];
                }
                sum
            };
            let (mut trace, mut w_gab, mut w_hab) = (Lanes::ZERO, Lanes::ZERO, Lanes::ZERO);
            for c in 0..n {
                trace += w[c * dof + c] * sigma[c];
                for d in 0..n {
                    w_gab += w[c * dof + d] * product.g_ab[c * dof + d];
                    w_hab += w[c * dof + d] * forward.potential.g_ab[c * dof + d];
                }
            }
            gradient[pairs + i] += w_hab;
            // By s and its derivatives.
            let straight = (tu * g + u * g_t + t * g_u + s * g_tu) * 2.0;
            let by_s = (trace * g_tu - dot(&m, w_gtb) - dot(&|c| g_au[c], w_p) + s * w_gab) * 2.0;
            let by_u = (trace * g_t - dot(&|c| product.g_a[c], w_p)) * 2.0;
            let by_t = (trace * g_u - dot(&m, w_gb)) * 2.0;
            let by_tu = trace * g * 2.0;
            for c in 0..n {
                let by_x = (g * w_y[c] + g_t * w_p[c]) * 2.0;
                let by_m = (g_u * w_y[c] + g_tu * w_p[c] - t * w_gb[c] - s * w_gtb[c]) * 2.0;
                let by_y = (g * x_w[c] + g_u * m_w[c]) * 2.0;
                let by_p = (g_t * x_w[c] + g_tu * m_w[c] - u * ga_w[c] - s * gau_w[c]) * 2.0;
                let (p, acc) = (first.velocity(block, c), first.acceleration(block, c));
                let (p2, acc2) = (second.velocity[c], second.acceleration[c]);
                gradient[i * (i + 1) / 2 + c] += w[c * dof + c] * straight
                    + (by_x + by_u * p + by_tu * acc) * acc2
                    + (by_m + by_s * p + by_t * acc) * p2
                    + by_y * acc
                    + by_p * p;
            }
            // The coefficients of g and its derivatives, for those by the factors of which g is the product.
            let xwy = dot(&x, w_y);
            let (xwp, mwy, mwp) = (dot(&x, w_p), dot(&m, w_y), dot(&m, w_p));
            kinetic.plain = (trace * tu + xwy) * 2.0;
            let (on_t, on_u) = ((trace * u + xwp) * 2.0, (trace * t + mwy) * 2.0);
            let on_tu = (trace * s + mwp) * 2.0;
            let (twice_s, square) = (s * 2.0, s * s);
            for c in 0..n {
                let p = first.velocity(block, c);
                kinetic.by_a[c] = on_t * p - u * w_p[c] * 2.0;
                kinetic.by_b[c] = on_u * second.velocity[c] - t * m_w[c] * 2.0;
                for d in 0..n {
                    let p2 = second.velocity[d];
                    kinetic.by_ab[c * dof + d] =
                        (on_tu * p - twice_s * w_p[c]) * p2 - twice_s * p * m_w[d] + square * w[c * dof + d];
                    potential.by_ab[c * dof + d] = w[c * dof + d] * prior.potential[i];
                }
            }
            kinetic.add_partials(n, &forward.factors.kinetic);
            potential.add_partials(n, &forward.factors.potential);
        }
        let (friction, shares) = gradient[pairs + dof..].split_at_mut(2 * dof);
        for c in 0..dof {
            let (p, p2, w) = (first.velocity(block, c), second.velocity[c], w[c * dof + c]);
            friction[c] += w * p * p2;
            friction[dof + c] += w * p.sign() * p2.sign();
            let (kinetic_share, potential_share) = (prior.kinetic_share[c], prior.potential_share[c]);
            let by_weights = forward.factors.by_weights(c, kinetic_share, potential_share);
            shares[c] += by_weights[0].dot(&kinetic.partial[c]);
            shares[dof + c] += by_weights[1].dot(&potential.partial[c]);
        }
    }
}

/// The derivatives of F = plain · g + Σ by_a · g_a + Σ by_b · g_b + Σ by_ab · g_ab by the factors of which g is the product.
///
/// F is built up factor by factor, with the state (F, Π value, its derivatives by q_c and by q'_c), and the derivatives are taken
/// back through the states: n² operations for n factors, without a division.
struct Leave {
    dof: usize,
    plain: Lanes,
    by_a: Vec<Lanes>,
    by_b: Vec<Lanes>,
    by_ab: Vec<Lanes>,
    /// The sums over the links, one for each joint.
    partial: Vec<Factor>,
    /// States before each factor: F and Π value, and by q_c and by q'_c at factor · dof + c.
    total: Vec<Lanes>,
    value: Vec<Lanes>,
    first: Vec<Lanes>,
    second: Vec<Lanes>,
    /// Derivatives of F by the state.
    back_first: Vec<Lanes>,
    back_second: Vec<Lanes>,
}

impl Leave {
    fn new(dof: usize) -> Self {
        let vector = || vec![Lanes::ZERO; dof];
        let square = || vec![Lanes::ZERO; dof * (dof + 1)];
        Self {
            dof,
            plain: Lanes::ZERO,
            by_a: vector(),
            by_b: vector(),
            by_ab: square(),
            partial: vec![Factor::ZERO; dof],
            total: vec![Lanes::ZERO; dof + 1],
            value: vec![Lanes::ZERO; dof + 1],
            first: square(),
            second: square(),
            back_first: vector(),
            back_second: vector(),
        }
    }

    #[inline(always)]
    fn add_partials(&mut self, n: usize, factors: &[Factor]) {
        let dof = self.dof;
        self.total[0] = self.plain;
        self.value[0] = Lanes::ONE;
        for (e, factor) in factors.iter().enumerate().take(n) {
            let value = self.value[e];
            let (mut by_first, mut by_second) = (self.by_a[e] * value, self.by_b[e] * value);
            for d in 0..e {
                by_first += self.by_ab[e * dof + d] * self.second[e * dof + d];
                by_second += self.by_ab[d * dof + e] * self.first[e * dof + d];
                self.first[(e + 1) * dof + d] = self.first[e * dof + d] * factor.value;
                self.second[(e + 1) * dof + d] = self.second[e * dof + d] * factor.value;
            }
            self.first[(e + 1) * dof + e] = value * factor.first;
            self.second[(e + 1) * dof + e] = value * factor.second;
            self.total[e + 1] = self.total[e] * factor.value
                + factor.first * by_first
                + factor.second * by_second
                + factor.both * self.by_ab[e * dof + e] * value;
            self.value[e + 1] = value * factor.value;
        }
        let (mut back_total, mut back_value) = (Lanes::ONE, Lanes::ZERO);
        self.back_first[..n].fill(Lanes::ZERO);
        self.back_second[..n].fill(Lanes::ZERO);
        for e in (0..n).rev() {
            let factor = &factors[e];
            let value = self.value[e];
            let own = self.by_ab[e * dof + e];
            let mut by_value = back_total * self.total[e] + back_value * value;
            let (mut by_first, mut by_second) = (self.by_a[e] * value, self.by_b[e] * value);
            for d in 0..e {
                let (first, second) = (self.first[e * dof + d], self.second[e * dof + d]);
                let (of_first, of_second) = (self.by_ab[d * dof + e], self.by_ab[e * dof + d]);
                by_value += self.back_first[d] * first + self.back_second[d] * second;
                by_first += of_second * second;
                by_second += of_first * first;
                self.back_first[d] = self.back_first[d] * factor.value + back_total * factor.second * of_first;
                self.back_second[d] = self.back_second[d] * factor.value + back_total * factor.first * of_second;
            }
            let partial = &mut self.partial[e];
            partial.value += by_value;
            partial.first += back_total * by_first + self.back_first[e] * value;
            partial.second += back_total * by_second + self.back_second[e] * value;
            partial.both += back_total * own * value;
            back_value = back_value * factor.value
                + self.back_first[e] * factor.first
                + self.back_second[e] * factor.second
                + back_total * (factor.first * self.by_a[e] + factor.second * self.by_b[e] + factor.both * own);
            back_total *= factor.value;
        }
    }
}
