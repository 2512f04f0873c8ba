//! Recordings with a load of their own.

use schemars::JsonSchema;
use serde::Serialize;

use super::Parameter;

/// A load at the tip that only some of the recordings have.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct DifferentLoad {
    /// These recordings, at most half of all.
    pub recordings: Vec<String>,
    /// The mass that they have more than the others; negative if they have less.
    pub more_than_others: Parameter,
}
