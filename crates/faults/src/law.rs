//! The functional forms of what can be concealed on a joint, as data: torques (N m or N) that the motion costs on top of the
//! rigid ones.
//!
//! They are this crate's own: a diagnosis is to find the cause, not its own formula.

/// What a law may depend on, of the whole arm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct At<'a> {
    /// s, on the recordings' clock.
    pub time: f64,
    /// The joint that the law is on.
    pub joint: usize,
    /// Positions of all joints (rad or m).
    pub q: &'a [f64],
    /// Velocities of all joints.
    pub qd: &'a [f64],
}

/// A part of a joint's dry friction.
#[derive(Clone, Debug)]
pub(crate) enum Dry {
    /// The same at every speed.
    Level(f64),
    /// More forwards and as much less backwards.
    Tilt(f64),
    /// More at low speed: extra e^(−|v/velocity|^exponent).
    Fading { extra: f64, velocity: f64, exponent: f64 },
    /// More under load.
    Loaded { gain: f64, of: Load },
    /// All the rest times (1 + amplitude × cooling).
    Warming {
        amplitude: f64,
        time_constant: f64,
        cooling: Cooling,
    },
}

/// Which load friction feels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Load {
    /// The rigid torque.
    Rigid,
    /// What the drive gives, behind a low-pass filter of 20 ms.
    Drive,
}

/// How something warms up, from 1 at time 0 to 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cooling {
    /// e^(−t/T).
    Exponential,
    /// 1 / (1 + t/T).
    Hyperbolic,
    /// e^(−(t/T)^.7).
    Stretched,
}

impl Cooling {
    fn at(self, x: f64) -> f64 {
        let x = x.max(0.0);
        match self {
            Self::Exponential => (-x).exp(),
            Self::Hyperbolic => 1.0 / (1.0 + x),
            Self::Stretched => (-x.powf(0.7)).exp(),
        }
    }
}

/// Dry friction at a moment: ± `level`, and `bias` in both directions alike (N m or N).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Resistance {
    pub level: f64,
    pub bias: f64,
}

/// The dry friction that its parts make at velocity `v`; `loads` are those of [`Load::Rigid`] and [`Load::Drive`].
pub(crate) fn resistance<'a>(parts: impl Iterator<Item = &'a Dry>, v: f64, time: f64, loads: [f64; 2]) -> Resistance {
    let (mut level, mut bias, mut factor) = (0.0, 0.0, 1.0);
    for part in parts {
        match *part {
            Dry::Level(value) => level += value,
            Dry::Tilt(value) => bias += value,
            Dry::Fading {
                extra,
                velocity,
                exponent,
            } => level += extra * (-(v.abs() / velocity).powf(exponent)).exp(),
            Dry::Loaded { gain, of } => level += gain * loads[usize::from(of == Load::Drive)].abs(),
            Dry::Warming {
                amplitude,
                time_constant,
                cooling,
            } => factor *= 1.0 + amplitude * cooling.at(time / time_constant),
        }
    }
    // Asymmetry beyond the level would push, and a Stribeck dip or a cold drive below nothing too.
    let level = (level * factor).max(0.0);
    Resistance {
        level,
        bias: (bias * factor).clamp(-level, level),
    }
}

/// A torque on the drive's side of a joint, smooth or nearly so.
#[derive(Clone, Debug)]
pub(crate) enum Smooth {
    /// coefficient sgn(v) |v|^exponent.
    Power { coefficient: f64, exponent: f64 },
    /// A constant.
    Offset(f64),
    /// amplitude (sin x + second sin(2 x + 1.3 phase)), x = periods q + phase.
    Ripple {
        amplitude: f64,
        periods: f64,
        phase: f64,
        second: f64,
    },
}

impl Smooth {
    /// The torque at the drive's own position and velocity.
    pub(crate) fn torque(&self, q: f64, v: f64) -> f64 {
        match *self {
            Self::Power { coefficient, exponent } => {
                let size = if exponent == 1.0 {
                    v.abs()
                } else {
                    v.abs().powf(exponent)
                };
                coefficient * v.signum() * size
            }
            Self::Offset(offset) => offset,
            Self::Ripple {
                amplitude,
                periods,
                phase,
                second,
            } => {
                let x = periods * q + phase;
                amplitude * (x.sin() + second * (2.0 * x + 1.3 * phase).sin())
            }
        }
    }
}

/// How a spring bends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Bend {
    /// Not at all.
    Straight,
    /// Softer away from its rest, as a gas spring over its crank: x becomes .45 tanh(x/.45).
    Gas,
    /// Stiffer away from its rest: x (1 + .6 x²).
    Hardening,
    /// Two slopes: .25 tanh(x/.25) + .5 x.
    Knee,
}

/// A torque on the link's side of a joint; some remember, in one number of state.
#[derive(Clone, Debug)]
pub(crate) enum Link {
    /// A spring.
    Spring { stiffness: f64, rest: f64, bend: Bend },
    /// Through points (position, torque) in order; constant beyond.
    Curve(Vec<[f64; 2]>),
    /// Another joint's motion turns this one's drive; its inertia is the machine's affair.
    Coupling {
        other: usize,
        viscous: f64,
        coulomb: f64,
        sense: f64,
    },
    /// A wave along another joint's position.
    OtherWave {
        amplitude: f64,
        other: usize,
        rate: f64,
        phase: f64,
    },
    /// A step along another joint's position, felt where this one is near zero.
    OtherStep {
        amplitude: f64,
        other: usize,
        rate: f64,
        center: f64,
    },
    /// A periodic torque; squarer with a larger `edge` (0: a sine).
    Periodic {
        amplitude: f64,
        hertz: f64,
        phase: f64,
        edge: f64,
    },
    /// A torque within a band of positions only; `round` is a Gaussian instead of a plateau.
    Band {
        amplitude: f64,
        center: f64,
        width: f64,
        round: bool,
    },
    /// Hysteresis in position (Bouc 1967, Wen 1976): slope 1/scale, `shape` .5 to 1, sharpness 1 or 2.
    Hysteresis {
        amplitude: f64,
        scale: f64,
        shape: f64,
        sharpness: i32,
    },
    /// Something of another joint's velocity.
    OtherVelocity {
        amplitude: f64,
        other: usize,
        of: OtherVelocity,
    },
    /// Something of this joint's own past, through a low-pass filter.
    History {
        amplitude: f64,
        time_constant: f64,
        of: Past,
    },
    /// A wandering torque: values every hundredth of a second from time 0.
    Walk { amplitude: f64, values: Vec<f64> },
    /// Velocity times a wave of position.
    VelocityWave { amplitude: f64, rate: f64, phase: f64 },
    /// Speed times position.
    SpeedPosition { amplitude: f64, center: f64 },
}

/// What of another joint's velocity is felt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum OtherVelocity {
    /// v |v|.
    Signed,
    /// v².
    Square,
    /// tanh(v / this).
    Saturating(f64),
}

/// What of a joint's past is felt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Past {
    /// |v|, low-passed.
    Speed,
    /// v |v|, low-passed.
    SignedSquare,
    /// Position, low-passed, less position.
    Position,
}

impl Link {
    /// The torque, and the state a `step` (s) later.
    pub(crate) fn torque(&self, at: At<'_>, state: &mut f64, step: f64) -> f64 {
        let (q, v) = (at.q[at.joint], at.qd[at.joint]);
        match *self {
            Self::Spring { stiffness, rest, bend } => {
                let x = q - rest;
                stiffness
                    * match bend {
                        Bend::Straight => x,
                        Bend::Gas => 0.45 * (x / 0.45).tanh(),
                        Bend::Hardening => x * (1.0 + 0.6 * x * x),
                        Bend::Knee => 0.25 * (x / 0.25).tanh() + 0.5 * x,
                    }
            }
            Self::Curve(ref points) => interpolate(points, q),
            Self::Coupling {
                other,
                viscous,
                coulomb,
                sense,
            } => {
                let slip = v + sense * at.qd[other];
                // A width far below any speed of motion, so that an explicit step stays quiet at rest.
                viscous * at.qd[other] + coulomb * (slip / 0.01).tanh()
            }
            Self::OtherWave {
                amplitude,
                other,
                rate,
                phase,
            } => amplitude * (rate * at.q[other] + phase).sin(),
            Self::OtherStep {
                amplitude,
                other,
                rate,
                center,
            } => amplitude * (rate * (at.q[other] - center)).tanh() * q.cos(),
            Self::Periodic {
                amplitude,
                hertz,
                phase,
                edge,
            } => {
                let wave = (std::f64::consts::TAU * hertz * at.time + phase).sin();
                amplitude * if edge > 0.0 { (edge * wave).tanh() } else { wave }
            }
            Self::Band {
                amplitude,
                center,
                width,
                round: true,
            } => 2.0 * amplitude * (-0.5 * ((q - center) / (0.8 * width)).powi(2)).exp(),
            Self::Band {
                amplitude,
                center,
                width,
                round: false,
            } => {
                let edge = |x: f64| (x / 0.12).tanh();
                amplitude * (edge(q - center + width) - edge(q - center - width))
            }
            Self::Hysteresis {
                amplitude,
                scale,
                shape,
                sharpness,
            } => {
                let z = *state;
                let bound = z.abs().powi(sharpness) * (shape * (v * z).signum() + (1.0 - shape));
                *state = (z + step * v / scale * (1.0 - bound)).clamp(-1.5, 1.5);
                amplitude * *state
            }
            Self::OtherVelocity { amplitude, other, of } => {
                let w = at.qd[other];
                amplitude
                    * match of {
                        OtherVelocity::Signed => w * w.abs(),
                        OtherVelocity::Square => w * w,
                        OtherVelocity::Saturating(width) => (w / width).tanh(),
                    }
            }
            Self::History {
                amplitude,
                time_constant,
                of,
            } => {
                let input = match of {
                    Past::Speed => v.abs(),
                    Past::SignedSquare => v * v.abs(),
                    Past::Position => q,
                };
                *state += step / time_constant * (input - *state);
                amplitude * if of == Past::Position { *state - q } else { *state }
            }
            Self::Walk { amplitude, ref values } => {
                let place = (100.0 * at.time).max(0.0);
                let before = (place as usize).min(values.len() - 2);
                let part = (place - before as f64).min(1.0);
                amplitude * (values[before] + part * (values[before + 1] - values[before]))
            }
            Self::VelocityWave { amplitude, rate, phase } => amplitude * v * (rate * q + phase).sin(),
            Self::SpeedPosition { amplitude, center } => amplitude * v.abs() * (q - center),
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
