//! The names and values of a fault in a ground truth, checked, and converted into parts of a machine.

use arm::Arm;
use serde_json::Value;

use super::{EligibleJoints, FAULTS, Fault};
use crate::error::FaultError;
use crate::part::{DriveLaw, DryLaw, LinkLaw, Part, Piece, Presence, Property};
use crate::truth::Injected;

/// The parts that `injected` adds to a machine of `arm` (with the drives' rotor inertias). If `whole` is false, only
/// the part that remains when the fault is removed: the plain friction below a friction curve, or the rotor of a drive
/// with a rigid spring.
///
/// # Errors
/// [`FaultError::Effect`], with the fault, the reason and the remedy.
pub(crate) fn parts(injected: &Injected, arm: &Arm, whole: bool) -> Result<Vec<Part>, FaultError> {
    let reader = Reader { injected, arm };
    let onset = injected.onset.unwrap_or(f64::NEG_INFINITY);
    if onset.is_nan() || onset == f64::INFINITY {
        return Err(reader.fail(format!("its onset is {onset} s; give a finite time")));
    }
    let pieces = (reader.fault()?.read)(&reader)?.into_iter();
    let is_there = |piece: &Piece| match piece.there {
        Presence::With => whole,
        Presence::Always => true,
        Presence::Without => !whole,
    };
    let part =
        |Piece { what, there }| Part { onset: if there == Presence::With { onset } else { f64::NEG_INFINITY }, what };
    Ok(pieces.filter(is_there).map(part).collect())
}

/// A fault of a ground truth, whose joints and numbers can be looked up.
pub(crate) struct Reader<'a> {
    pub(super) injected: &'a Injected,
    pub(super) arm: &'a Arm,
}

impl Reader<'_> {
    /// Its kind; the form must be one of that kind, and the joint one of the arm.
    fn fault(&self) -> Result<&'static Fault, FaultError> {
        let name = &self.injected.effect;
        if let Some(fault) = Fault::named(name) {
            self.form()?;
            if fault.joints != EligibleJoints::WholeArm {
                self.joint()?;
            }
            return Ok(fault);
        }
        let known: Vec<String> = FAULTS.iter().map(|fault| fault.name.to_owned()).collect();
        let hint = recording::nearest(name, &known).map_or(String::new(), |near| format!("did you mean \"{near}\"? "));
        Err(self.fail(format!("there is no such effect; {hint}there are {}", known.join(", "))))
    }

    /// A piece with dry friction on its joint.
    pub(super) fn on_dry(&self, law: impl DryLaw + 'static) -> Result<Vec<Piece>, FaultError> {
        Ok(vec![Property::Dry(self.joint()?, Box::new(law)).into()])
    }

    /// A piece with a torque on the drive's side of its joint.
    pub(super) fn on_drive(&self, law: impl DriveLaw + 'static) -> Result<Vec<Piece>, FaultError> {
        Ok(vec![Property::Drive(self.joint()?, Box::new(law)).into()])
    }

    /// A piece with a torque on the link's side of its joint.
    pub(super) fn on_link(&self, law: impl LinkLaw + 'static) -> Result<Vec<Piece>, FaultError> {
        Ok(vec![Property::Link(self.joint()?, Box::new(law)).into()])
    }

    pub(super) fn fail(&self, reason: String) -> FaultError {
        let effect = self.injected.effect.clone();
        FaultError::Effect { effect, reason }
    }

    pub(super) fn joint_named(&self, name: &str) -> Result<usize, FaultError> {
        let joints = self.arm.joints();
        joints.iter().position(|joint| joint.name == name).ok_or_else(|| {
            let known: Vec<String> = joints.iter().map(|joint| joint.name.clone()).collect();
            let hint =
                recording::nearest(name, &known).map_or(String::new(), |near| format!("did you mean \"{near}\"? "));
            self.fail(format!("there is no joint \"{name}\"; {hint}the robot has {}", known.join(", ")))
        })
    }

    pub(super) fn joint(&self) -> Result<usize, FaultError> {
        match &self.injected.joint {
            Some(name) => self.joint_named(name),
            None => Err(self.fail("the joint is missing; add joint = \"…\"".into())),
        }
    }

    pub(super) fn other(&self) -> Result<usize, FaultError> {
        let name = self.injected.parameters.get("other").and_then(Value::as_str);
        let other =
            self.joint_named(name.ok_or_else(|| self.fail("the other joint is missing; add other = \"…\"".into()))?)?;
        if other == self.joint()? {
            return Err(self.fail("the other joint is the joint itself; name another".into()));
        }
        Ok(other)
    }

    pub(super) fn number(&self, name: &str) -> Result<f64, FaultError> {
        match self.injected.parameters.get(name) {
            None => Err(self.fail(format!("the parameter {name} is missing; add {name} = …"))),
            Some(value) => match value.as_f64() {
                Some(number) if number.is_finite() => Ok(number),
                _ => Err(self.fail(format!("{name} is {value}; give a finite number"))),
            },
        }
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.injected.parameters.contains_key(name)
    }

    pub(super) fn number_or(&self, name: &str, default: f64) -> Result<f64, FaultError> {
        if self.has(name) { self.number(name) } else { Ok(default) }
    }

    pub(super) fn number_above(&self, name: &str, least: f64) -> Result<f64, FaultError> {
        let value = self.number(name)?;
        if value > least {
            return Ok(value);
        }
        Err(self.fail(format!("{name} is {value}; give a number above {least}")))
    }

    pub(super) fn at_least_zero(&self, name: &str) -> Result<f64, FaultError> {
        let value = self.number(name)?;
        if value >= 0.0 {
            return Ok(value);
        }
        Err(self.fail(format!("{name} is {value}; give a number that is not negative")))
    }

    pub(super) fn numbers<const N: usize>(&self, name: &str) -> Result<[f64; N], FaultError> {
        let list = self.injected.parameters.get(name).and_then(Value::as_array);
        let values: Option<Vec<f64>> = list.and_then(|list| list.iter().map(Value::as_f64).collect());
        values
            .and_then(|values| <[f64; N]>::try_from(values).ok())
            .filter(|values| values.iter().all(|value| value.is_finite()))
            .ok_or_else(|| self.fail(format!("{name} must be {N} numbers; add {name} = […]")))
    }

    pub(super) fn curve(&self) -> Result<Vec<[f64; 2]>, FaultError> {
        let Some(value) = self.injected.parameters.get("curve") else {
            return Ok(Vec::new());
        };
        let points: Vec<[f64; 2]> = serde_json::from_value(value.clone())
            .map_err(|_| self.fail("curve must be points [position, torque]".into()))?;
        if points.windows(2).all(|pair| pair[0][0] < pair[1][0]) {
            return Ok(points);
        }
        Err(self.fail("the curve's points must be in the order of their positions".into()))
    }

    /// The index of the effect's form; 0 is the textbook's.
    pub(super) fn form(&self) -> Result<usize, FaultError> {
        let Some(form) = &self.injected.form else { return Ok(0) };
        let known = Fault::named(&self.injected.effect).map_or(&[][..], |fault| fault.forms);
        match known.iter().position(|name| name == form) {
            Some(place) => Ok(place + 1),
            None if known.is_empty() => {
                Err(self.fail(format!("it has no form \"{form}\": it has one only; leave the line out")))
            }
            None => Err(self.fail(format!("it has no form \"{form}\"; there are {}", known.join(", ")))),
        }
    }
}
