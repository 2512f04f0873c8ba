//! Training data and hyperparameters, validated once when they are made.

use serde::{Deserialize, Serialize};

use crate::error::GpError;
use crate::kernel::Points;

/// Training samples: at least one, finite, and all of the same dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingSet {
    dim: usize,
    inputs: Vec<f64>,
    targets: Vec<f64>,
}

impl TrainingSet {
    /// Takes `targets.len()` samples of `dim` inputs each, `inputs` row by row (sample after sample); any units.
    ///
    /// # Errors
    /// [`GpError::Empty`], [`GpError::Shape`], [`GpError::Input`] and [`GpError::Target`], naming the row and column.
    pub fn new(dim: usize, inputs: &[f64], targets: &[f64]) -> Result<Self, GpError> {
        let samples = targets.len();
        if samples == 0 || dim == 0 {
            return Err(GpError::Empty { samples, dim });
        }
        if inputs.len() != samples * dim {
            let values = inputs.len();
            return Err(GpError::Shape { values, samples, dim });
        }
        if let Some(at) = inputs.iter().position(|value| !value.is_finite()) {
            let (row, column) = (at / dim, at % dim);
            let value = inputs[at];
            return Err(GpError::Input { row, column, value });
        }
        if let Some(row) = targets.iter().position(|value| !value.is_finite()) {
            let value = targets[row];
            return Err(GpError::Target { row, value });
        }
        Ok(Self { dim, inputs: inputs.to_vec(), targets: targets.to_vec() })
    }

    /// Number of inputs per sample.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.targets.len()
    }

    pub(crate) fn targets(&self) -> &[f64] {
        &self.targets
    }

    pub(crate) fn row(&self, i: usize) -> &[f64] {
        &self.inputs[i * self.dim..(i + 1) * self.dim]
    }

    /// The inputs divided by `lengths`, which has one entry per input.
    pub(crate) fn scaled(&self, lengths: &[f64]) -> Points {
        Points::new(self.samples(), self.dim, |i, d| self.row(i)[d] / lengths[d])
    }

    /// At most `count` samples, evenly distributed over the set.
    pub(crate) fn thinned(&self, count: usize) -> Self {
        let n = self.samples();
        let count = count.min(n);
        let rows: Vec<usize> = (0..count).map(|t| t * n / count).collect();
        Self {
            dim: self.dim,
            inputs: rows.iter().flat_map(|&i| self.row(i).iter().copied()).collect(),
            targets: rows.iter().map(|&i| self.targets[i]).collect(),
        }
    }

    /// These samples with targets divided by `divisor`.
    pub(crate) fn with_targets_divided(mut self, divisor: f64) -> Self {
        for target in &mut self.targets {
            *target /= divisor;
        }
        self
    }
}

/// Length scales, in the inputs' units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lengths {
    /// One length for all inputs.
    Isotropic(f64),
    /// One length per input ("automatic relevance determination").
    PerInput(Vec<f64>),
}

impl Lengths {
    /// The length of each of `dim` inputs.
    pub(crate) fn each(&self, dim: usize) -> Vec<f64> {
        match self {
            Self::Isotropic(length) => vec![*length; dim],
            Self::PerInput(lengths) => lengths.clone(),
        }
    }
}

/// Hyperparameters of the kernel amplitude² exp(-½ Σ_d ((x_d - x'_d) / length_d)²) and of the noise.
///
/// Source: Rasmussen and Williams 2006, eq. 5.1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hyperparameters {
    /// Standard deviation of the function, in the target's unit; positive.
    pub amplitude: f64,
    /// Length scales, in the inputs' units; positive.
    pub lengths: Lengths,
    /// Standard deviation of the noise on the targets, in the target's unit; not negative.
    pub noise: f64,
}

impl Hyperparameters {
    /// Checks the values against `dim` inputs.
    pub(crate) fn validate(&self, dim: usize) -> Result<(), GpError> {
        let positive = |name, value: f64| {
            let usable = value.is_normal() && value > 0.0 && value.recip().is_finite();
            let requirement = "positive and finite";
            usable.then_some(()).ok_or(GpError::OutOfRange { name, value, requirement })
        };
        positive("amplitude", self.amplitude)?;
        match &self.lengths {
            Lengths::Isotropic(length) => positive("length scale", *length)?,
            Lengths::PerInput(lengths) if lengths.len() != dim => {
                let given = lengths.len();
                return Err(GpError::Lengths { given, dim });
            }
            Lengths::PerInput(lengths) => {
                for length in lengths {
                    positive("length scale", *length)?;
                }
            }
        }
        if !(self.noise >= 0.0 && self.noise.is_finite()) {
            return Err(GpError::OutOfRange {
                name: "noise",
                value: self.noise,
                requirement: "finite and not negative",
            });
        }
        Ok(())
    }
}
