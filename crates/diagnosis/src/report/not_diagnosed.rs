//! Joints that are not diagnosed.

use schemars::JsonSchema;
use serde::Serialize;

/// Joints that are not diagnosed, although they move: their torque channels hold no usable torque.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct NotDiagnosed {
    /// The joints.
    pub joints: Vec<String>,
    /// The reason, and the remedy, as a clause.
    pub because: String,
}
