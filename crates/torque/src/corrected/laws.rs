//! The torque that an effect puts on one joint, as a function of motion and time.

use crate::effect::Effect;

/// −1, 0 or 1: the sign of a velocity, nothing at rest.
pub(super) fn sign(velocity: f64) -> f64 {
    if velocity == 0.0 { 0.0 } else { velocity.signum() }
}

/// Friction whose direction is that of the joint's velocity and whose level varies slowly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Dry {
    Coulomb {
        level: f64,
    },
    Asymmetric {
        positive: f64,
        negative: f64,
    },
    Stribeck {
        coulomb: f64,
        breakaway: f64,
        velocity: f64,
        exponent: f64,
    },
    Loaded {
        coulomb: f64,
        gain: f64,
    },
    Drifting {
        coulomb: f64,
        amplitude: f64,
        time_constant: f64,
    },
}

/// When and under which load friction acts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circumstance {
    /// s on the recordings' own clock; `None` is long after (warm).
    pub time: Option<f64>,
    /// The rigid torque of the joint (N m or N).
    pub load: f64,
}

impl Dry {
    /// The most that it resists at a velocity (N m or N), on the average of both directions.
    pub(super) fn level(&self, qd: f64, at: Circumstance) -> f64 {
        match *self {
            Self::Coulomb { level } => level,
            Self::Asymmetric { positive, negative } => 0.5 * (positive + negative),
            Self::Stribeck {
                coulomb,
                breakaway,
                velocity,
                exponent,
            } => {
                let fading = (-(qd.abs() / velocity).powf(exponent)).exp();
                coulomb + (breakaway - coulomb) * fading
            }
            Self::Loaded { coulomb, gain } => coulomb + gain * at.load.abs(),
            Self::Drifting {
                coulomb,
                amplitude,
                time_constant,
            } => {
                let cold = at.time.map_or(0.0, |time| (-time / time_constant).exp());
                coulomb * (1.0 + amplitude * cold)
            }
        }
    }

    /// Whether the load matters.
    pub(super) fn depends_on_load(&self) -> bool {
        matches!(self, Self::Loaded { .. })
    }

    /// What it adds in both directions alike (N m or N): friction that differs by direction is a level and an offset.
    pub(super) fn bias(&self) -> f64 {
        match *self {
            Self::Asymmetric { positive, negative } => 0.5 * (positive - negative),
            _ => 0.0,
        }
    }
}

/// A torque on one joint, smooth in its own velocity.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Smooth {
    Viscous {
        coefficient: f64,
    },
    Drag {
        coefficient: f64,
        exponent: f64,
    },
    Offset {
        offset: f64,
    },
    Ripple {
        amplitude: f64,
        periods: f64,
        phase: f64,
    },
    Spring {
        stiffness: f64,
        rest: f64,
    },
    Curve {
        points: Vec<[f64; 2]>,
    },
    Coupling {
        other: usize,
        viscous: f64,
        coulomb: f64,
        inertia: f64,
        sense: f64,
    },
}

impl Smooth {
    /// The torque on `joint` (N m or N) in the motion of all joints.
    pub(super) fn torque(&self, joint: usize, q: &[f64], qd: &[f64], qdd: &[f64]) -> f64 {
        match self {
            Self::Viscous { coefficient } => coefficient * qd[joint],
            Self::Drag { coefficient, exponent } => coefficient * qd[joint].abs().powf(*exponent).copysign(qd[joint]),
            Self::Offset { offset } => *offset,
            Self::Ripple {
                amplitude,
                periods,
                phase,
            } => amplitude * (periods * q[joint] + phase).sin(),
            Self::Spring { stiffness, rest } => stiffness * (q[joint] - rest),
            Self::Curve { points } => interpolate(points, q[joint]),
            &Self::Coupling {
                other,
                viscous,
                coulomb,
                inertia,
                sense,
            } => viscous * qd[other] + coulomb * sign(qd[joint] + sense * qd[other]) + inertia * qdd[other],
        }
    }
}

/// Linear between points in order of their first number, constant beyond; 0 without points.
fn interpolate(points: &[[f64; 2]], x: f64) -> f64 {
    let after = points.partition_point(|point| point[0] <= x);
    match (after.checked_sub(1).map(|before| points[before]), points.get(after)) {
        (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some([_, y]), None) | (None, Some(&[_, y])) => y,
        (None, None) => 0.0,
    }
}

/// What an effect is to a joint.
pub(super) enum Law {
    Dry(Dry),
    Smooth(Smooth),
}

/// The law of an effect that adds a torque to its joint; `None` for the others. `other` is the other joint of a coupling.
pub(super) fn law(effect: &Effect, other: Option<usize>) -> Option<Law> {
    Some(match *effect {
        Effect::CoulombFriction { level, .. } => Law::Dry(Dry::Coulomb { level }),
        Effect::FrictionAsymmetry { positive, negative, .. } => Law::Dry(Dry::Asymmetric { positive, negative }),
        Effect::StribeckFriction {
            coulomb,
            breakaway,
            velocity,
            exponent,
            ..
        } => Law::Dry(Dry::Stribeck {
            coulomb,
            breakaway,
            velocity,
            exponent,
        }),
        Effect::LoadDependentFriction { coulomb, gain, .. } => Law::Dry(Dry::Loaded { coulomb, gain }),
        Effect::ThermalDrift {
            coulomb,
            amplitude,
            time_constant,
            ..
        } => Law::Dry(Dry::Drifting {
            coulomb,
            amplitude,
            time_constant,
        }),
        Effect::ViscousFriction { coefficient, .. } => Law::Smooth(Smooth::Viscous { coefficient }),
        Effect::QuadraticDrag {
            coefficient, exponent, ..
        } => Law::Smooth(Smooth::Drag { coefficient, exponent }),
        Effect::TorqueOffset { offset, .. } => Law::Smooth(Smooth::Offset { offset }),
        Effect::TorqueRipple {
            amplitude,
            periods,
            phase,
            ..
        } => Law::Smooth(Smooth::Ripple {
            amplitude,
            periods,
            phase,
        }),
        Effect::Spring {
            stiffness,
            rest,
            ref curve,
            ..
        } => Law::Smooth(if curve.is_empty() {
            Smooth::Spring { stiffness, rest }
        } else {
            Smooth::Curve { points: curve.clone() }
        }),
        Effect::TransmissionCoupling {
            viscous,
            coulomb,
            inertia,
            sense,
            ..
        } => Law::Smooth(Smooth::Coupling {
            other: other?,
            viscous,
            coulomb,
            inertia,
            sense,
        }),
        _ => return None,
    })
}
