//! The recordings of a report.

use schemars::JsonSchema;
use serde::Serialize;

/// Paths as given on the command line.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct RecordingNames {
    /// Training recordings, to which the effects are fitted, with those from before.
    pub train: Vec<String>,
    /// The training recordings that are from before something happened (`--before`).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub before: Vec<String>,
    /// Held-out recordings, to which nothing is fitted.
    pub held_out: Vec<String>,
    /// Long recordings of which windows are used; absent if all recordings are used whole.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub used_in_part: Vec<UsedPart>,
}

/// The part of a long recording that is used.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct UsedPart {
    /// The recording, with the name that the user gave.
    pub recording: String,
    /// The time that is used (s), to a millisecond: windows that are spread evenly over the whole.
    pub used_seconds: f64,
    /// The time that was recorded (s), to a millisecond, without pauses.
    pub of_seconds: f64,
}
