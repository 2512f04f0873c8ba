//! An effect's joints and numbers, looked up and checked.

use arm::Arm;
use serde_json::Value;

use super::forms::forms;
use crate::error::FaultError;
use crate::truth::Injected;

/// One effect, its joints and numbers looked up.
pub(super) struct Reader<'a> {
    pub(super) effect: &'a Injected,
    pub(super) arm: &'a Arm,
}

impl Reader<'_> {
    pub(super) fn fail(&self, reason: String) -> FaultError {
        let effect = self.effect.effect.clone();
        FaultError::Effect { effect, reason }
    }

    pub(super) fn joint_named(&self, name: &str) -> Result<usize, FaultError> {
        let joints = self.arm.joints();
        joints.iter().position(|joint| joint.name == name).ok_or_else(|| {
            let known: Vec<String> = joints.iter().map(|joint| joint.name.clone()).collect();
            let hint =
                recording::nearest(name, &known).map_or(String::new(), |near| format!("did you mean \"{near}\"? "));
            self.fail(format!(
                "there is no joint \"{name}\"; {hint}the robot has {}",
                known.join(", ")
            ))
        })
    }

    pub(super) fn joint(&self) -> Result<usize, FaultError> {
        match &self.effect.joint {
            Some(name) => self.joint_named(name),
            None => Err(self.fail("the joint is missing; add joint = \"…\"".into())),
        }
    }

    pub(super) fn other(&self) -> Result<usize, FaultError> {
        let name = self.effect.parameters.get("other").and_then(Value::as_str);
        let other =
            self.joint_named(name.ok_or_else(|| self.fail("the other joint is missing; add other = \"…\"".into()))?)?;
        if other == self.joint()? {
            return Err(self.fail("the other joint is the joint itself; name another".into()));
        }
        Ok(other)
    }

    pub(super) fn number(&self, name: &str) -> Result<f64, FaultError> {
        match self.effect.parameters.get(name) {
            None => Err(self.fail(format!("the parameter {name} is missing; add {name} = …"))),
            Some(value) => match value.as_f64() {
                Some(number) if number.is_finite() => Ok(number),
                _ => Err(self.fail(format!("{name} is {value}; give a finite number"))),
            },
        }
    }

    pub(super) fn number_or(&self, name: &str, default: f64) -> Result<f64, FaultError> {
        if self.effect.parameters.contains_key(name) {
            self.number(name)
        } else {
            Ok(default)
        }
    }

    pub(super) fn above(&self, name: &str, least: f64) -> Result<f64, FaultError> {
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
        let list = self.effect.parameters.get(name).and_then(Value::as_array);
        let values: Option<Vec<f64>> = list.and_then(|list| list.iter().map(Value::as_f64).collect());
        values
            .and_then(|values| <[f64; N]>::try_from(values).ok())
            .filter(|values| values.iter().all(|value| value.is_finite()))
            .ok_or_else(|| self.fail(format!("{name} must be {N} numbers; add {name} = […]")))
    }

    pub(super) fn curve(&self) -> Result<Vec<[f64; 2]>, FaultError> {
        let Some(value) = self.effect.parameters.get("curve") else {
            return Ok(Vec::new());
        };
        let points: Vec<[f64; 2]> = serde_json::from_value(value.clone())
            .map_err(|_| self.fail("curve must be points [position, torque]".into()))?;
        if points.windows(2).all(|pair| pair[0][0] < pair[1][0]) {
            return Ok(points);
        }
        Err(self.fail("the curve's points must be in the order of their positions".into()))
    }

    /// Which of the effect's forms it has: 0 is the textbook's.
    pub(super) fn form(&self) -> Result<usize, FaultError> {
        let Some(form) = &self.effect.form else { return Ok(0) };
        let known = forms(&self.effect.effect);
        match known.iter().position(|name| name == form) {
            Some(place) => Ok(place + 1),
            None if known.is_empty() => Err(self.fail(format!(
                "it has no form \"{form}\": it has one only; leave the line out"
            ))),
            None => Err(self.fail(format!("it has no form \"{form}\"; there are {}", known.join(", ")))),
        }
    }
}
