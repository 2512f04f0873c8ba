//! From columns and coefficients to effects with parameters in SI units.

mod onset;
mod parts;

use std::collections::BTreeMap;

use torque::Effect;

use crate::data::units::Units;
use crate::findings::report::Parameter;
use crate::regression::bootstrap::{OF_FORM, Resampled, SYSTEMATIC};
use crate::regression::term::Term;
use crate::search::candidate::Cause;
use crate::search::refine::Size;
use crate::search::study::Study;

use parts::{payload, rotor, spring};

/// A named effect with its parameters.
#[derive(Clone, Debug)]
pub struct Named {
    /// As the corrected model takes it.
    pub effect: Effect,
    /// The joint whose motion it depends on.
    pub other: Option<String>,
    /// With intervals.
    pub parameters: BTreeMap<&'static str, Parameter>,
}

/// What a candidate's numbers are read from.
struct Reader<'a> {
    study: &'a Study,
    resampled: &'a Resampled,
    candidate: usize,
    parameters: BTreeMap<&'static str, Parameter>,
}

impl Reader<'_> {
    /// Where the coefficient of the first term that fits stands.
    fn at(&self, wanted: impl Fn(Term) -> bool) -> Option<usize> {
        let columns = &self.study.candidates[self.candidate].columns;
        let column = columns.iter().find(|&&column| wanted(self.study.table.terms[column]))?;
        self.resampled.column(*column)
    }

    /// Where the coefficient of the candidate's k-th column stands.
    fn nth(&self, k: usize) -> Option<usize> {
        let column = self.study.candidates[self.candidate].columns.get(k)?;
        self.resampled.column(*column)
    }

    /// Notes a parameter that is a function of the coefficients; its value.
    fn note(&mut self, key: &'static str, unit: &'static str, f: impl Fn(&[f64]) -> f64) -> f64 {
        self.note_within(SYSTEMATIC, key, unit, f)
    }

    /// The same with another part of the value that no repetition shows.
    fn note_within(
        &mut self,
        systematic: f64,
        key: &'static str,
        unit: &'static str,
        f: impl Fn(&[f64]) -> f64,
    ) -> f64 {
        let (value, ci95) = self.resampled.interval_within(systematic, f);
        self.parameters.insert(key, Parameter { value, ci95, unit });
        value
    }

    /// Notes a coefficient times a factor.
    fn coefficient(&mut self, key: &'static str, unit: &'static str, at: Option<usize>, factor: f64) -> f64 {
        at.map_or(0.0, |at| self.note(key, unit, |draw| factor * draw[at]))
    }

    /// What is simulated at its size: where its torque is in proportion to that, its coefficient and the size's correction
    /// mean the same, and only together are they determined. `value` takes both; `systematic` is as in
    /// [`Resampled::interval_within`].
    fn simulated(
        &mut self,
        key: &'static str,
        unit: &'static str,
        systematic: f64,
        value: impl Fn(f64, f64) -> f64,
    ) -> f64 {
        let (first, size) = (self.nth(0), self.resampled.size(self.candidate, Size::Main));
        self.note_within(systematic, key, unit, |draw| {
            let drawn = first.map_or(1.0, |at| draw[at]);
            let size = size.map_or(0.0, |at| draw[at]);
            value(drawn, size)
        })
    }

    /// Notes a size at its corrected value.
    fn size(&mut self, key: &'static str, unit: &'static str, size: Size, value: f64) -> f64 {
        match self.resampled.size(self.candidate, size) {
            Some(at) => self.note(key, unit, |draw| value * (1.0 + draw[at].clamp(-0.5, 0.5))),
            None => self.note(key, unit, |_| value),
        }
    }

    /// The same of one that hangs on its form.
    fn size_of_form(&mut self, key: &'static str, unit: &'static str, size: Size, value: f64) -> f64 {
        match self.resampled.size(self.candidate, size) {
            Some(at) => self.note_within(OF_FORM, key, unit, |draw| value * (1.0 + draw[at].clamp(-0.5, 0.5))),
            None => self.note_within(OF_FORM, key, unit, |_| value),
        }
    }
}

/// Names the effect of `candidate`, if its cause has a name. Elasticity and backlash name the drive's inertia too.
pub fn name(study: &Study, resampled: &Resampled, candidate: usize) -> Vec<Named> {
    let this = &study.candidates[candidate];
    let terms = study.terms(candidate);
    let index = this.joint.unwrap_or(0);
    let arm_joint = &study.arm.joints()[index];
    let joint = arm_joint.name.clone();
    let units = Units::of(arm_joint.kind);
    let mut reader = Reader {
        study,
        resampled,
        candidate,
        parameters: BTreeMap::new(),
    };
    let mut other = None;
    let effect = match this.cause {
        Cause::Viscous => Effect::ViscousFriction {
            coefficient: reader.coefficient("coefficient", units.damping, reader.nth(0), 1.0),
            joint,
        },
        Cause::Coulomb => Effect::CoulombFriction {
            level: reader.coefficient("level", units.torque, reader.nth(0), 1.0),
            joint,
        },
        Cause::Asymmetry => {
            let (Some(a), Some(b)) = (reader.nth(0), reader.nth(1)) else {
                return Vec::new();
            };
            Effect::FrictionAsymmetry {
                positive: reader.note("positive", units.torque, |draw| draw[a] + draw[b]),
                negative: reader.note("negative", units.torque, |draw| draw[a] - draw[b]),
                joint,
            }
        }
        Cause::Stribeck => {
            let (Some(a), Some(b)) = (reader.nth(0), reader.nth(1)) else {
                return Vec::new();
            };
            let Term::Stribeck { velocity, exponent, .. } = terms[1] else {
                return Vec::new();
            };
            Effect::StribeckFriction {
                coulomb: reader.note("coulomb", units.torque, |draw| draw[a]),
                breakaway: reader.note_within(OF_FORM, "breakaway", units.torque, |draw| draw[a] + draw[b]),
                velocity: reader.size_of_form("velocity", units.speed, Size::Main, velocity),
                exponent,
                joint,
            }
        }
        Cause::LoadDependent => Effect::LoadDependentFriction {
            coulomb: reader.coefficient("coulomb", units.torque, reader.nth(0), 1.0),
            gain: reader.coefficient("gain", "1", reader.nth(1), 1.0),
            joint,
        },
        Cause::Thermal => {
            let (Some(a), Some(b)) = (reader.nth(0), reader.nth(1)) else {
                return Vec::new();
            };
            let Term::Warm { time_constant, .. } = terms[1] else {
                return Vec::new();
            };
            Effect::ThermalDrift {
                coulomb: reader.note("coulomb", units.torque, |draw| draw[a]),
                amplitude: reader.note("amplitude", "1", |draw| draw[b] / draw[a]),
                time_constant: reader.size("time_constant", "s", Size::Main, time_constant),
                joint,
            }
        }
        Cause::Drag => {
            let Term::Drag { exponent, .. } = terms[0].always() else {
                return Vec::new();
            };
            Effect::QuadraticDrag {
                coefficient: reader.coefficient("coefficient", units.drag, reader.nth(0), 1.0),
                exponent,
                onset: reader.onset(),
                joint,
            }
        }
        Cause::RotorInertia => Effect::RotorInertia {
            inertia: reader.coefficient("inertia", units.inertia, reader.nth(0), 1.0),
            joint,
        },
        Cause::TorqueScale => {
            let Some(a) = reader.nth(0) else { return Vec::new() };
            Effect::TorqueScale {
                factor: reader.note("factor", "1", |draw| 1.0 + draw[a]),
                onset: reader.onset(),
                joint,
            }
        }
        Cause::TorqueOffset => Effect::TorqueOffset {
            offset: reader.coefficient("offset", units.torque, reader.nth(0), 1.0),
            onset: reader.onset(),
            joint,
        },
        Cause::Ripple => {
            let (Some(a), Some(b)) = (reader.nth(0), reader.nth(1)) else {
                return Vec::new();
            };
            let Term::Ripple { periods, .. } = terms[0] else {
                return Vec::new();
            };
            let phase = resampled.estimate[b].atan2(resampled.estimate[a]);
            Effect::TorqueRipple {
                amplitude: reader.note("amplitude", units.torque, |draw| draw[a].hypot(draw[b])),
                periods: reader.size("periods", "1", Size::Periods, periods),
                phase: reader.note("phase", "rad", |draw| phase + around(draw[b].atan2(draw[a]) - phase)),
                joint,
            }
        }
        Cause::Saturation => {
            let Term::Excess { limit, .. } = terms[0] else {
                return Vec::new();
            };
            Effect::TorqueSaturation {
                limit: reader.size("limit", units.torque, Size::Main, limit),
                joint,
            }
        }
        Cause::Delay => {
            let Term::Late { delay, .. } = terms[0] else {
                return Vec::new();
            };
            Effect::ActuationDelay {
                delay: reader.simulated("delay", "s", OF_FORM, |drawn, size| delay * (drawn + size)),
                joint,
            }
        }
        Cause::Elasticity => {
            let Term::Elastic { stiffness, damping, .. } = terms[0] else {
                return Vec::new();
            };
            Effect::JointElasticity {
                stiffness: reader.simulated("stiffness", units.stiffness, SYSTEMATIC, |drawn, size| {
                    stiffness / (drawn - size).clamp(0.4, 2.5)
                }),
                damping: reader.size_of_form("damping", units.damping, Size::Damping, damping),
                joint,
            }
        }
        Cause::Backlash => {
            let Term::Gap { halfgap, .. } = terms[0] else {
                return Vec::new();
            };
            Effect::Backlash {
                halfgap: reader.simulated("halfgap", units.position, OF_FORM, |drawn, size| {
                    halfgap * (drawn + size)
                }),
                joint,
            }
        }
        Cause::Coupling(with) => {
            let with = study.arm.joints()[with].name.clone();
            let sense = terms.iter().find_map(|term| match term {
                Term::PairSign { sense, .. } => Some(*sense),
                _ => None,
            });
            other = Some(with.clone());
            Effect::TransmissionCoupling {
                joint,
                other: with,
                sense: sense.unwrap_or(1.0),
                viscous: reader.coefficient(
                    "viscous",
                    units.damping,
                    reader.at(|t| matches!(t, Term::PairVelocity(..))),
                    1.0,
                ),
                coulomb: reader.coefficient(
                    "coulomb",
                    units.torque,
                    reader.at(|t| matches!(t, Term::PairSign { .. })),
                    1.0,
                ),
                inertia: reader.coefficient(
                    "inertia",
                    units.inertia,
                    reader.at(|t| matches!(t, Term::PairAcceleration(..))),
                    1.0,
                ),
            }
        }
        Cause::Payload => payload(&mut reader),
        Cause::LinkError => Effect::LinkInertialError {
            relative: reader.coefficient("relative", "1", reader.nth(0), 1.0),
            joint,
        },
        Cause::InertialScale => {
            let Some(a) = reader.nth(0) else { return Vec::new() };
            Effect::InertialScale {
                factor: reader.note("factor", "1", |draw| 1.0 + draw[a]),
            }
        }
        Cause::Tilt => {
            let (Some(a), Some(b)) = (reader.nth(0), reader.nth(1)) else {
                return Vec::new();
            };
            let angle = reader.note("angle", "rad", |draw| draw[a].hypot(draw[b]));
            let axis_x = reader.note("axis_x", "1", |draw| draw[a] / draw[a].hypot(draw[b]));
            let axis_y = reader.note("axis_y", "1", |draw| draw[b] / draw[a].hypot(draw[b]));
            Effect::GravityMisalignment {
                angle,
                axis: [axis_x, axis_y, 0.0],
            }
        }
        Cause::EncoderOffset => Effect::EncoderOffset {
            // The column is the derivative by where the joint stands; the encoder is off the other way.
            offset: reader.coefficient("offset", units.position, reader.nth(0), -1.0),
            joint,
        },
        Cause::Spring => spring(&mut reader, index, joint, &units),
        Cause::Contact => {
            let Term::Force { from, to, .. } = terms[0] else {
                return Vec::new();
            };
            let (Some(x), Some(y), Some(z)) = (reader.nth(0), reader.nth(1), reader.nth(2)) else {
                return Vec::new();
            };
            reader.note("force", "N", |draw| {
                (draw[x].powi(2) + draw[y].powi(2) + draw[z].powi(2)).sqrt()
            });
            reader.start(from, to - from);
            Effect::ExternalContact {
                start: from,
                duration: reader.size_of_form("duration", "s", Size::Duration, to - from),
                force: [
                    reader.coefficient("force_x", "N", Some(x), 1.0),
                    reader.coefficient("force_y", "N", Some(y), 1.0),
                    reader.coefficient("force_z", "N", Some(z), 1.0),
                ],
            }
        }
        Cause::OwnPosition
        | Cause::OtherPosition(_)
        | Cause::OtherSpeed(_)
        | Cause::History
        | Cause::Product
        | Cause::Periodic
        | Cause::Time => return Vec::new(),
    };
    let mut named = vec![Named {
        effect,
        other,
        parameters: std::mem::take(&mut reader.parameters),
    }];
    if matches!(this.cause, Cause::Elasticity | Cause::Backlash)
        && let Some(drive) = rotor(&mut reader, &arm_joint.name, &units)
    {
        named.push(drive);
    }
    named
}

/// An angle within half a turn of zero.
fn around(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}
