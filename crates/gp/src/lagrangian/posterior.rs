//! The posterior: the samples that represent it with their weights, and the matrices of its variance.

use faer::linalg::matmul::triangular::BlockStructure;
use faer::{Accum, Mat, MatRef};

use super::covariance::{self, Covariance};
use super::likelihood::Factored;
use super::mean::{self, Mean, Weights};
use super::prior::LagrangianPrior;
use super::samples::{Motions, Spread, TorqueSamples};
use super::search::FLOOR;
use crate::algebra::{cholesky, solve_lower, solve_lower_all, solve_lower_transposed, triangular_matmul};
use crate::conditioning::floor;
use crate::error::GpError;
use crate::wide::{Wide, on_widest};

/// The relative noise from which all samples determine the posterior, and not only those that carry it; smaller ones of other joints
/// count as this, because their squares would leave nothing of the rest.
pub(crate) const NOISY: f64 = 1e-8;

/// Samples that are projected on the support at a time.
const BATCH: usize = 128;

/// The posterior, with torques in `units`.
#[derive(Clone, Debug)]
pub(crate) struct Posterior {
    pub(crate) units: Vec<f64>,
    pub(crate) motions: Motions,
    /// The weights in the order of [`Motions::entry`]; torques are Σ K weights.
    pub(crate) alpha: Vec<f64>,
    weights: Weights,
    /// The mean prior variance, by which the matrices of the factors are divided.
    pub(crate) mean_variance: f64,
    /// G with G Gᵀ = K + noise (or + the floor, if `projected` is there) of the support.
    pub(crate) support: Mat<f64>,
    /// The factor of Fᵀ Λ⁻¹ F + I, where F = K_n· G⁻ᵀ of all samples and Λ is the noise.
    pub(crate) projected: Option<Mat<f64>>,
}

impl Posterior {
    /// The posterior of the support's `motions`, of which `factored` is the covariance with its noise, or of `all` if there is
    /// noise; with the number of samples that determine it.
    pub(crate) fn new(
        prior: &LagrangianPrior,
        rho: &[f64],
        units: &[f64],
        motions: Motions,
        factored: Factored,
        all: impl Fn() -> TorqueSamples,
    ) -> Result<(Self, usize), GpError> {
        let (used, support, projected, mut alpha, mean_variance);
        if rho.iter().all(|rho| *rho < NOISY) {
            (used, projected) = (motions.len(), None);
            (support, alpha, mean_variance) = (factored.outer, factored.alpha, factored.mean_variance);
        } else {
            let all = all();
            used = all.len().max(motions.len());
            mean_variance = factored.mean_variance;
            support = support_factor(prior, None, units, &motions)?.outer;
            let (projection, weights) = project(prior, rho, units, &motions, mean_variance, &support, &all)?;
            (projected, alpha) = (Some(projection), weights);
        }
        for sample in 0..motions.len() {
            for (joint, unit) in units.iter().enumerate() {
                alpha[motions.entry(sample, joint)] /= unit * mean_variance;
            }
        }
        let posterior = Self::of_parts(prior, units, motions, alpha, (mean_variance, support, projected));
        Ok((posterior, used))
    }

    pub(crate) fn of_parts(
        prior: &LagrangianPrior,
        units: &[f64],
        motions: Motions,
        alpha: Vec<f64>,
        (mean_variance, support, projected): (f64, Mat<f64>, Option<Mat<f64>>),
    ) -> Self {
        Self {
            units: units.to_vec(),
            weights: Weights::new(prior, &motions, &alpha),
            motions,
            alpha,
            mean_variance,
            support,
            projected,
        }
    }

    /// The posterior of torques that are zero everywhere.
    pub(crate) fn of_nothing(prior: &LagrangianPrior, motions: Motions) -> Self {
        let dof = motions.joints().len();
        let n = motions.len() * dof;
        let unit = Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j)));
        Self::of_parts(prior, &vec![1.0; dof], motions, vec![0.0; n], (1.0, unit, None))
    }

    /// The mean at the workspace's motion.
    pub(crate) fn mean(&self, prior: &LagrangianPrior, workspace: &mut LagrangianWorkspace, torques: &mut [f64]) {
        assert_eq!(torques.len(), self.units.len(), "joints given and expected");
        Mean {
            prior,
            motions: &self.motions,
            weights: &self.weights,
            at: &workspace.at,
            scratch: &mut workspace.mean,
            torques,
        }
        .write();
    }

    /// The variance at the workspace's motion: k_xx − |G⁻¹ k|², plus the variance that the projection leaves.
    pub(crate) fn variance(&self, prior: &LagrangianPrior, workspace: &mut LagrangianWorkspace, variances: &mut [f64]) {
        let dof = self.units.len();
        assert_eq!(variances.len(), dof, "joints given and expected");
        workspace.prior_variance(prior, variances);
        let n = self.motions.len() * dof;
        workspace.columns.resize(n * dof, 0.0);
        Cross {
            prior,
            units: &self.units,
            motions: &self.motions,
            at: &workspace.at,
            scratch: &mut workspace.covariance,
            scale: self.mean_variance.recip(),
            to: &mut workspace.columns,
        }
        .write();
        let columns = &mut workspace.columns;
        Solve { lower: self.support.as_ref(), columns }.run_widest();
        let square = |columns: &[f64], joint: usize| -> f64 {
            let column = &columns[joint * n..(joint + 1) * n];
            column.iter().map(|value| value * value).sum::<f64>() * self.mean_variance * self.units[joint].powi(2)
        };
        for (joint, variance) in variances.iter_mut().enumerate() {
            *variance -= square(columns, joint);
        }
        if let Some(projected) = &self.projected {
            Solve { lower: projected.as_ref(), columns }.run_widest();
            for (joint, variance) in variances.iter_mut().enumerate() {
                *variance += square(columns, joint);
            }
        }
        for variance in variances {
            // A comparison instead of `max`, which would replace NaN by a number.
            if *variance < 0.0 {
                *variance = 0.0;
            }
        }
    }
}

/// The factor of the support's covariance over its mean variance, with these relative noises on the diagonal, or the floor.
pub(crate) fn support_factor(
    prior: &LagrangianPrior,
    rho: Option<&[f64]>,
    units: &[f64],
    motions: &Motions,
) -> Result<Factored, GpError> {
    let n = motions.len() * units.len();
    let floor = vec![FLOOR * floor(n); units.len()];
    let factored = Factored::new(prior, rho.unwrap_or(&floor), units, motions, &vec![0.0; n]);
    factored.ok_or_else(|| GpError::Likelihood("the support's covariance has no factor".to_owned()))
}

/// The factor of Fᵀ Λ⁻¹ F + I, and the support's weights: G⁻ᵀ (Fᵀ Λ⁻¹ F + I)⁻¹ Fᵀ Λ⁻¹ y.
fn project(
    prior: &LagrangianPrior,
    rho: &[f64],
    units: &[f64],
    motions: &Motions,
    mean_variance: f64,
    support: &Mat<f64>,
    all: &TorqueSamples,
) -> Result<(Mat<f64>, Vec<f64>), GpError> {
    let (dof, n) = (units.len(), support.nrows());
    let mut matrix = Mat::zeros(n, n);
    let mut weights = vec![0.0; n];
    for at in 0..n {
        matrix[(at, at)] = 1.0;
    }
    for from in (0..all.len()).step_by(BATCH) {
        let batch = all.rows(from..(from + BATCH).min(all.len()));
        let few = batch.motions(motions.scales());
        let y = batch.targets(&few, units);
        let mut f = Mat::zeros(n, y.len());
        Covariance { prior, units, first: motions, second: &few, lower_only: false, to: f.as_mut() }.write();
        solve_lower_all(support.as_ref(), f.as_mut());
        for sample in 0..few.len() {
            for joint in 0..dof {
                let at = few.entry(sample, joint);
                let precision = rho[joint].max(NOISY).recip();
                let target = y[at] * precision.sqrt();
                let scale = precision.sqrt() / mean_variance;
                for (value, weight) in f.col_as_slice_mut(at).iter_mut().zip(&mut weights) {
                    *value *= scale;
                    *weight += *value * target;
                }
            }
        }
        triangular_matmul(
            (matrix.as_mut(), BlockStructure::TriangularLower),
            Accum::Add,
            (f.as_ref(), BlockStructure::Rectangular),
            (f.transpose(), BlockStructure::Rectangular),
            1.0,
        );
    }
    if !cholesky(matrix.as_mut()) {
        return Err(GpError::Likelihood("the projected covariance has no factor".to_owned()));
    }
    for column in 1..n {
        matrix.col_as_slice_mut(column)[..column].fill(0.0);
    }
    solve_lower(matrix.as_ref(), &mut weights);
    solve_lower_transposed(matrix.as_ref(), &mut weights);
    solve_lower_transposed(support.as_ref(), &mut weights);
    Ok((matrix, weights))
}

/// Scratch for a [`super::LagrangianGp`]; it grows on first use of a model, and nothing is allocated afterwards.
#[derive(Clone, Debug)]
pub struct LagrangianWorkspace {
    /// The motion asked for, alone in its block.
    pub(crate) motion: Motions,
    pub(crate) at: Spread,
    mean: mean::Scratch,
    pub(crate) covariance: covariance::Scratch,
    columns: Vec<f64>,
}

impl LagrangianWorkspace {
    pub(crate) fn new(like: &Motions) -> Self {
        let dof = like.joints().len();
        Self {
            motion: like.subset(&[0]),
            at: Spread::new(dof),
            mean: mean::Scratch::new(dof),
            covariance: covariance::Scratch::new(dof),
            columns: Vec::new(),
        }
    }

    /// Takes a motion of the joints that `like` has; a workspace that was another model's is made anew.
    pub(crate) fn set(&mut self, like: &Motions, [q, qd, qdd]: [&[f64]; 3]) {
        if self.motion.joints() != like.joints() || self.motion.scales() != like.scales() {
            *self = Self::new(like);
        }
        let dof = like.joints().len();
        assert!([q, qd, qdd].iter().all(|part| part.len() == dof), "a motion of {dof} joints is expected");
        self.motion.set(0, 0, q, qd, qdd);
        self.motion.spread(0, &mut self.at);
    }

    /// The prior variance of each joint's torque at the motion.
    pub(crate) fn prior_variance(&mut self, prior: &LagrangianPrior, variances: &mut [f64]) {
        let dof = variances.len();
        self.covariance.covariance(prior, &self.motion, 0, &self.at);
        for (joint, variance) in variances.iter_mut().enumerate() {
            *variance = self.covariance.block[joint * dof + joint].0[0];
        }
    }
}

/// The covariance of all torques of `motions` with those of one motion, times `scale` and in `units`, column by column.
struct Cross<'a> {
    prior: &'a LagrangianPrior,
    units: &'a [f64],
    motions: &'a Motions,
    at: &'a Spread,
    scratch: &'a mut covariance::Scratch,
    scale: f64,
    to: &'a mut [f64],
}

impl Cross<'_> {
    fn write(self) {
        on_widest(self);
    }
}

impl Wide for Cross<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let dof = self.units.len();
        let n = self.motions.len() * dof;
        for block in 0..self.motions.blocks() {
            self.scratch.covariance(self.prior, self.motions, block, self.at);
            for l in 0..dof {
                for j in 0..dof {
                    let scale = self.scale / (self.units[j] * self.units[l]);
                    let values = self.scratch.block[j * dof + l] * scale;
                    let rows = self.motions.entries(block, j);
                    let count = rows.len();
                    self.to[l * n..][rows].copy_from_slice(&values.0[..count]);
                }
            }
        }
    }
}

/// Columns ← G⁻¹ columns, without allocating.
struct Solve<'a> {
    lower: MatRef<'a, f64>,
    columns: &'a mut [f64],
}

impl Solve<'_> {
    fn run_widest(self) {
        on_widest(self);
    }
}

impl Wide for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let n = self.lower.nrows();
        for at in 0..n {
            let lower = self.lower.col(at).try_as_col_major().expect("columns are contiguous").as_slice();
            for column in self.columns.chunks_exact_mut(n) {
                let value = column[at] / lower[at];
                column[at] = value;
                for (entry, factor) in column[at + 1..].iter_mut().zip(&lower[at + 1..]) {
                    *entry -= value * factor;
                }
            }
        }
    }
}
