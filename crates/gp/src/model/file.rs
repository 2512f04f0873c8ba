//! Saving and loading: one JSON file per model, written completely or not at all.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::Gp;
use crate::conditioning::Conditioning;
use crate::data::{Hyperparameters, Lengths};
use crate::error::GpError;
use crate::file::{check_finite, load, save};
use crate::kernel::Points;
use crate::posterior::{Posterior, Triangle, VarianceFactors};

/// The file's version tag.
const FORMAT: &str = "testbed.gp/1";

/// The content of a file. Nothing is recomputed on loading, so that predictions have the same bits.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Saved {
    format: String,
    hyperparameters: Hyperparameters,
    /// The log marginal likelihood, nats; null if it is unbounded.
    log_marginal_likelihood: Option<f64>,
    conditioning: Conditioning,
    /// Number of inputs.
    dim: usize,
    /// Points of the posterior divided by the length scales, row after row.
    points: Vec<f64>,
    /// One weight per point, in the target's unit.
    weights: Vec<f64>,
    variance: VarianceFactors,
}

impl From<Gp> for Saved {
    fn from(gp: Gp) -> Self {
        let points = &gp.posterior.points;
        let (rank, dim) = (points.len(), points.dim());
        Self {
            format: FORMAT.to_owned(),
            log_marginal_likelihood: Some(gp.log_marginal_likelihood).filter(|l| l.is_finite()),
            points: (0..rank * dim).map(|at| points.coordinate(at / dim, at % dim)).collect(),
            weights: gp.posterior.weights[..rank].to_vec(),
            variance: gp.posterior.variance,
            hyperparameters: gp.hyperparameters,
            conditioning: gp.conditioning,
            dim,
        }
    }
}

impl TryFrom<Saved> for Gp {
    type Error = String;

    fn try_from(saved: Saved) -> Result<Self, String> {
        let Saved { format, dim, .. } = saved;
        if format != FORMAT {
            return Err(format!("format is \"{format}\", expected \"{FORMAT}\""));
        }
        let rank = saved.weights.len();
        if dim == 0 || rank.checked_mul(dim) != Some(saved.points.len()) {
            let given = saved.points.len();
            return Err(format!("points has {given} values, expected {rank} points of {dim} inputs"));
        }
        check_finite("points", &saved.points)?;
        check_finite("weights", &saved.weights)?;
        match &saved.variance {
            VarianceFactors::LowRank { pivots, inner, outer, rho } => {
                if let Some(pivot) = pivots.iter().find(|pivot| **pivot >= rank) {
                    return Err(format!("variance has pivot {pivot} among {rank} points"));
                }
                check_triangle("variance inner", inner, pivots.len())?;
                check_triangle("variance outer", outer, pivots.len())?;
                if !(*rho > 0.0 && rho.is_finite()) {
                    return Err(format!("variance rho is {rho}, expected a positive number"));
                }
            }
            VarianceFactors::Dense { outer } => check_triangle("variance outer", outer, rank)?,
        }
        if rank == 0 {
            let amplitude = saved.hyperparameters.amplitude;
            if amplitude != 0.0 {
                return Err(format!("amplitude is {amplitude} but there are no points"));
            }
        } else {
            let valid = saved.hyperparameters.validate(dim);
            valid.map_err(|error| error.to_string())?;
        }
        if let Lengths::PerInput(lengths) = &saved.hyperparameters.lengths
            && lengths.len() != dim
        {
            return Err(format!("{} length scales for {dim} inputs", lengths.len()));
        }
        let points = Points::new(rank, dim, |i, d| saved.points[i * dim + d]);
        let each = saved.hyperparameters.lengths.each(dim);
        Ok(Self {
            posterior: Posterior::new(points, each, saved.weights, saved.variance),
            hyperparameters: saved.hyperparameters,
            log_marginal_likelihood: saved.log_marginal_likelihood.unwrap_or(f64::INFINITY),
            conditioning: saved.conditioning,
        })
    }
}

fn check_triangle(name: &str, triangle: &Triangle, rank: usize) -> Result<(), String> {
    let (given, expected) = (triangle.0.len(), rank * (rank + 1) / 2);
    if given != expected {
        return Err(format!("{name} has {given} values, expected {expected} for {rank} points"));
    }
    check_finite(name, &triangle.0)?;
    match (0..rank).find(|&i| triangle.0[i * (i + 3) / 2] <= 0.0) {
        Some(i) => Err(format!("{name} has a diagonal entry that is not positive, in row {i}")),
        None => Ok(()),
    }
}

impl Gp {
    /// Writes the model to a JSON file, completely or not at all: first to a temporary file in the same folder, which
    /// is then renamed.
    ///
    /// # Errors
    /// [`GpError::File`], naming the file.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), GpError> {
        save(self, path.as_ref())
    }

    /// Reads a model from a file that [`Gp::save`] wrote; its predictions have the same bits as those of the saved
    /// model.
    ///
    /// # Errors
    /// [`GpError::File`] if it cannot be read, [`GpError::Format`] if it is not a model of this version or is inconsistent, both
    /// naming the file.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, GpError> {
        load(path.as_ref(), FORMAT)
    }
}
