//! SI units at a joint.

use arm::JointKind;

/// The units of one kind of joint.
pub struct Units {
    /// Of a torque.
    pub torque: &'static str,
    /// Of a position.
    pub position: &'static str,
    /// Of a speed.
    pub speed: &'static str,
    /// Of a damping.
    pub damping: &'static str,
    /// Of a drag.
    pub drag: &'static str,
    /// Of a inertia.
    pub inertia: &'static str,
    /// Of a stiffness.
    pub stiffness: &'static str,
}

impl Units {
    /// Of a kind of joint.
    pub fn of(kind: JointKind) -> Self {
        match kind {
            JointKind::Revolute => Self {
                torque: "N m",
                position: "rad",
                speed: "rad/s",
                damping: "N m s/rad",
                drag: "N m s²/rad²",
                inertia: "kg m²",
                stiffness: "N m/rad",
            },
            JointKind::Prismatic => Self {
                torque: "N",
                position: "m",
                speed: "m/s",
                damping: "N s/m",
                drag: "N s²/m²",
                inertia: "kg",
                stiffness: "N/m",
            },
        }
    }
}
