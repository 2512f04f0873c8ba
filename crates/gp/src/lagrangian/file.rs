//! Saving and loading: one JSON file per model, written completely or not at all.

use std::path::Path;

use faer::Mat;
use serde::{Deserialize, Serialize};

use super::posterior::{Posterior, support_factor};
use super::samples::{JointType, Motions};
use super::{LagrangianConditioning, LagrangianGp, LagrangianPrior};
use crate::error::GpError;
use crate::file::{check_finite, load, save};

/// The file's version tag.
const FORMAT: &str = "testbed.lagrangian/1";

/// The content of a file. Means need nothing else, so that they have the same bits; the factor of the support's covariance, which
/// variances need, is computed again.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Saved {
    format: String,
    joints: Vec<JointType>,
    prior: LagrangianPrior,
    /// One a joint (N m or N).
    noise: Vec<f64>,
    /// Nats; null if it is unbounded, because all torques were zero.
    log_marginal_likelihood: Option<f64>,
    conditioning: LagrangianConditioning,
    /// One a joint: the unit of its position (1 for angles; m), and that of its torque (N m or N).
    scales: Vec<f64>,
    units: Vec<f64>,
    /// The samples that carry the posterior, one after the other; of each joint cosine and sine of the position (position over
    /// scale and 0 of a prismatic one), speed and acceleration.
    motions: Vec<[f64; 4]>,
    /// One a sample and joint.
    weights: Vec<f64>,
    /// The support's variance given the torques of all samples: a lower triangle, row by row; null without noise.
    projected: Option<Vec<f64>>,
}

impl LagrangianGp {
    /// Writes the model to a JSON file, completely or not at all: first to a temporary file in the same folder, which is then
    /// renamed.
    ///
    /// # Errors
    /// [`GpError::File`], naming the file.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), GpError> {
        let Posterior { units, motions, alpha, projected, .. } = &self.posterior;
        let dof = units.len();
        let each = || (0..motions.len()).flat_map(|sample| (0..dof).map(move |joint| (sample, joint)));
        let saved = Saved {
            format: FORMAT.to_owned(),
            joints: motions.joints().to_vec(),
            prior: self.prior.clone(),
            noise: self.noise.clone(),
            log_marginal_likelihood: Some(self.log_marginal_likelihood).filter(|value| value.is_finite()),
            conditioning: self.conditioning.clone(),
            scales: motions.scales().to_vec(),
            units: units.clone(),
            motions: each().map(|(sample, joint)| motions.entry_values(sample, joint)).collect(),
            weights: each().map(|(sample, joint)| alpha[motions.entry(sample, joint)]).collect(),
            projected: projected.as_ref().map(|matrix| {
                let row = |i: usize| (0..=i).map(move |j| matrix[(i, j)]);
                (0..matrix.nrows()).flat_map(row).collect()
            }),
        };
        save(&saved, path.as_ref())
    }

    /// Reads a model from a file that [`LagrangianGp::save`] wrote; its means have the same bits as those of the saved model.
    ///
    /// # Errors
    /// [`GpError::File`] if it cannot be read, [`GpError::Format`] if it is not a model of this version or is inconsistent, both
    /// naming the file.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, GpError> {
        let path = path.as_ref();
        let saved: Saved = load(path, FORMAT)?;
        saved.model().map_err(|reason| GpError::Format { path: path.to_owned(), reason })
    }
}

impl Saved {
    fn model(self) -> Result<LagrangianGp, String> {
        let dof = self.joints.len();
        let torques = self.weights.len();
        if dof == 0 || torques == 0 || !torques.is_multiple_of(dof) || self.motions.len() != torques {
            let motions = self.motions.len();
            return Err(format!(
                "there are {motions} motions and {torques} weights of {dof} joints: expected the same number, one or more for each joint"
            ));
        }
        self.prior.validate(dof).map_err(|error| error.to_string())?;
        let positive = |name: &str, values: &[f64], zero: bool| {
            let given = values.len();
            if given != dof {
                return Err(format!("{name} has {given} entries, expected {dof}"));
            }
            match values.iter().find(|value| !(value.is_finite() && (**value > 0.0 || zero && **value == 0.0))) {
                Some(value) => Err(format!("{name} has the entry {value}: it must be finite and positive")),
                None => Ok(()),
            }
        };
        positive("scales", &self.scales, false)?;
        positive("units", &self.units, false)?;
        positive("noise", &self.noise, true)?;
        positive("relative_noise", &self.conditioning.relative_noise, true)?;
        check_finite("motions", self.motions.as_flattened())?;
        check_finite("weights", &self.weights)?;
        let motions = Motions::of_values(&self.joints, &self.scales, &self.motions);
        let mut alpha = vec![0.0; torques];
        for (at, weight) in self.weights.iter().enumerate() {
            alpha[motions.entry(at / dof, at % dof)] = *weight;
        }
        let posterior = if self.log_marginal_likelihood.is_none() {
            Posterior::of_nothing(&self.prior, motions)
        } else {
            let projected = self.projected.as_deref().map(|values| triangle(values, torques)).transpose()?;
            let rho = Some(self.conditioning.relative_noise.as_slice()).filter(|_| projected.is_none());
            let factored =
                support_factor(&self.prior, rho, &self.units, &motions).map_err(|error| error.to_string())?;
            let factors = (factored.mean_variance, factored.outer, projected);
            Posterior::of_parts(&self.prior, &self.units, motions, alpha, factors)
        };
        Ok(LagrangianGp {
            prior: self.prior,
            noise: self.noise,
            log_marginal_likelihood: self.log_marginal_likelihood.unwrap_or(f64::INFINITY),
            conditioning: self.conditioning,
            posterior,
        })
    }
}

fn triangle(values: &[f64], n: usize) -> Result<Mat<f64>, String> {
    let (given, expected) = (values.len(), n * (n + 1) / 2);
    if given != expected {
        return Err(format!("projected has {given} values, expected {expected} for {n} torques"));
    }
    check_finite("projected", values)?;
    if let Some(i) = (0..n).find(|i| values[i * (i + 3) / 2] <= 0.0) {
        return Err(format!("projected has a diagonal entry that is not positive, in row {i}"));
    }
    Ok(Mat::from_fn(n, n, |i, j| if j <= i { values[i * (i + 1) / 2 + j] } else { 0.0 }))
}
