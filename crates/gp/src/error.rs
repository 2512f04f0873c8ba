//! The errors of this crate.

use std::path::PathBuf;

/// Errors of fitting, saving and loading.
#[derive(Debug, thiserror::Error)]
pub enum GpError {
    /// There are no samples, or the inputs have no dimension.
    #[error("no training data: {samples} samples of {dim} inputs")]
    Empty {
        /// Number of targets.
        samples: usize,
        /// Number of inputs per sample.
        dim: usize,
    },
    /// The length of the inputs is not samples × dimension.
    #[error("{values} input values for {samples} targets of {dim} inputs each: expected {}", samples * dim)]
    Shape {
        /// Number of input values.
        values: usize,
        /// Number of targets.
        samples: usize,
        /// Number of inputs per sample.
        dim: usize,
    },
    /// An input is infinite or not a number.
    #[error("input {column} of sample {row} is {value}: not a finite number")]
    Input {
        /// Index of the sample, from 0.
        row: usize,
        /// Index of the input, from 0.
        column: usize,
        /// The value.
        value: f64,
    },
    /// A target is infinite or not a number.
    #[error("target of sample {row} is {value}: not a finite number")]
    Target {
        /// Index of the sample, from 0.
        row: usize,
        /// The value.
        value: f64,
    },
    /// A hyperparameter or an option is out of range.
    #[error("{name} is {value}: it must be {requirement}")]
    OutOfRange {
        /// Its name.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The allowed values.
        requirement: &'static str,
    },
    /// The number of length scales is not the number of inputs.
    #[error("{given} length scales for {dim} inputs")]
    Lengths {
        /// Number of length scales given.
        given: usize,
        /// Number of inputs.
        dim: usize,
    },
    /// A list of hyperparameters is of another length than the joints require.
    #[error("{name} has {given} entries, expected {expected}")]
    Entries {
        /// Its name.
        name: &'static str,
        /// Number of entries given.
        given: usize,
        /// Number of entries for the joints.
        expected: usize,
    },
    /// The kernel matrix could not be factored, or the likelihood is not finite.
    #[error("the likelihood cannot be computed: {0}")]
    Likelihood(String),
    /// The optimisation library refused its settings.
    #[error("likelihood search: {0}")]
    Search(String),
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The reason given by the operating system.
        source: std::io::Error,
    },
    /// A file is not a saved model.
    #[error("{}: not a saved model: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The reason, with line and column if the text is malformed.
        reason: String,
    },
}
