//! What was concealed in a case: written before any diagnosis, opened after the last.

use std::collections::BTreeMap;

use arm::Arm;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::FaultError;
use crate::fault::{Fault, Leaves, parts};

/// The truth about one case, a JSON file of its own beside the recordings' folder.
///
/// Joint vectors are in the arm's order, base to tip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// The case's name, that of its folder.
    pub case: String,
    /// The robot's name.
    pub robot: String,
    /// The seed that the case was drawn from.
    pub seed: u64,
    /// What the machine has and the URDF has not.
    pub concealed: Vec<Injected>,
    /// Whether every joint has baseline Coulomb and viscous friction; it is in `concealed`, too.
    pub background_friction: bool,
    /// Standard deviation of the noise on each torque (N m or N).
    pub torque_noise: Vec<f64>,
    /// The encoders' step (rad or m); zero where the truth does not tell.
    #[serde(default)]
    pub encoder_quantum: f64,
    /// The recordings' nominal period (s); zero where the truth does not tell.
    #[serde(default)]
    pub period: f64,
    /// How wrong the inertials of the case's URDF are everywhere, about relative; 0: exact but for what is concealed; `None` where the
    /// truth does not tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub urdf_sigma: Option<f64>,
    /// What the case has of real life beside what is concealed; `None` for a plain one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lifelike: Option<Lifelike>,
}

/// What real recordings have and nobody asks for; small effects of every joint are in [`Truth::concealed`], as `minor`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lifelike {
    /// Factor of all friction, `[recording][joint]`, training first, then what is held out.
    pub friction: Vec<Vec<f64>>,
    /// Time constant of the noise on torques (s); 0: white.
    pub noise_time: f64,
    /// The steps in which torques are reported (N m or N); 0: none.
    pub torque_quantum: Vec<f64>,
    /// Whether each file's time begins at its own start. `onset` and `start` then stay on the one clock of the case.
    pub own_clocks: bool,
}

/// One effect of the true machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Injected {
    /// The catalogue's name; outside the catalogue a name that ends in `_unknown`.
    pub effect: String,
    /// The URDF joint's name; `None` for the whole arm.
    pub joint: Option<String>,
    /// The catalogue's parameters (SI), by name, as far as they say what the form in use does.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, Value>,
    /// The functional form, where it is not the textbook's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<String>,
    /// When it sets in (s, on the recordings' clock), where it is not there from the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub onset: Option<f64>,
    /// Whether it is one of the small things that every real joint has: nobody asks for it, and its name is not false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub minor: bool,
    /// The largest part of a joint's torque (in standard deviations, over the training recordings) that vanishes when the
    /// machine is run without the effect; `None` for the baseline friction of the background.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expressed_share: Option<f64>,
}

impl Injected {
    /// An effect on a joint, or on the whole arm, without parameters.
    pub fn new(effect: &str, joint: Option<&str>) -> Self {
        Self {
            effect: effect.to_owned(),
            joint: joint.map(str::to_owned),
            parameters: BTreeMap::new(),
            form: None,
            onset: None,
            minor: false,
            expressed_share: None,
        }
    }

    /// With a parameter.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.parameters.insert(name.to_owned(), value.into());
        self
    }

    /// In another functional form than the textbook's.
    #[must_use]
    pub fn formed(mut self, form: &str) -> Self {
        self.form = Some(form.to_owned());
        self
    }

    /// A parameter that is a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.parameters.get(name).and_then(Value::as_f64)
    }

    /// Refuses what cannot be injected into `arm`.
    ///
    /// # Errors
    /// [`FaultError::Effect`], with the effect, what is wrong and the remedy.
    pub fn check(&self, arm: &Arm) -> Result<(), FaultError> {
        parts(self, arm, true).map(|_| ())
    }

    /// What is known of its kind, if there is such a fault.
    pub(crate) fn fault(&self) -> Option<&'static Fault> {
        Fault::named(&self.effect)
    }

    /// As one of the small things that every real joint has.
    pub(crate) fn minor(mut self) -> Self {
        self.minor = true;
        self
    }

    /// Whether it is a tool that is drawn in the URDF and not mounted.
    pub fn is_not_mounted(&self) -> bool {
        self.effect == "payload" && self.number("mass").is_some_and(|mass| mass < 0.0)
    }

    /// What stays of it when it is taken away.
    pub(crate) fn leaves(&self) -> Leaves {
        if self.is_not_mounted() {
            return Leaves::Tool;
        }
        self.fault().map_or(Leaves::Nothing, |fault| fault.leaves)
    }

    /// Whether `other` is the same effect on the same joint (with the same other joint), from the start or from an onset on as it is.
    pub(crate) fn is_again(&self, other: &Self) -> bool {
        let with = |injected: &Self| injected.parameters.get("other").cloned();
        let is_same = self.effect == other.effect && self.joint == other.joint && with(self) == with(other);
        is_same
            && self.onset.is_some() == other.onset.is_some()
            && self.fault().is_some_and(|fault| !fault.may_be_several)
    }

    /// Whether no name of the catalogue fits it.
    pub fn is_outside_the_catalogue(&self) -> bool {
        self.effect.ends_with("_unknown")
    }
}
