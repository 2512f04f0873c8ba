//! What predicts a residual that no effect explains.

/// What predicts the residual of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Regressor {
    /// The torque of the arm on its base.
    BaseMotion,
    /// The joint's past motion.
    History,
    /// The joint's load.
    Load,
    /// The motion of another joint.
    OtherJoint,
    /// The torque of another joint.
    OtherTorque,
    /// The joint's position.
    OwnPosition,
    /// The product of the joint's position and velocity.
    OwnPositionTimesSpeed,
    /// The joint's velocity.
    OwnSpeed,
    /// The scale of the joint's recorded position.
    PositionScale,
    /// Time.
    Time,
    /// The tool's position.
    ToolPosition,
    /// The tool's velocity.
    ToolVelocity,
}

impl Regressor {
    /// Its name in reports.
    pub fn code(self) -> &'static str {
        match self {
            Self::BaseMotion => "base_motion",
            Self::History => "history",
            Self::Load => "load",
            Self::OtherJoint => "other_joint",
            Self::OtherTorque => "other_torque",
            Self::OwnPosition => "own_position",
            Self::OwnPositionTimesSpeed => "own_position_times_speed",
            Self::OwnSpeed => "own_speed",
            Self::PositionScale => "position_scale",
            Self::Time => "time",
            Self::ToolPosition => "tool_position",
            Self::ToolVelocity => "tool_velocity",
        }
    }
}
