//! The factor of one joint in the covariances of the energies, with its derivatives by position.

use super::lanes::Lanes;
use super::samples::{JointType, Motions};

/// A factor f(q, q') with its derivatives: by q, by q', and by both.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factor {
    pub(crate) value: Lanes,
    pub(crate) first: Lanes,
    pub(crate) second: Lanes,
    pub(crate) both: Lanes,
}

impl Factor {
    pub(crate) const ZERO: Self =
        Self { value: Lanes::ZERO, first: Lanes::ZERO, second: Lanes::ZERO, both: Lanes::ZERO };

    /// The sum of products of all parts.
    #[inline(always)]
    pub(crate) fn dot(&self, other: &Self) -> Lanes {
        self.value * other.value + self.first * other.first + self.second * other.second + self.both * other.both
    }

    #[inline(always)]
    fn squared(&self) -> Self {
        Self {
            value: self.value * self.value,
            first: self.value * self.first * 2.0,
            second: self.value * self.second * 2.0,
            both: (self.first * self.second + self.value * self.both) * 2.0,
        }
    }

    /// 2 self · other, by the product rule.
    #[inline(always)]
    fn twice_product(&self, other: &Self) -> Self {
        Self {
            value: self.value * other.value * 2.0,
            first: (self.value * other.first + self.first * other.value) * 2.0,
            second: (self.value * other.second + self.second * other.value) * 2.0,
            both: (self.both * other.value
                + self.value * other.both
                + self.first * other.second
                + self.second * other.first)
                * 2.0,
        }
    }
}

/// κ(q, q') with its derivatives: cos(q − q') of a revolute joint, q q' (in units of the joint's scale) of a prismatic one.
#[inline(always)]
fn similarity(joint: JointType, scale: f64, first: (Lanes, Lanes), second: (Lanes, Lanes)) -> Factor {
    match joint {
        JointType::Revolute => {
            let cosine = first.0 * second.0 + first.1 * second.1;
            let sine = first.1 * second.0 - first.0 * second.1;
            Factor { value: cosine, first: Lanes::ZERO - sine, second: sine, both: cosine }
        }
        JointType::Prismatic => Factor {
            value: first.0 * second.0,
            first: second.0 * scale.recip(),
            second: first.0 * scale.recip(),
            both: Lanes::splat(scale.powi(-2)),
        },
    }
}

/// 1 − share + share κ.
#[inline(always)]
fn mixed(kappa: &Factor, share: f64) -> Factor {
    Factor {
        value: Lanes::splat(1.0 - share) + kappa.value * share,
        first: kappa.first * share,
        second: kappa.second * share,
        both: kappa.both * share,
    }
}

/// The factors of all joints for one pair of blocks.
#[derive(Clone, Debug)]
pub(crate) struct Factors {
    /// (1 − ŵ + ŵ κ)² of each joint: second order in cosine and sine.
    pub(crate) kinetic: Vec<Factor>,
    /// 1 − û + û κ of each joint: first order.
    pub(crate) potential: Vec<Factor>,
    similarity: Vec<Factor>,
}

impl Factors {
    pub(crate) fn new(dof: usize) -> Self {
        Self {
            kinetic: vec![Factor::ZERO; dof],
            potential: vec![Factor::ZERO; dof],
            similarity: vec![Factor::ZERO; dof],
        }
    }

    /// Computes the factors between `block` of `first` and the positions `second` (as [`Motions::position`] has them), with the
    /// shares ŵ and û of cosine and sine in each joint's factors.
    #[inline(always)]
    pub(crate) fn compute(
        &mut self,
        first: &Motions,
        block: usize,
        second: &[(Lanes, Lanes)],
        kinetic: &[f64],
        potential: &[f64],
    ) {
        for (c, (&joint, &scale)) in first.joints().iter().zip(first.scales()).enumerate() {
            let kappa = similarity(joint, scale, first.position(block, c), second[c]);
            self.similarity[c] = kappa;
            self.kinetic[c] = mixed(&kappa, kinetic[c]).squared();
            self.potential[c] = mixed(&kappa, potential[c]);
        }
    }

    /// The derivatives of joint `c`'s factors by the logarithms of ŵ / (1 − ŵ) and û / (1 − û).
    #[inline(always)]
    pub(crate) fn by_weights(&self, c: usize, kinetic: f64, potential: f64) -> [Factor; 2] {
        let kappa = &self.similarity[c];
        let change = |share: f64| {
            let rate = share * (1.0 - share);
            Factor {
                value: (kappa.value - Lanes::ONE) * rate,
                first: kappa.first * rate,
                second: kappa.second * rate,
                both: kappa.both * rate,
            }
        };
        [mixed(kappa, kinetic).twice_product(&change(kinetic)), change(potential)]
    }
}
