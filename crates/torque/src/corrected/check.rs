//! What the parameters of an effect may be.

use arm::{Arm, Matrix3};

use crate::effect::Effect;
use crate::error::TorqueError;

const FINITE: &str = "finite";
const NOT_NEGATIVE: &str = "finite and not negative";
const POSITIVE: &str = "finite and positive";

/// A moment of inertia may be negative by this share of the largest, for rounding.
const ROUNDING: f64 = 1e-6;

/// The index of the joint `name` that `effect` is on.
pub(super) fn joint_of(arm: &Arm, effect: &Effect, name: &str) -> Result<usize, TorqueError> {
    let found = arm.joints().iter().position(|joint| joint.name == name);
    found.ok_or_else(|| TorqueError::UnknownJoint {
        effect: effect.name(),
        joint: name.to_owned(),
        known: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
    })
}

/// The tensor about the centre of mass that a payload's six numbers (Ixx Ixy Iyy Ixz Iyz Izz) say.
pub(super) fn tensor([xx, xy, yy, xz, yz, zz]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// Refuses parameters that no physics has.
pub(super) fn check(effect: &Effect) -> Result<(), TorqueError> {
    let refuse = |parameter: &'static str, value: f64, requirement: &'static str| {
        Err(TorqueError::Parameter {
            effect: effect.name(),
            joint: effect.joint().unwrap_or("the whole arm").to_owned(),
            parameter,
            value,
            requirement,
        })
    };
    let all = |values: &[(&'static str, f64)], requirement: &'static str| {
        let fits = |value: f64| match requirement {
            POSITIVE => value > 0.0,
            NOT_NEGATIVE => value >= 0.0,
            _ => true,
        };
        match values.iter().find(|(_, value)| !(value.is_finite() && fits(*value))) {
            Some(&(parameter, value)) => refuse(parameter, value, requirement),
            None => Ok(()),
        }
    };
    if let Some(onset) = effect.onset() {
        all(&[("onset", onset)], FINITE)?;
    }
    match *effect {
        Effect::ViscousFriction { coefficient, .. } | Effect::QuadraticDrag { coefficient, .. } => {
            all(&[("coefficient", coefficient)], NOT_NEGATIVE)
        }
        Effect::CoulombFriction { level, .. } => all(&[("level", level)], NOT_NEGATIVE),
        Effect::FrictionAsymmetry { positive, negative, .. } => {
            all(&[("positive", positive), ("negative", negative)], FINITE)?;
            if positive + negative < 0.0 {
                return refuse("positive + negative", positive + negative, NOT_NEGATIVE);
            }
            Ok(())
        }
        Effect::StribeckFriction {
            coulomb,
            breakaway,
            velocity,
            exponent,
            ..
        } => {
            all(&[("coulomb", coulomb), ("breakaway", breakaway)], NOT_NEGATIVE)?;
            all(&[("velocity", velocity), ("exponent", exponent)], POSITIVE)
        }
        Effect::LoadDependentFriction { coulomb, gain, .. } => {
            all(&[("coulomb", coulomb), ("gain", gain)], NOT_NEGATIVE)
        }
        Effect::ThermalDrift {
            coulomb,
            amplitude,
            time_constant,
            ..
        } => {
            all(&[("coulomb", coulomb)], NOT_NEGATIVE)?;
            all(&[("time_constant", time_constant)], POSITIVE)?;
            if !(amplitude.is_finite() && amplitude >= -1.0) {
                return refuse("amplitude", amplitude, "finite and at least -1");
            }
            Ok(())
        }
        Effect::RotorInertia { inertia, .. } => all(&[("inertia", inertia)], NOT_NEGATIVE),
        Effect::TorqueScale { factor, .. } | Effect::InertialScale { factor } => all(&[("factor", factor)], POSITIVE),
        Effect::TorqueOffset { offset, .. } | Effect::EncoderOffset { offset, .. } => {
            all(&[("offset", offset)], FINITE)
        }
        Effect::TorqueRipple {
            amplitude,
            periods,
            phase,
            ..
        } => all(
            &[("amplitude", amplitude), ("periods", periods), ("phase", phase)],
            FINITE,
        ),
        Effect::TorqueSaturation { limit, .. } => all(&[("limit", limit)], POSITIVE),
        Effect::ActuationDelay { delay, .. } => all(&[("delay", delay)], NOT_NEGATIVE),
        Effect::JointElasticity { stiffness, damping, .. } => {
            all(&[("stiffness", stiffness)], POSITIVE)?;
            all(&[("damping", damping)], NOT_NEGATIVE)
        }
        Effect::Backlash { halfgap, .. } => all(&[("halfgap", halfgap)], NOT_NEGATIVE),
        Effect::TransmissionCoupling {
            viscous,
            coulomb,
            inertia,
            ..
        } => all(
            &[("viscous", viscous), ("coulomb", coulomb), ("inertia", inertia)],
            FINITE,
        ),
        Effect::Payload { mass, com, inertia, .. } => {
            all(&[("mass", mass)], NOT_NEGATIVE)?;
            all(&com.map(|value| ("com", value)), FINITE)?;
            all(&inertia.map(|value| ("inertia", value)), FINITE)?;
            let moments = tensor(inertia).symmetric_eigenvalues();
            if moments.min() < -ROUNDING * moments.amax() {
                return refuse("inertia's smallest principal moment", moments.min(), NOT_NEGATIVE);
            }
            Ok(())
        }
        Effect::LinkInertialError { relative, .. } => {
            if !(relative.is_finite() && relative > -1.0) {
                return refuse("relative", relative, "finite and above -1");
            }
            Ok(())
        }
        Effect::GravityMisalignment { angle, axis } => {
            all(&[("angle", angle)], FINITE)?;
            all(&axis.map(|value| ("axis", value)), FINITE)?;
            let length = axis.iter().map(|value| value * value).sum::<f64>().sqrt();
            all(&[("axis' length", length)], POSITIVE)
        }
        Effect::Spring {
            stiffness,
            rest,
            ref curve,
            ..
        } => {
            all(&[("stiffness", stiffness), ("rest", rest)], FINITE)?;
            for &[angle, torque] in curve {
                all(&[("curve", angle), ("curve", torque)], FINITE)?;
            }
            match curve.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
                Some(pair) => refuse("curve's next angle", pair[1][0], "larger than the one before"),
                None => Ok(()),
            }
        }
        Effect::ExternalContact { start, duration, force } => {
            all(&[("start", start)], FINITE)?;
            all(&[("duration", duration)], POSITIVE)?;
            all(&force.map(|value| ("force", value)), FINITE)
        }
    }
}
