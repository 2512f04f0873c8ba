//! Effects on an arm: their parameters are checked, and they are added to a machine.

use arm::Arm;

use crate::error::EffectError;
use crate::machine::{JointIndices, Machine};
use crate::spec::{Effect, Scope};

/// Refuses parameters that are physically impossible.
///
/// # Errors
/// [`EffectError::Parameter`], naming effect, joint and value.
pub fn check(effect: &Effect) -> Result<(), EffectError> {
    let refuse = |parameter, value, requirement| {
        Err(EffectError::Parameter {
            effect: effect.name(),
            joint: effect.joint().unwrap_or("the whole arm").to_owned(),
            parameter,
            value,
            requirement,
        })
    };
    if let Some(onset) = effect.onset()
        && !onset.is_finite()
    {
        return refuse("onset", onset, "finite");
    }
    for (parameter, value) in effect.values() {
        let numbers = value.numbers();
        if let Some(value) = numbers.into_iter().find(|&value| !parameter.range.contains(value)) {
            return refuse(parameter.key, value, parameter.range.requirement());
        }
    }
    match (effect.spec().refuse)(effect) {
        Some((parameter, value, requirement)) => refuse(parameter, value, requirement),
        None => Ok(()),
    }
}

impl Machine {
    /// `arm` with `effects`.
    ///
    /// # Errors
    /// [`EffectError`], naming effect, joint and value.
    pub fn new(arm: &Arm, effects: &[Effect]) -> Result<Self, EffectError> {
        let mut machine = Self::without_effects(arm);
        for effect in effects {
            check(effect)?;
            let spec = effect.spec();
            let place = JointIndices {
                joint: match spec.scope {
                    Scope::Joint => joint_of(arm, effect, effect.joint())?,
                    Scope::Arm => 0,
                },
                other: if spec.has_other { joint_of(arm, effect, effect.other())? } else { 0 },
            };
            if spec.has_other && place.joint == place.other {
                let joint = effect.joint().unwrap_or_default().to_owned();
                return Err(EffectError::OwnJoint { effect: effect.name(), joint });
            }
            (spec.apply)(effect, place, &mut machine);
        }
        Ok(machine)
    }
}

/// The index of the joint `name`. Without a name, the error contains an empty one.
fn joint_of(arm: &Arm, effect: &Effect, name: Option<&str>) -> Result<usize, EffectError> {
    let found = arm.joints().iter().position(|joint| Some(joint.name.as_str()) == name);
    found.ok_or_else(|| EffectError::UnknownJoint {
        effect: effect.name(),
        joint: name.unwrap_or_default().to_owned(),
        known: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
    })
}
