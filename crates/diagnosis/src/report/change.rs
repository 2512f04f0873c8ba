//! What changed since the recordings from before.

use schemars::JsonSchema;
use serde::Serialize;

/// A change since the recordings from before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// The effect is new.
    Added,
    /// The effect is in addition to one of the same kind that was there before.
    Increased,
    /// The effect is in the recordings from before only.
    Removed,
    /// The part of an effect of the same kind that is in the recordings from before only.
    Reduced,
}

impl Change {
    /// Whether it is in the recordings from before only.
    pub fn is_past(self) -> bool {
        matches!(self, Self::Removed | Self::Reduced)
    }
}
