//! Places in files, for messages.

use std::fmt;

use serde::{Serialize, Serializer};

/// A place in a file: a line of text, a row of a file without lines, or a message of a bag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// The line, from 1.
    Line(u64),
    /// The row, from 1.
    Row(u64),
    /// The message of joint states, from 1, over all topics.
    Message(u64),
}

impl Location {
    /// The place as it is appended to the file's name.
    pub(crate) fn suffix(self) -> String {
        match self {
            Self::Line(line) => format!(":{line}"),
            Self::Row(_) | Self::Message(_) => format!(": {self}"),
        }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Row(row) => write!(f, "row {row}"),
            Self::Message(number) => write!(f, "joint-state message {number} of the bag"),
        }
    }
}

impl Serialize for Location {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (Self::Line(number) | Self::Row(number) | Self::Message(number)) = self;
        serializer.serialize_u64(*number)
    }
}
