//! The covariance of the joints' torques: Lagrange's equations applied to both arguments of the prior' covariances.
//!
//! For the kinetic energy of a link, k = s² g with s = Σ_c σ_c q̇_c q̇'_c and g = Π_c g_c(q_c, q'_c), the covariance of the torques
//! of joint j at the first motion and of joint l at the second one is T_j T'_l k with T_j = d/dt ∂/∂q̇_j − ∂/∂q_j. Names of variables:
//! t is the time of the first motion, u that of the second; `g_a`, `g_b` and `g_ab` are derivatives of g by q, by q' and by both.

use faer::MatMut;

use super::factors::Factors;
use super::lanes::{LANES, Lanes};
use super::prior::LagrangianPrior;
use super::samples::{Motions, Spread};
use crate::wide::{Wide, on_widest};

/// A product over joints 1 to i of factors, with its derivatives; grows link by link.
#[derive(Clone, Debug)]
pub(crate) struct Product {
    dof: usize,
    /// Π value.
    pub(crate) g: Lanes,
    /// By q_c.
    pub(crate) g_a: Vec<Lanes>,
    /// By q'_c.
    pub(crate) g_b: Vec<Lanes>,
    /// By q_c and q'_d, at c · dof + d.
    pub(crate) g_ab: Vec<Lanes>,
}

impl Product {
    pub(crate) fn new(dof: usize) -> Self {
        Self {
            dof,
            g: Lanes::ONE,
            g_a: vec![Lanes::ZERO; dof],
            g_b: vec![Lanes::ZERO; dof],
            g_ab: vec![Lanes::ZERO; dof * dof],
        }
    }

    /// Takes joint `i`'s factor into the product of those before it.
    #[inline(always)]
    pub(crate) fn grow(&mut self, i: usize, factor: &super::factors::Factor) {
        if i == 0 {
            self.g = Lanes::ONE;
        }
        let dof = self.dof;
        for c in 0..i {
            for d in 0..i {
                self.g_ab[c * dof + d] *= factor.value;
            }
            self.g_ab[c * dof + i] = self.g_a[c] * factor.second;
            self.g_ab[i * dof + c] = self.g_b[c] * factor.first;
        }
        self.g_ab[i * dof + i] = self.g * factor.both;
        for c in 0..i {
            self.g_a[c] *= factor.value;
            self.g_b[c] *= factor.value;
        }
        self.g_a[i] = self.g * factor.first;
        self.g_b[i] = self.g * factor.second;
        self.g *= factor.value;
    }
}

/// s of one link with its derivatives by the time of the first motion (t), of the second (u), and of both.
#[derive(Clone, Copy)]
pub(crate) struct Speeds {
    pub(crate) s: Lanes,
    pub(crate) t: Lanes,
    pub(crate) u: Lanes,
    pub(crate) tu: Lanes,
}

impl Speeds {
    #[inline(always)]
    pub(crate) fn new(sigma: &[f64], first: &Motions, block: usize, second: &Spread) -> Self {
        let mut speeds = Self { s: Lanes::ZERO, t: Lanes::ZERO, u: Lanes::ZERO, tu: Lanes::ZERO };
        for (c, &sigma) in sigma.iter().enumerate() {
            let (p, acc) = (first.velocity(block, c) * sigma, first.acceleration(block, c) * sigma);
            speeds.s += p * second.velocity[c];
            speeds.t += acc * second.velocity[c];
            speeds.u += p * second.acceleration[c];
            speeds.tu += acc * second.acceleration[c];
        }
        speeds
    }
}

/// Scratch of [`Covariance`].
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    pub(crate) factors: Factors,
    pub(crate) kinetic: Product,
    pub(crate) potential: Product,
    /// Σ_d q̇'_d g_ab of each joint, and Σ_c q̇_c g_ab.
    pub(crate) g_au: Vec<Lanes>,
    pub(crate) g_tb: Vec<Lanes>,
    /// The result: entry (j, l) at j · dof + l.
    pub(crate) block: Vec<Lanes>,
}

impl Scratch {
    pub(crate) fn new(dof: usize) -> Self {
        Self {
            factors: Factors::new(dof),
            kinetic: Product::new(dof),
            potential: Product::new(dof),
            g_au: vec![Lanes::ZERO; dof],
            g_tb: vec![Lanes::ZERO; dof],
            block: vec![Lanes::ZERO; dof * dof],
        }
    }

    /// Makes `g_au` and `g_tb` those of the links' product up to joint `i`; returns (g_t, g_u, g_tu).
    #[inline(always)]
    pub(crate) fn along(&mut self, i: usize, first: &Motions, block: usize, second: &Spread) -> [Lanes; 3] {
        let dof = self.g_au.len();
        let (mut g_t, mut g_u, mut g_tu) = (Lanes::ZERO, Lanes::ZERO, Lanes::ZERO);
        self.g_tb[..=i].fill(Lanes::ZERO);
        for c in 0..=i {
            let p = first.velocity(block, c);
            let mut sum = Lanes::ZERO;
            for d in 0..=i {
                let g_ab = self.kinetic.g_ab[c * dof + d];
                sum += g_ab * second.velocity[d];
                self.g_tb[d] += p * g_ab;
            }
            self.g_au[c] = sum;
            g_tu += p * sum;
            g_t += p * self.kinetic.g_a[c];
            g_u += second.velocity[c] * self.kinetic.g_b[c];
        }
        [g_t, g_u, g_tu]
    }

    /// Computes the covariance of all joints' torques between `block` of `first` and `second`.
    #[inline(always)]
    pub(crate) fn covariance(&mut self, prior: &LagrangianPrior, first: &Motions, block: usize, second: &Spread) {
        let dof = self.g_au.len();
        self.factors.compute(first, block, &second.position, &prior.kinetic_share, &prior.potential_share);
        self.block.fill(Lanes::ZERO);
        for i in 0..dof {
            let sigma = prior.sigma(i);
            let v = prior.potential[i];
            self.kinetic.grow(i, &self.factors.kinetic[i]);
            self.potential.grow(i, &self.factors.potential[i]);
            let Speeds { s, t, u, tu } = Speeds::new(sigma, first, block, second);
            let [g_t, g_u, g_tu] = self.along(i, first, block, second);
            let g = self.kinetic.g;
            let straight = (tu * g + u * g_t + t * g_u + s * g_tu) * 2.0;
            let square = s * s;
            for j in 0..=i {
                // ∂s/∂q̇_j and its derivative by u.
                let (s_j, s_ju) = (second.velocity[j] * sigma[j], second.acceleration[j] * sigma[j]);
                let from_acc = (s_ju * g + s_j * g_u) * 2.0;
                let from_speed = (s_ju * g_t + s_j * g_tu - u * self.kinetic.g_a[j] - s * self.g_au[j]) * 2.0;
                let twice_s_j = s_j * 2.0;
                for l in 0..=i {
                    let (s_l, s_lt) = (first.velocity(block, l) * sigma[l], first.acceleration(block, l) * sigma[l]);
                    let value = s_lt * from_acc + s_l * from_speed
                        - twice_s_j * (t * self.kinetic.g_b[l] + s * self.g_tb[l])
                        + square * self.kinetic.g_ab[j * dof + l]
                        + self.potential.g_ab[j * dof + l] * v;
                    self.block[j * dof + l] += value;
                }
                self.block[j * dof + j] += straight * sigma[j];
            }
        }
        for c in 0..dof {
            let (p, p2) = (first.velocity(block, c), second.velocity[c]);
            self.block[c * dof + c] += p * p2 * prior.viscous[c] + p.sign() * p2.sign() * prior.coulomb[c];
        }
    }
}

/// The covariance matrix of torques divided by `units`, in the order of [`Motions::entry`].
pub(crate) struct Covariance<'a> {
    pub(crate) prior: &'a LagrangianPrior,
    pub(crate) units: &'a [f64],
    pub(crate) first: &'a Motions,
    pub(crate) second: &'a Motions,
    /// Only rows from the block of the column's own sample on: the lower triangle of a symmetric matrix, and a little more.
    pub(crate) lower_only: bool,
    pub(crate) to: MatMut<'a, f64>,
}

impl Covariance<'_> {
    pub(crate) fn write(self) {
        on_widest(self);
    }
}

impl Wide for Covariance<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(mut self) {
        let dof = self.units.len();
        let mut scratch = Scratch::new(dof);
        let mut spread = Spread::new(dof);
        for sample in 0..self.second.len() {
            self.second.spread(sample, &mut spread);
            let from = if self.lower_only { sample / LANES } else { 0 };
            for block in from..self.first.blocks() {
                scratch.covariance(self.prior, self.first, block, &spread);
                for l in 0..dof {
                    let column = self.to.as_mut().col_mut(self.second.entry(sample, l));
                    let column = column.try_as_col_major_mut().expect("columns are contiguous").as_slice_mut();
                    for j in 0..dof {
                        let scale = (self.units[j] * self.units[l]).recip();
                        let values = scratch.block[j * dof + l] * scale;
                        let rows = self.first.entries(block, j);
                        let count = rows.len();
                        column[rows].copy_from_slice(&values.0[..count]);
                    }
                }
            }
        }
    }
}
