//! The catalogue of effects that a rigid model leaves out, as data.

use serde::{Deserialize, Serialize};

/// One effect with its parameters in SI units at the joint; a joint is named as in the URDF.
///
/// For a prismatic joint read N for N m and m for rad. The torque τ is what the effect adds to the torque
/// that the motion needs (measured less rigid).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "effect", rename_all = "snake_case", deny_unknown_fields)]
pub enum Effect {
    /// τ = coefficient q̇ (N m s/rad).
    ViscousFriction {
        /// The joint.
        joint: String,
        /// N m s/rad.
        coefficient: f64,
    },
    /// τ = level sgn q̇.
    CoulombFriction {
        /// The joint.
        joint: String,
        /// N m.
        level: f64,
    },
    /// τ = positive while q̇ > 0, −negative while q̇ < 0.
    FrictionAsymmetry {
        /// The joint.
        joint: String,
        /// N m, of motion in the positive direction.
        positive: f64,
        /// N m, of motion in the negative direction.
        negative: f64,
    },
    /// τ = (coulomb + (breakaway − coulomb) e^(−|q̇/velocity|^exponent)) sgn q̇.
    StribeckFriction {
        /// The joint.
        joint: String,
        /// N m, at speed.
        coulomb: f64,
        /// N m, at the lowest speeds.
        breakaway: f64,
        /// rad/s.
        velocity: f64,
        /// 1 or 2 in the literature.
        #[serde(default = "two")]
        exponent: f64,
    },
    /// τ = (coulomb + gain |τ rigid|) sgn q̇.
    LoadDependentFriction {
        /// The joint.
        joint: String,
        /// N m, without load.
        coulomb: f64,
        /// N m of friction a N m of load.
        gain: f64,
    },
    /// Dry friction coulomb (1 + amplitude e^(−t/time_constant)) sgn q̇, t on the recordings' own clock.
    ThermalDrift {
        /// The joint.
        joint: String,
        /// N m, when warm.
        coulomb: f64,
        /// As a share of the warm level.
        amplitude: f64,
        /// s.
        time_constant: f64,
    },
    /// τ = coefficient |q̇|^exponent sgn q̇.
    QuadraticDrag {
        /// The joint.
        joint: String,
        /// N m s²/rad², if the exponent is 2.
        coefficient: f64,
        /// 2 for turbulent drag; other losses that grow faster than the speed lie about it.
        #[serde(default = "two")]
        exponent: f64,
        /// s, on the recordings' own clock; before it there is none of it. `None`: always.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        onset: Option<f64>,
    },
    /// τ = inertia q̈: the drive's rotor, seen at the joint.
    RotorInertia {
        /// The joint.
        joint: String,
        /// kg m².
        inertia: f64,
    },
    /// The torque measured is factor × the true one.
    TorqueScale {
        /// The joint.
        joint: String,
        /// Without unit.
        factor: f64,
        /// s, on the recordings' own clock; before it there is none of it. `None`: always.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        onset: Option<f64>,
    },
    /// τ = offset.
    TorqueOffset {
        /// The joint.
        joint: String,
        /// N m.
        offset: f64,
        /// s, on the recordings' own clock; before it there is none of it. `None`: always.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        onset: Option<f64>,
    },
    /// τ = amplitude sin(periods q + phase).
    TorqueRipple {
        /// The joint.
        joint: String,
        /// N m.
        amplitude: f64,
        /// Periods a turn (a radian's worth of phase a radian of joint).
        periods: f64,
        /// rad.
        phase: f64,
    },
    /// The torque applied is the commanded one, clipped at ± limit.
    TorqueSaturation {
        /// The joint.
        joint: String,
        /// N m.
        limit: f64,
    },
    /// The torque applied at t is the one commanded at t − delay.
    ActuationDelay {
        /// The joint.
        joint: String,
        /// s.
        delay: f64,
    },
    /// The rotor drives the link through a spring and a damper; q is the rotor's.
    JointElasticity {
        /// The joint.
        joint: String,
        /// N m/rad.
        stiffness: f64,
        /// N m s/rad.
        damping: f64,
    },
    /// The rotor drives the link through a gap of ± halfgap; q is the rotor's.
    Backlash {
        /// The joint.
        joint: String,
        /// rad.
        halfgap: f64,
    },
    /// A drive that two joints turn, and its reaction: on each of the two, with o the other of them,
    /// τ = viscous q̇ₒ + coulomb sgn(q̇ + sense q̇ₒ) + inertia q̈ₒ.
    TransmissionCoupling {
        /// The joint.
        joint: String,
        /// The joint whose motion turns this one's drive.
        other: String,
        /// N m s/rad.
        viscous: f64,
        /// N m.
        #[serde(default)]
        coulomb: f64,
        /// kg m².
        #[serde(default)]
        inertia: f64,
        /// 1 if the drive turns with the sum of the joints, −1 if with their difference.
        #[serde(default = "one")]
        sense: f64,
    },
    /// A body fixed to the tool.
    Payload {
        /// kg.
        mass: f64,
        /// Centre of mass in the tool's frame (m).
        com: [f64; 3],
        /// Ixx Ixy Iyy Ixz Iyz Izz about the centre of mass, along the tool's axes (kg m²).
        #[serde(default)]
        inertia: [f64; 6],
        /// s, on the recordings' own clock; before it the tool is empty. `None`: always.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        onset: Option<f64>,
    },
    /// The mass and inertia of the link that `joint` carries are (1 + relative) × the model's.
    LinkInertialError {
        /// The joint.
        joint: String,
        /// Without unit.
        relative: f64,
    },
    /// All masses and inertias are factor × the model's.
    InertialScale {
        /// Without unit.
        factor: f64,
    },
    /// The base is turned by `angle` about `axis` (unit, in the base's frame): gravity points elsewhere.
    GravityMisalignment {
        /// rad.
        angle: f64,
        /// Unit vector.
        axis: [f64; 3],
    },
    /// The encoder says offset more than where the joint stands.
    EncoderOffset {
        /// The joint.
        joint: String,
        /// rad.
        offset: f64,
    },
    /// τ = stiffness (q − rest); or a curve through (q, τ) points where it bends.
    Spring {
        /// The joint.
        joint: String,
        /// N m/rad.
        stiffness: f64,
        /// rad.
        rest: f64,
        /// Points (rad, N m), by angle; linear between, constant beyond. Empty: the straight line.
        #[serde(default)]
        curve: Vec<[f64; 2]>,
        /// s, on the recordings' own clock; before it there is none of it. `None`: always.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        onset: Option<f64>,
    },
    /// A force on the tool for a while: τ = −Jᵀ F.
    ExternalContact {
        /// s, on the recordings' own clock.
        start: f64,
        /// s.
        duration: f64,
        /// N, in the base's frame.
        force: [f64; 3],
    },
}

fn two() -> f64 {
    2.0
}

fn one() -> f64 {
    1.0
}

impl Effect {
    /// The catalogue's name of the effect.
    pub fn name(&self) -> &'static str {
        match self {
            Self::ViscousFriction { .. } => "viscous_friction",
            Self::CoulombFriction { .. } => "coulomb_friction",
            Self::FrictionAsymmetry { .. } => "friction_asymmetry",
            Self::StribeckFriction { .. } => "stribeck_friction",
            Self::LoadDependentFriction { .. } => "load_dependent_friction",
            Self::ThermalDrift { .. } => "thermal_drift",
            Self::QuadraticDrag { .. } => "quadratic_drag",
            Self::RotorInertia { .. } => "rotor_inertia",
            Self::TorqueScale { .. } => "torque_scale",
            Self::TorqueOffset { .. } => "torque_offset",
            Self::TorqueRipple { .. } => "torque_ripple",
            Self::TorqueSaturation { .. } => "torque_saturation",
            Self::ActuationDelay { .. } => "actuation_delay",
            Self::JointElasticity { .. } => "joint_elasticity",
            Self::Backlash { .. } => "backlash",
            Self::TransmissionCoupling { .. } => "transmission_coupling",
            Self::Payload { .. } => "payload",
            Self::LinkInertialError { .. } => "link_inertial_error",
            Self::InertialScale { .. } => "inertial_scale",
            Self::GravityMisalignment { .. } => "gravity_misalignment",
            Self::EncoderOffset { .. } => "encoder_offset",
            Self::Spring { .. } => "spring",
            Self::ExternalContact { .. } => "external_contact",
        }
    }

    /// When it sets in (s, on the recordings' own clock); `None` if it always acts.
    pub fn onset(&self) -> Option<f64> {
        match self {
            Self::QuadraticDrag { onset, .. }
            | Self::TorqueScale { onset, .. }
            | Self::Payload { onset, .. }
            | Self::TorqueOffset { onset, .. }
            | Self::Spring { onset, .. } => *onset,
            _ => None,
        }
    }

    /// The joint it is on; `None` for the whole arm.
    pub fn joint(&self) -> Option<&str> {
        match self {
            Self::Payload { .. }
            | Self::InertialScale { .. }
            | Self::GravityMisalignment { .. }
            | Self::ExternalContact { .. } => None,
            Self::ViscousFriction { joint, .. }
            | Self::CoulombFriction { joint, .. }
            | Self::FrictionAsymmetry { joint, .. }
            | Self::StribeckFriction { joint, .. }
            | Self::LoadDependentFriction { joint, .. }
            | Self::ThermalDrift { joint, .. }
            | Self::QuadraticDrag { joint, .. }
            | Self::RotorInertia { joint, .. }
            | Self::TorqueScale { joint, .. }
            | Self::TorqueOffset { joint, .. }
            | Self::TorqueRipple { joint, .. }
            | Self::TorqueSaturation { joint, .. }
            | Self::ActuationDelay { joint, .. }
            | Self::JointElasticity { joint, .. }
            | Self::Backlash { joint, .. }
            | Self::TransmissionCoupling { joint, .. }
            | Self::LinkInertialError { joint, .. }
            | Self::EncoderOffset { joint, .. }
            | Self::Spring { joint, .. } => Some(joint),
        }
    }
}
