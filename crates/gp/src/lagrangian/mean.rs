//! The mean of the torques: Lagrange's equations applied to the prior that the samples determine.

use super::factors::Factors;
use super::lanes::{Lanes, sign};
use super::prior::LagrangianPrior;
use super::samples::{Motions, Spread};
use crate::wide::{Wide, on_widest};

/// Weights of samples, which make the posterior prior: Σ weights · T' k.
#[derive(Clone, Debug)]
pub(crate) struct Weights {
    /// The weights of each joint in blocks of samples, with zeros in the padding.
    values: Vec<Lanes>,
    /// Coefficient of viscous friction and level of Coulomb friction of each joint.
    friction: Vec<[f64; 2]>,
}

impl Weights {
    /// `alpha` in the order of [`Motions::entry`]: one for each torque.
    pub(crate) fn new(prior: &LagrangianPrior, motions: &Motions, alpha: &[f64]) -> Self {
        let dof = motions.joints().len();
        let weights = |at: usize| Lanes::read(&alpha[motions.entries(at / dof, at % dof)]);
        let values: Vec<Lanes> = (0..motions.blocks() * dof).map(weights).collect();
        let friction = |c: usize| {
            let (mut viscous, mut coulomb) = (Lanes::ZERO, Lanes::ZERO);
            for block in 0..motions.blocks() {
                let (p, weight) = (motions.velocity(block, c), values[block * dof + c]);
                viscous += p * weight;
                coulomb += p.sign() * weight;
            }
            [viscous.sum() * prior.viscous[c], coulomb.sum() * prior.coulomb[c]]
        };
        let friction = (0..dof).map(friction).collect();
        Self { values, friction }
    }
}

/// Scratch of [`Mean`].
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    factors: Factors,
    /// The derivatives of Π, the product of the kinetic factors, by q_c: those of Π itself, of Π along the sample's speeds, and of Π along
    /// the weights.
    by: [Vec<Lanes>; 3],
    /// The derivatives of the product of the potential factors by q_c: those of the product itself, and of the product along the
    /// weights.
    potential_by: [Vec<Lanes>; 2],
    torque: Vec<Lanes>,
}

impl Scratch {
    pub(crate) fn new(dof: usize) -> Self {
        let vector = || vec![Lanes::ZERO; dof];
        Self {
            factors: Factors::new(dof),
            by: std::array::from_fn(|_| vector()),
            potential_by: std::array::from_fn(|_| vector()),
            torque: vector(),
        }
    }
}

/// The mean of all torques at one motion. Names of variables are those of [`super::covariance`], with the roles exchanged: the
/// samples, of which there is one in each lane, are the first motion, and the one asked for is the second.
pub(crate) struct Mean<'a> {
    pub(crate) prior: &'a LagrangianPrior,
    pub(crate) motions: &'a Motions,
    pub(crate) weights: &'a Weights,
    pub(crate) at: &'a Spread,
    pub(crate) scratch: &'a mut Scratch,
    pub(crate) torques: &'a mut [f64],
}

impl Mean<'_> {
    pub(crate) fn write(self) {
        on_widest(self);
    }
}

impl Wide for Mean<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Self { prior, motions, weights, at, scratch, torques } = self;
        let dof = torques.len();
        scratch.torque.fill(Lanes::ZERO);
        for block in 0..motions.blocks() {
            let alpha = &weights.values[block * dof..(block + 1) * dof];
            scratch.add(prior, motions, block, alpha, at);
        }
        for (c, torque) in torques.iter_mut().enumerate() {
            let speed = at.velocity[c].0[0];
            let [viscous, coulomb] = weights.friction[c];
            *torque = scratch.torque[c].sum() + viscous * speed + coulomb * sign(speed);
        }
    }
}

impl Scratch {
    /// Adds the contribution of the samples of one block.
    #[inline(always)]
    fn add(&mut self, prior: &LagrangianPrior, motions: &Motions, block: usize, alpha: &[Lanes], at: &Spread) {
        let Self { factors, by: [g_b, g_tb, g_ab], potential_by: [h_b, h_ab], torque } = self;
        let dof = alpha.len();
        factors.compute(motions, block, &at.position, &prior.kinetic_share, &prior.potential_share);
        // The products over the joints up to the link's, and their derivatives along the sample's speeds (t) and its weights (a).
        let (mut g, mut g_t, mut g_a) = (Lanes::ONE, Lanes::ZERO, Lanes::ZERO);
        let (mut h, mut h_a) = (Lanes::ONE, Lanes::ZERO);
        for i in 0..dof {
            let sigma = prior.sigma(i);
            let (factor, below) = (&factors.kinetic[i], &factors.potential[i]);
            let (speed, weight) = (motions.velocity(block, i), alpha[i]);
            let (along_t, along_a) = (factor.first * speed, factor.first * weight);
            let (both_t, both_a) = (factor.both * speed, factor.both * weight);
            for l in 0..i {
                g_tb[l] = g_tb[l] * factor.value + g_b[l] * along_t;
                g_ab[l] = g_ab[l] * factor.value + g_b[l] * along_a;
                g_b[l] *= factor.value;
                h_ab[l] = h_ab[l] * below.value + h_b[l] * below.first * weight;
                h_b[l] *= below.value;
            }
            g_tb[i] = g_t * factor.second + g * both_t;
            g_ab[i] = g_a * factor.second + g * both_a;
            g_b[i] = g * factor.second;
            h_ab[i] = h_a * below.second + h * below.both * weight;
            h_b[i] = h * below.second;
            g_t = g_t * factor.value + g * along_t;
            g_a = g_a * factor.value + g * along_a;
            g *= factor.value;
            h_a = h_a * below.value + h * below.first * weight;
            h *= below.value;

            // s and its derivatives by the sample's time, by the time of the requested motion, and by both; and their values
            // where the sample's speed is replaced by its weights (w).
            let [mut s, mut t, mut u, mut tu, mut w, mut wu] = [Lanes::ZERO; 6];
            for (c, &sigma) in sigma.iter().enumerate() {
                let (p, acc) = (at.velocity[c] * sigma, at.acceleration[c] * sigma);
                let (speed, acceleration) = (motions.velocity(block, c), motions.acceleration(block, c));
                s += p * speed;
                u += acc * speed;
                t += p * acceleration;
                tu += acc * acceleration;
                w += p * alpha[c];
                wu += acc * alpha[c];
            }
            let [mut g_u, mut g_tu, mut g_au] = [Lanes::ZERO; 3];
            for d in 0..=i {
                let p = at.velocity[d];
                g_u += p * g_b[d];
                g_tu += p * g_tb[d];
                g_au += p * g_ab[d];
            }
            // The posterior energy of the samples is E = 2 w (t g + s g_t) − s² g_a; ∂E/∂q̇_l is linear in the sample's weight, speed
            // and acceleration at joint l, and its rate of change along the motion asked for has these coefficients.
            let on_weight = (tu * g + t * g_u + u * g_t + s * g_tu) * 2.0;
            let on_speed = (wu * g_t + w * g_tu - u * g_a - s * g_au) * 2.0;
            let on_acceleration = (wu * g + w * g_u) * 2.0;
            let (twice_wt, twice_ws, square) = (w * t * 2.0, w * s * 2.0, s * s);
            let v = prior.potential[i];
            for l in 0..=i {
                let (speed, acceleration) = (motions.velocity(block, l), motions.acceleration(block, l));
                let rate = alpha[l] * on_weight + speed * on_speed + acceleration * on_acceleration;
                let force = twice_wt * g_b[l] + twice_ws * g_tb[l] - square * g_ab[l];
                torque[l] += rate * sigma[l] - force + h_ab[l] * v;
            }
        }
    }
}
