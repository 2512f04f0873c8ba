//! The quantities of a joint.

use serde::Serialize;

/// A quantity of a joint that is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Position.
    Position,
    /// Velocity.
    Velocity,
    /// Acceleration.
    Acceleration,
    /// Torque or force.
    Torque,
    /// The second encoder's position.
    SecondaryPosition,
    /// Torque computed from current.
    CurrentTorque,
    /// Motor current.
    Current,
    /// Temperature.
    Temperature,
}

impl Quantity {
    /// Whether every joint must have it.
    pub(crate) fn is_required(self) -> bool {
        matches!(self, Self::Position | Self::Torque)
    }

    /// The prefix of its columns, with the underscore.
    pub fn prefix(self) -> &'static str {
        match self {
            Self::Position => "q_",
            Self::Velocity => "qd_",
            Self::Acceleration => "qdd_",
            Self::Torque => "tau_",
            Self::SecondaryPosition => "q_secondary_",
            Self::CurrentTorque => "tau_current_",
            Self::Current => "current_",
            Self::Temperature => "temperature_",
        }
    }
}
