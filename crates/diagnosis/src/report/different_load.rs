//! Recordings with a load of their own.

use schemars::JsonSchema;
use serde::Serialize;

use super::Parameter;

/// A load at the tip that only some of the recordings have.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct DifferentLoad {
    /// These recordings: at most half of all, or those that begin before `until`.
    pub recordings: Vec<String>,
    /// The time at which it was put down within the last of them (s, on their common clock); `None` if they have it to their ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until: Option<f64>,
    /// The mass that they have more than the others; negative if they have less.
    pub more_than_others: Parameter,
}
