//! The quantity that a number measures, and its SI unit at a joint.

use arm::JointKind;

/// The quantity of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A torque; for a prismatic joint, a force.
    Torque,
    /// A joint's position.
    Position,
    /// A joint's speed.
    Speed,
    /// A joint's acceleration.
    Acceleration,
    /// Torque per speed.
    Damping,
    /// Torque per squared speed.
    Drag,
    /// Torque per acceleration.
    Inertia,
    /// Torque per position.
    Stiffness,
    /// A number without unit.
    Ratio,
    /// An angle that belongs to no joint.
    Angle,
    /// A time.
    Time,
    /// A mass.
    Mass,
    /// A length.
    Length,
    /// A force on the tool.
    Force,
}

impl Quantity {
    /// Whether it is proportional to the recorded torque, so that it is no better known than the torque constants.
    pub fn scales_with_torque(self) -> bool {
        match self {
            Self::Torque | Self::Damping | Self::Drag | Self::Inertia | Self::Stiffness | Self::Mass | Self::Force => {
                true
            }
            Self::Position
            | Self::Speed
            | Self::Acceleration
            | Self::Ratio
            | Self::Angle
            | Self::Time
            | Self::Length => false,
        }
    }

    /// The SI unit at a joint of `kind`; `"1"` for a number without unit.
    pub fn unit(self, kind: JointKind) -> &'static str {
        let either = |turning, sliding| match kind {
            JointKind::Revolute => turning,
            JointKind::Prismatic => sliding,
        };
        match self {
            Self::Torque => either("N m", "N"),
            Self::Position => either("rad", "m"),
            Self::Speed => either("rad/s", "m/s"),
            Self::Acceleration => either("rad/s²", "m/s²"),
            Self::Damping => either("N m s/rad", "N s/m"),
            Self::Drag => either("N m s²/rad²", "N s²/m²"),
            Self::Inertia => either("kg m²", "kg"),
            Self::Stiffness => either("N m/rad", "N/m"),
            Self::Ratio => "1",
            Self::Angle => "rad",
            Self::Time => "s",
            Self::Mass => "kg",
            Self::Length => "m",
            Self::Force => "N",
        }
    }
}
