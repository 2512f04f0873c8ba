//! The range of a Lagrangian regression: its variance as a share of the prior variance, from a few samples, fast enough for a
//! control step.

use faer::Mat;

use super::LagrangianGp;
use super::covariance::Covariance;
use super::lanes::LANES;
use super::posterior::LagrangianWorkspace;
use super::prior::LagrangianPrior;
use super::samples::Motions;
use crate::algebra::inverse_of_lower;
use crate::range::Columns;
use crate::wide::{Wide, on_widest};

/// The largest number of torques of a [`LagrangianRange`]: 32 samples of six joints.
const MOST: usize = 192;

/// Samples are added until the mean remaining share at those that carry the posterior is at most this.
const LARGEST_SHARE: f64 = 0.01;

/// A pivot below this part of the largest variance is rounding.
const LEAST_PIVOT: f64 = 1e-12;

/// An upper bound of the remaining share of the prior variance of each joint's torque at a motion: 0 where the samples are, 1 where
/// nothing is known.
///
/// The variance is that of the regression conditioned on the torques of a few samples (with their noise), those that leave the
/// least: fewer samples leave more, so that the share is not below the exact one. The prior variance is that at the motion, but not
/// less than its mean over the samples, so that a motion that needs little torque is not unknown for that. Nothing is allocated.
#[derive(Clone, Debug)]
pub struct LagrangianRange {
    prior: LagrangianPrior,
    units: Vec<f64>,
    motions: Motions,
    /// Sample and joint of each torque.
    entries: Vec<(usize, usize)>,
    /// L⁻¹, with L Lᵀ the covariance matrix of the torques.
    inverse: Columns,
    /// The mean prior variance of each joint.
    typical: Vec<f64>,
    mean_variance_share: Vec<f64>,
}

impl LagrangianRange {
    pub(crate) fn of(gp: &LagrangianGp) -> Self {
        let posterior = &gp.posterior;
        let (motions, units) = (&posterior.motions, &posterior.units);
        let (dof, samples) = (units.len(), motions.len());
        let n = samples * dof;
        let mut covariance = Mat::zeros(n, n);
        Covariance {
            prior: &gp.prior,
            units,
            first: motions,
            second: motions,
            lower_only: false,
            to: covariance.as_mut(),
        }
        .write();
        let noise: Vec<f64> = (0..dof).map(|joint| (gp.noise[joint] / units[joint]).powi(2)).collect();
        let own = |joint: usize| (0..samples).map(move |sample| motions.entry(sample, joint));
        let typical: Vec<f64> =
            (0..dof).map(|joint| own(joint).map(|at| covariance[(at, at)]).sum::<f64>() / samples as f64).collect();
        let mut left: Vec<f64> = (0..n).map(|at| covariance[(at, at)]).collect();
        let largest = left.iter().copied().fold(0.0, f64::max);
        let reference: Vec<f64> = (0..n).map(|at| left[at]).collect();
        let share = |left: &[f64], sample: usize, joint: usize| {
            let at = motions.entry(sample, joint);
            match reference[at].max(typical[joint]) {
                whole if whole > 0.0 => left[at] / whole,
                _ => 0.0,
            }
        };
        let mean_share = |left: &[f64], joint: usize| {
            let shares = (0..samples).map(|sample| share(left, sample, joint));
            shares.sum::<f64>() / samples as f64
        };
        let mut chosen: Vec<usize> = Vec::new();
        let mut entries = Vec::new();
        // Columns of the factor, of the torques without noise; and its rows at the chosen torques, with noise.
        let mut factor: Vec<Vec<f64>> = Vec::new();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        while entries.len() + dof <= MOST && chosen.len() < samples {
            let mean = (0..dof).map(|joint| mean_share(&left, joint)).sum::<f64>() / dof as f64;
            if mean <= LARGEST_SHARE {
                break;
            }
            let unknown = |sample: usize| (0..dof).map(|joint| share(&left, sample, joint)).sum::<f64>();
            let next = (0..samples)
                .filter(|sample| !chosen.contains(sample))
                .max_by(|a, b| unknown(*a).total_cmp(&unknown(*b)));
            let Some(next) = next else { break };
            chosen.push(next);
            for joint in 0..dof {
                let at = motions.entry(next, joint);
                let mut column = covariance.col_as_slice(at).to_vec();
                let row: Vec<f64> = factor.iter().map(|column| column[at]).collect();
                for (other, &scale) in factor.iter().zip(&row) {
                    for (value, other) in column.iter_mut().zip(other) {
                        *value -= other * scale;
                    }
                }
                let pivot = column[at] + noise[joint];
                if pivot <= LEAST_PIVOT * largest {
                    continue;
                }
                for (value, left) in column.iter_mut().zip(&mut left) {
                    *value /= pivot.sqrt();
                    *left = (*left - *value * *value).max(0.0);
                }
                factor.push(column);
                rows.push(row.into_iter().chain([pivot.sqrt()]).collect());
                entries.push((chosen.len() - 1, joint));
            }
        }
        let triangle = Mat::from_fn(rows.len(), rows.len(), |i, j| if j <= i { rows[i][j] } else { 0.0 });
        Self {
            prior: gp.prior.clone(),
            units: units.clone(),
            motions: motions.subset(&chosen),
            entries,
            inverse: Columns::new(inverse_of_lower(triangle.as_ref()).as_ref(), 1.0),
            mean_variance_share: (0..dof).map(|joint| mean_share(&left, joint)).collect(),
            typical,
        }
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.motions.len()
    }

    /// The mean remaining share of `joint` at the samples that carry the posterior.
    pub fn mean_variance_share(&self, joint: usize) -> f64 {
        self.mean_variance_share[joint]
    }

    /// The remaining share of the prior variance of the torque of `joint`, from 0 to 1, at the motion of the workspace's last
    /// call; NaN if the motion is NaN, and 0 for a torque that is known to be zero.
    ///
    /// # Panics
    /// If the workspace is of another number of joints.
    pub fn variance_share(&self, joint: usize, workspace: &mut LagrangianWorkspace) -> f64 {
        on_widest(Share { range: self, joint, workspace })
    }
}

struct Share<'a> {
    range: &'a LagrangianRange,
    joint: usize,
    workspace: &'a mut LagrangianWorkspace,
}

impl Wide for Share<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> f64 {
        let Self { range, joint, workspace: LagrangianWorkspace { motion, at, covariance, .. } } = self;
        let dof = range.units.len();
        covariance.covariance(&range.prior, motion, 0, at);
        let own = covariance.block[joint * dof + joint].0[0] / range.units[joint].powi(2);
        // Not `max`, which would replace NaN by a number.
        let whole = if own < range.typical[joint] { range.typical[joint] } else { own };
        if whole == 0.0 {
            return 0.0;
        }
        let mut column = [0.0; MOST];
        let mut entries = range.entries.iter().enumerate().peekable();
        for block in 0..range.motions.blocks() {
            covariance.covariance(&range.prior, &range.motions, block, at);
            while let Some((at, &(sample, of))) = entries.next_if(|(_, (sample, _))| sample / LANES == block) {
                let value = covariance.block[of * dof + joint].0[sample % LANES];
                column[at] = value / (range.units[of] * range.units[joint]);
            }
        }
        let known = range.inverse.square_of_product(&column[..range.entries.len()]);
        ((own - known) / whole).clamp(0.0, 1.0)
    }
}
