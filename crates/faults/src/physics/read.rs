//! The truth's words into parts of a machine.

use arm::{Arm, Inertia, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::forms::{EFFECTS, UNKNOWN};
use super::reader::Reader;
use super::{Body, Connection, Contact, Part, Shape, What, tensor};
use crate::error::FaultError;
use crate::law::{Bend, Cooling, Dry, Link, Load, OtherVelocity, Past, Smooth};
use crate::truth::Injected;

/// How long a walk is before it stays where it is (s).
const LONGEST_WALK: f64 = 600.0;

impl Reader<'_> {
    fn friction(&self) -> Result<Vec<What>, FaultError> {
        let joint = self.joint()?;
        let level = |value| What::Dry(joint, Dry::Level(value));
        let coulomb = || self.at_least_zero("coulomb");
        Ok(match self.effect.effect.as_str() {
            "coulomb_friction" => vec![level(self.at_least_zero("level")?)],
            "friction_asymmetry" => {
                let (positive, negative) = (self.at_least_zero("positive")?, self.at_least_zero("negative")?);
                let tilt = What::Dry(joint, Dry::Tilt(0.5 * (positive - negative)));
                vec![level(0.5 * (positive + negative)), tilt]
            }
            "stribeck_friction" => {
                let (coulomb, velocity) = (coulomb()?, self.above("velocity", 0.0)?);
                let fading = Dry::Fading {
                    extra: self.at_least_zero("breakaway")? - coulomb,
                    velocity,
                    exponent: self.number_or("exponent", 2.0)?,
                };
                vec![level(coulomb), What::Dry(joint, fading)]
            }
            "load_dependent_friction" => {
                let of = [Load::Rigid, Load::Drive][self.form()?];
                let gain = self.at_least_zero("gain")?;
                vec![level(coulomb()?), What::Dry(joint, Dry::Loaded { gain, of })]
            }
            _ => {
                let warming = Dry::Warming {
                    amplitude: self.number("amplitude")?,
                    time_constant: self.above("time_constant", 0.0)?,
                    cooling: [Cooling::Exponential, Cooling::Hyperbolic, Cooling::Stretched][self.form()?],
                };
                vec![level(coulomb()?), What::Dry(joint, warming)]
            }
        })
    }

    fn connection(&self) -> Result<What, FaultError> {
        let joint = self.joint()?;
        let own = self.arm.joints()[joint].rotor_inertia;
        let rotor = self.number_or("rotor", own)?;
        if rotor < own {
            return Err(self.fail(format!("rotor is {rotor}; the drive alone has {own} kg m²")));
        }
        let gapped = self.effect.effect == "backlash";
        let form = self.form()?;
        let may_be_left_out = |name: &str| gapped && !self.effect.parameters.contains_key(name);
        let stiffness = if may_be_left_out("stiffness") {
            None
        } else {
            Some(self.above("stiffness", 0.0)?)
        };
        let damping = if may_be_left_out("damping") {
            None
        } else {
            Some(self.at_least_zero("damping")?)
        };
        Ok(What::Elastic(
            joint,
            Connection {
                stiffness,
                damping,
                halfgap: if gapped { self.at_least_zero("halfgap")? } else { 0.0 },
                more_rotor: rotor - own,
                hardening: if gapped || form == 0 {
                    f64::INFINITY
                } else {
                    self.above("hardening_torque", 0.0)?
                },
                round: gapped && form == 1,
            },
        ))
    }

    fn coupling(&self) -> Result<Vec<What>, FaultError> {
        let (joint, other) = (self.joint()?, self.other()?);
        let (viscous, coulomb) = (self.number("viscous")?, self.number_or("coulomb", 0.0)?);
        let sense = self.number_or("sense", 1.0)?;
        let half = |joint, other| {
            let law = Link::Coupling {
                other,
                viscous,
                coulomb,
                sense,
            };
            What::Link(joint, law)
        };
        let inertia = What::CouplingInertia(joint, other, self.number_or("inertia", 0.0)?);
        Ok(vec![half(joint, other), half(other, joint), inertia])
    }

    fn spring(&self) -> Result<What, FaultError> {
        let joint = self.joint()?;
        let points = self.curve()?;
        if !points.is_empty() {
            return Ok(What::Link(joint, Link::Curve(points)));
        }
        let spring = Link::Spring {
            stiffness: self.number("stiffness")?,
            rest: self.number("rest")?,
            bend: [Bend::Straight, Bend::Gas, Bend::Hardening, Bend::Knee][self.form()?],
        };
        Ok(What::Link(joint, spring))
    }

    fn whole_arm(&self) -> Result<What, FaultError> {
        Ok(match self.effect.effect.as_str() {
            "payload" => What::Body(Body::Payload(Inertia {
                mass: self.at_least_zero("mass")?,
                com: Vector3::from(self.numbers("com")?),
                tensor: if self.effect.parameters.contains_key("inertia") {
                    tensor(self.numbers("inertia")?)
                } else {
                    tensor([0.0; 6])
                },
            })),
            "inertial_scale" => What::Body(Body::All(self.above("factor", 0.0)?)),
            "gravity_misalignment" => {
                let axis = Vector3::from(self.numbers("axis")?);
                if axis.norm() == 0.0 {
                    return Err(self.fail("its axis has no length".into()));
                }
                What::Body(Body::Turned(axis, self.number("angle")?))
            }
            _ => What::Contact(Contact {
                start: self.number("start")?,
                duration: self.above("duration", 0.0)?,
                force: Vector3::from(self.numbers("force")?),
                shape: [Shape::Step, Shape::HalfSine, Shape::Decaying][self.form()?],
            }),
        })
    }

    fn unknown(&self) -> Result<What, FaultError> {
        let joint = self.joint()?;
        let amplitude = self.number("amplitude")?;
        let form = self.form()?;
        let law = match (self.effect.effect.as_str(), form) {
            ("cross_coupling_unknown", 0) => Link::OtherWave {
                amplitude,
                other: self.other()?,
                rate: self.number("rate")?,
                phase: self.number("phase")?,
            },
            ("cross_coupling_unknown", _) => Link::OtherStep {
                amplitude,
                other: self.other()?,
                rate: self.number("rate")?,
                center: self.number("phase")?,
            },
            ("time_periodic_unknown", _) => Link::Periodic {
                amplitude,
                hertz: self.number("hz")?,
                phase: self.number("phase")?,
                edge: [0.0, 3.0][form],
            },
            ("dead_band_unknown", _) => Link::Band {
                amplitude,
                center: self.number("center")?,
                width: self.above("width", 0.0)?,
                round: form == 1,
            },
            ("hysteresis_unknown", _) => Link::Hysteresis {
                amplitude,
                scale: self.above("scale", 0.0)?,
                shape: self.number("shape")?,
                sharpness: [1, 2][form],
            },
            ("other_velocity_unknown", _) => Link::OtherVelocity {
                amplitude,
                other: self.other()?,
                of: match form {
                    0 => OtherVelocity::Signed,
                    1 => OtherVelocity::Square,
                    _ => OtherVelocity::Saturating(self.above("velocity", 0.0)?),
                },
            },
            ("history_unknown", _) => Link::History {
                amplitude,
                time_constant: self.above("time_constant", 0.0)?,
                of: [Past::Speed, Past::SignedSquare, Past::Position][form],
            },
            ("random_walk_unknown", _) => Link::Walk {
                amplitude,
                values: walk(self.above("time_constant", 0.0)?, self.number("seed")? as u64),
            },
            (_, 0) => Link::VelocityWave {
                amplitude,
                rate: self.number("rate")?,
                phase: self.number("phase")?,
            },
            _ => Link::SpeedPosition {
                amplitude,
                center: self.number("phase")?,
            },
        };
        Ok(What::Link(joint, law))
    }

    fn parts(&self) -> Result<Vec<What>, FaultError> {
        let smooth = |law| Ok(vec![What::Smooth(self.joint()?, law)]);
        let power = |plain: f64, otherwise: f64| -> Result<Vec<What>, FaultError> {
            let default = if self.form()? == 0 { plain } else { otherwise };
            smooth(Smooth::Power {
                coefficient: self.number("coefficient")?,
                exponent: self.number_or("exponent", default)?,
            })
        };
        let name = self.effect.effect.as_str();
        if UNKNOWN.contains(&name) {
            return Ok(vec![self.unknown()?]);
        }
        // Of an effect with one form only, another is refused here.
        self.form()?;
        match name {
            "viscous_friction" => power(1.0, 0.7),
            "quadratic_drag" => power(2.0, 1.7),
            "rotor_inertia" => Ok(vec![What::Body(Body::Rotor(
                self.joint()?,
                self.at_least_zero("inertia")?,
            ))]),
            "torque_scale" => Ok(vec![What::Scale(self.joint()?, self.above("factor", 0.0)?)]),
            "torque_offset" => smooth(Smooth::Offset(self.number("offset")?)),
            "torque_ripple" => smooth(Smooth::Ripple {
                amplitude: self.number("amplitude")?,
                periods: self.number("periods")?,
                phase: self.number("phase")?,
                second: self.number_or("second", [0.0, 0.4][self.form()?])?,
            }),
            "torque_saturation" => Ok(vec![What::Limit(
                self.joint()?,
                self.above("limit", 0.0)?,
                self.form()? == 1,
            )]),
            "actuation_delay" => Ok(vec![What::Delay(
                self.joint()?,
                self.at_least_zero("delay")?,
                self.form()? == 1,
            )]),
            "joint_elasticity" | "backlash" => Ok(vec![self.connection()?]),
            "transmission_coupling" => self.coupling(),
            "link_inertial_error" => Ok(vec![What::Body(Body::Link(
                self.joint()?,
                1.0 + self.above("relative", -1.0)?,
            ))]),
            "encoder_offset" => Ok(vec![What::Encoder(self.joint()?, self.number("offset")?)]),
            "spring" => Ok(vec![self.spring()?]),
            "payload" | "inertial_scale" | "gravity_misalignment" | "external_contact" => Ok(vec![self.whole_arm()?]),
            _ if EFFECTS.contains(&name) => self.friction(),
            _ => {
                let known: Vec<String> = EFFECTS.iter().chain(&UNKNOWN).map(ToString::to_string).collect();
                let hint =
                    recording::nearest(name, &known).map_or(String::new(), |near| format!("did you mean \"{near}\"? "));
                Err(self.fail(format!("there is no such effect; {hint}there are {}", known.join(", "))))
            }
        }
    }
}

/// What `effect` is to a machine of `arm` (its drives' rotor inertias in it); without it (`whole` false), what stays when it is
/// taken away: the plain friction under a curve, the rotor of a drive whose spring is rigid.
///
/// # Errors
/// [`FaultError::Effect`], with the effect, what is wrong and the remedy.
pub(crate) fn parts(effect: &Injected, arm: &Arm, whole: bool) -> Result<Vec<Part>, FaultError> {
    let onset = effect.onset.unwrap_or(f64::NEG_INFINITY);
    if onset.is_nan() || onset == f64::INFINITY {
        return Err(Reader { effect, arm }.fail(format!("its onset is {onset} s; give a finite time")));
    }
    let rests = effect.effect != "coulomb_friction";
    let mut made = Vec::new();
    for what in (Reader { effect, arm }).parts()? {
        let stays = rests && matches!(what, What::Dry(_, Dry::Level(_)));
        if let What::Elastic(joint, connection) = &what {
            // The rotor turns with its link until there is something between them.
            let what = What::Body(Body::Rotor(*joint, connection.more_rotor));
            made.push(Part {
                onset: f64::NEG_INFINITY,
                what,
            });
        }
        if stays {
            let onset = f64::NEG_INFINITY;
            made.push(Part { onset, what });
        } else if whole {
            made.push(Part { onset, what });
        }
    }
    Ok(made)
}

/// A torque that wanders with unit variance (Ornstein and Uhlenbeck 1930), smoothed over .05 s, every hundredth of a second.
fn walk(time_constant: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let keep = (-0.01 / time_constant).exp();
    let (mut x, smooth) = (normal(), 1.0 - (-0.01_f64 / 0.05).exp());
    let mut y = x;
    (0..(100.0 * LONGEST_WALK) as usize)
        .map(|_| {
            x = keep * x + (1.0 - keep * keep).sqrt() * normal();
            y += smooth * (x - y);
            y
        })
        .collect()
}
