//! The ground truth of a case: written before any diagnosis, opened after the last one.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The ground truth of one case, a JSON file outside the recordings' folder.
///
/// Joint vectors are in the arm's order, base to tip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// The case's name, which is that of its folder.
    pub case: String,
    /// The robot's name.
    pub robot: String,
    /// The seed that the case was drawn from.
    pub seed: u64,
    /// The effects that the machine has and the URDF does not have.
    #[serde(rename = "concealed")]
    pub injected: Vec<Injected>,
    /// Whether every joint has baseline Coulomb and viscous friction; [`Self::injected`] lists it as well.
    pub background_friction: bool,
    /// Standard deviation of the noise on each torque (N m or N).
    pub torque_noise: Vec<f64>,
    /// The encoders' step (rad or m); zero if the truth does not state it.
    #[serde(default)]
    pub encoder_quantum: f64,
    /// The recordings' nominal period (s); zero if the truth does not state it.
    #[serde(default)]
    pub period: f64,
    /// The approximate relative error of all inertial parameters of the case's URDF; 0: exact except for the injected
    /// effects; `None` if the truth does not state it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub urdf_sigma: Option<f64>,
    /// The properties of real recordings that the case has in addition to the injected effects; `None` for a plain
    /// case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lifelike: Option<Lifelike>,
}

/// Properties of real recordings that are not scored; small effects of every joint are in [`Truth::injected`], marked
/// as `minor`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lifelike {
    /// Factor of all friction, `[recording][joint]`: the training recordings first, then the held-out one.
    pub friction: Vec<Vec<f64>>,
    /// Time constant of the noise on torques (s); 0: white.
    pub noise_time: f64,
    /// The steps in which torques are reported (N m or N); 0 for none.
    pub torque_quantum: Vec<f64>,
    /// Whether each file's time begins at its own start. `onset` and `start` are then on the common clock of the case.
    pub own_clocks: bool,
}

/// One effect of the true machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Injected {
    /// The catalogue's name, or a name that ends in `_unknown` for an effect outside the catalogue.
    pub effect: String,
    /// The URDF joint's name; `None` for the whole arm.
    pub joint: Option<String>,
    /// Parameters by their names in the catalogue (SI), as far as they apply to the form.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, Value>,
    /// The functional form, if it is not the textbook's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<String>,
    /// The onset (s, on the recordings' clock), if it is not present from the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub onset: Option<f64>,
    /// Whether it is one of the small effects that every real joint has: it need not be found, and naming it is not an
    /// error.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub minor: bool,
    /// The largest share of a joint's torque (in standard deviations, over the training recordings) that vanishes when
    /// the machine is run without the effect; `None` for the baseline friction of the background.
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

    /// Adds a parameter.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.parameters.insert(name.to_owned(), value.into());
        self
    }

    /// Sets a functional form other than the textbook's.
    #[must_use]
    pub fn formed(mut self, form: &str) -> Self {
        self.form = Some(form.to_owned());
        self
    }

    /// The value of a numeric parameter.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.parameters.get(name).and_then(Value::as_f64)
    }

    /// Marks it as one of the small effects that every real joint has.
    pub(crate) fn minor(mut self) -> Self {
        self.minor = true;
        self
    }

    /// Whether it is a tool that is drawn in the URDF and not mounted.
    pub fn is_not_mounted(&self) -> bool {
        self.effect == "payload" && self.number("mass").is_some_and(|mass| mass < 0.0)
    }
}
