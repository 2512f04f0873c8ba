//! The hyperparameters: the prior of energies and friction.

use serde::{Deserialize, Serialize};

use crate::error::GpError;

/// The prior of the energies of an arm of n joints and of their friction.
///
/// The kinetic energy of link i (which joints 1 to i move) has the covariance
///
/// (Σ_c σ_ic q̇_c q̇'_c)² Π_c (1 − ŵ_c + ŵ_c κ_c)²,
///
/// its potential energy v_i Π_c (1 − û_c + û_c κ_c), with c from 1 to i and κ_c = cos(q_c − q'_c) for a revolute joint,
/// q_c q'_c / scale² for a prismatic one. Every rigid arm is among their functions. Friction, which no energy makes, has the
/// covariance a_c q̇_c q̇'_c + b_c sign(q̇_c) sign(q̇'_c) on joint c.
///
/// Source: Giacomuzzo, Carli, Romeres and Dalla Libera 2024, "A Black-Box Physics-Informed Estimator based on Gaussian Process
/// Regression for Robot Inverse Dynamics Identification", section IV; ŵ = w / (1 + w) with their weight w.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LagrangianPrior {
    /// σ_ic, link after link: n (n + 1) / 2 entries; the standard deviation of an energy for squared speeds.
    pub kinetic: Vec<f64>,
    /// v_i, the variance of an energy.
    pub potential: Vec<f64>,
    /// ŵ_c, from 0 to 1: how much kinetic energies depend on the position of joint c.
    pub kinetic_share: Vec<f64>,
    /// û_c, from 0 to 1: how much potential energies depend on the position of joint c.
    pub potential_share: Vec<f64>,
    /// a_c, the variance of the coefficient of viscous friction.
    pub viscous: Vec<f64>,
    /// b_c, the variance of the level of Coulomb friction.
    pub coulomb: Vec<f64>,
}

impl LagrangianPrior {
    /// σ of link `i`, one for each joint up to it.
    #[inline(always)]
    pub(crate) fn sigma(&self, i: usize) -> &[f64] {
        &self.kinetic[i * (i + 1) / 2..(i + 1) * (i + 2) / 2]
    }

    pub(crate) fn validate(&self, dof: usize) -> Result<(), GpError> {
        let parts: [(_, &[f64], _, _); 6] = [
            ("kinetic", &self.kinetic, dof * (dof + 1) / 2, f64::MAX),
            ("potential", &self.potential, dof, f64::MAX),
            ("kinetic_share", &self.kinetic_share, dof, 1.0),
            ("potential_share", &self.potential_share, dof, 1.0),
            ("viscous", &self.viscous, dof, f64::MAX),
            ("coulomb", &self.coulomb, dof, f64::MAX),
        ];
        for (name, values, expected, most) in parts {
            if values.len() != expected {
                return Err(GpError::Entries { name, given: values.len(), expected });
            }
            if let Some(&value) = values.iter().find(|value| !(0.0..=most).contains(*value)) {
                let requirement = if most == 1.0 { "from 0 to 1" } else { "finite and not negative" };
                return Err(GpError::OutOfRange { name, value, requirement });
            }
        }
        Ok(())
    }

    /// The variables of the search: the logarithms of all variances, and of share / (1 − share).
    pub(crate) fn to_free(&self) -> Vec<f64> {
        let variances = [&self.kinetic, &self.potential, &self.viscous, &self.coulomb];
        let shares = [&self.kinetic_share, &self.potential_share];
        let logs = variances.into_iter().flatten().map(|value| value.ln());
        let odds = shares.into_iter().flatten().map(|share| (share / (1.0 - share)).ln());
        logs.chain(odds).collect()
    }

    /// The inverse of [`LagrangianPrior::to_free`]; further entries of `free` are ignored.
    pub(crate) fn from_free(free: &[f64], dof: usize) -> Self {
        let (kinetic, rest) = free.split_at(dof * (dof + 1) / 2);
        let part = |at: usize| rest[at * dof..(at + 1) * dof].iter();
        let variances = |at: usize| part(at).map(|x| x.exp()).collect();
        let shares = |at: usize| part(at).map(|x| (1.0 + (-x).exp()).recip()).collect();
        Self {
            kinetic: kinetic.iter().map(|x| x.exp()).collect(),
            potential: variances(0),
            viscous: variances(1),
            coulomb: variances(2),
            kinetic_share: shares(3),
            potential_share: shares(4),
        }
    }

    /// How many there are for `dof` joints.
    pub(crate) fn count(dof: usize) -> usize {
        dof * (dof + 1) / 2 + 5 * dof
    }

    /// The prior with all covariances times `factor`.
    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        for sigma in &mut self.kinetic {
            *sigma *= factor.sqrt();
        }
        for part in [&mut self.potential, &mut self.viscous, &mut self.coulomb] {
            part.iter_mut().for_each(|variance| *variance *= factor);
        }
        self
    }
}
