//! Friction that differs in the held-out recordings.

use schemars::JsonSchema;
use serde::Serialize;

/// A joint whose friction in a held-out recording is a multiple of that in the training recordings, which explains most of its held-out
/// error.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct HeldOutFriction {
    /// The held-out recording.
    pub recording: String,
    /// The joint.
    pub joint: String,
    /// The friction over that in the training recordings.
    pub factor: f64,
}
