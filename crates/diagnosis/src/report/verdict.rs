//! The verdict.

use schemars::JsonSchema;
use serde::Serialize;

/// The diagnosis in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The model explains the recordings.
    NoMismatch,
    /// The findings explain the mismatch.
    Explained,
    /// The findings explain a part of the mismatch.
    PartlyExplained,
    /// There is no finding, and a mismatch remains.
    Unexplained,
    /// The recordings do not contain enough data.
    NotEnoughData,
    /// Units, signs, order or zeros of the recordings must be corrected first; no effect was searched.
    UnitsFirst,
}
