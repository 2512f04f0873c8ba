//! What contradicts the URDF in a recording.

use schemars::JsonSchema;
use serde::Serialize;

/// A doubt about a recording that contradicts the robot's URDF as it was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Doubt {
    /// The recording, with the name that the user gave.
    pub recording: String,
    /// The joint, or `None` if the doubt concerns all joints that move.
    pub joint: Option<String>,
    /// What is wrong, and the remedy.
    pub text: String,
    /// The complete column map (TOML) that corrects it, if a column map can.
    pub column_map: Option<String>,
}
