//! The state against which an effect is drawn: the horizontal axis, and the sign that is applied to residuals.

use arm::{Arm, JointKind};
use diagnosis::{Dependence, Finding, Trace};
use effects::{Quantity, Regressor};

/// A quantity of the state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Against {
    Position,
    Speed,
    Acceleration,
    Time,
    /// The rigid model's torque.
    Load,
    /// Its absolute value; torques count along the motion.
    LoadAlong,
    /// Time; torques count along the motion.
    TimeAlong,
    /// The torque that the effect predicts, where no single state describes it.
    Predicted,
    /// The speed of another joint.
    OtherSpeed(usize),
}

impl Against {
    /// The state that shows `finding` best.
    pub fn of(finding: &Finding, arm: &Arm) -> Self {
        use effects::Against as Of;
        let spec = effects::spec(finding.effect);
        match spec.map_or(Of::Predicted, |spec| spec.against) {
            Of::Position => Self::Position,
            Of::Speed => Self::Speed,
            Of::Acceleration => Self::Acceleration,
            Of::Time => Self::Time,
            Of::TimeAlong => Self::TimeAlong,
            Of::Load => Self::Load,
            Of::LoadAlong => Self::LoadAlong,
            Of::OtherSpeed => {
                let other = finding.other.as_deref();
                let other = arm.joints().iter().position(|joint| Some(joint.name.as_str()) == other);
                other.map_or(Self::Predicted, Self::OtherSpeed)
            }
            Of::Predicted => Self::Predicted,
        }
    }

    /// The state that an unexplained residual depends on; `None` if it is not a single quantity.
    pub fn of_dependence(dependence: &Dependence, arm: &Arm) -> Option<Self> {
        match dependence.on {
            Regressor::OwnPosition => Some(Self::Position),
            Regressor::OwnSpeed => Some(Self::Speed),
            Regressor::Time => Some(Self::Time),
            Regressor::Load => Some(Self::Load),
            Regressor::OtherJoint => {
                let name = dependence.joint.as_ref()?;
                let joint = arm.joints().iter().position(|joint| joint.name == *name)?;
                Some(Self::OtherSpeed(joint))
            }
            Regressor::BaseMotion
            | Regressor::History
            | Regressor::OtherTorque
            | Regressor::OwnPositionTimesSpeed
            | Regressor::PositionScale
            | Regressor::ToolPosition
            | Regressor::ToolVelocity => None,
        }
    }

    /// Whether torques count along the motion.
    pub fn is_along(self) -> bool {
        matches!(self, Self::LoadAlong | Self::TimeAlong)
    }

    /// The words and the unit of the axis.
    pub fn title(self, arm: &Arm, joint: usize) -> (String, &'static str) {
        let kind = arm.joints()[joint].kind;
        let torque = match kind {
            JointKind::Revolute => "torque",
            JointKind::Prismatic => "force",
        };
        let (words, quantity) = match self {
            Self::Position => ("position".into(), Quantity::Position),
            Self::Speed => ("velocity".into(), Quantity::Speed),
            Self::Acceleration => ("acceleration".into(), Quantity::Acceleration),
            Self::Time | Self::TimeAlong => ("time".into(), Quantity::Time),
            Self::Load => (format!("model {torque}"), Quantity::Torque),
            Self::LoadAlong => (format!("model |{torque}|"), Quantity::Torque),
            Self::Predicted => (format!("{torque} predicted by the effect"), Quantity::Torque),
            Self::OtherSpeed(other) => {
                let other = &arm.joints()[other];
                return (format!("velocity of {}", other.name), Quantity::Speed.unit(other.kind));
            }
        };
        (words, quantity.unit(kind))
    }

    /// Its value at a row of a recording.
    pub fn value(self, trace: &Trace, joint: usize, row: usize) -> Option<f64> {
        let at = |series: &[Vec<f64>], joint: usize| series.get(joint)?.get(row).copied();
        let load = || Some(at(&trace.tau, joint)? - at(&trace.residual, joint)?);
        match self {
            Self::Position => at(&trace.q, joint),
            Self::Speed => at(&trace.qd, joint),
            Self::Acceleration => at(&trace.qdd, joint),
            Self::Time | Self::TimeAlong => trace.time.get(row).copied(),
            Self::Load => load(),
            Self::LoadAlong => load().map(f64::abs),
            Self::OtherSpeed(other) => at(&trace.qd, other),
            // The caller knows the torque of the effect.
            Self::Predicted => None,
        }
    }

    /// The factor applied to torques at a row: the sign of the velocity if torques count along the motion, one otherwise.
    pub fn turn(self, trace: &Trace, joint: usize, row: usize) -> f64 {
        if !self.is_along() {
            return 1.0;
        }
        let speed = trace.qd.get(joint).and_then(|series| series.get(row));
        speed.map_or(1.0, |speed| speed.signum())
    }
}
