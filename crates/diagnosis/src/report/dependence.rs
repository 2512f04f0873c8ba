//! What predicts an unexplained residual, and the quantities in whose regions residuals are located.

use std::fmt;

use effects::Regressor;
use serde::{Serialize, Serializer};

/// What predicts a joint's unexplained residual; written `own_position`, `other_joint:NAME`, …
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Dependence {
    /// The kind of quantity.
    pub on: Regressor,
    /// The other joint, for [`Regressor::OtherJoint`] and [`Regressor::OtherTorque`].
    pub joint: Option<String>,
}

impl From<Regressor> for Dependence {
    fn from(on: Regressor) -> Self {
        Self { on, joint: None }
    }
}

impl fmt::Display for Dependence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.on.code())?;
        match &self.joint {
            Some(joint) => write!(f, ":{joint}"),
            None => Ok(()),
        }
    }
}

impl Serialize for Dependence {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// A quantity of a joint's state in whose regions its residual is located.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// The absolute velocity, near zero (rad/s or m/s).
    NearReversal,
    /// The velocity (rad/s or m/s).
    Speed,
    /// The load (N m or N).
    Load,
    /// The position (rad or m).
    Angle,
    /// The time since the first recording's start (s).
    ElapsedTime,
}

impl Axis {
    /// What predicts a residual that is largest in a region of this quantity.
    pub fn regressor(self) -> Regressor {
        match self {
            Self::NearReversal | Self::Speed => Regressor::OwnSpeed,
            Self::Load => Regressor::Load,
            Self::Angle => Regressor::OwnPosition,
            Self::ElapsedTime => Regressor::Time,
        }
    }
}
