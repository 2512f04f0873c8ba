//! What was concealed in a case: written before any diagnosis, opened after the last.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

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
    /// Whether every joint has ordinary Coulomb and viscous friction; it is in `concealed`, too.
    pub background_friction: bool,
    /// Standard deviation of the noise on each torque (N m or N).
    pub torque_noise: Vec<f64>,
    /// The encoders' step (rad or m); zero where the truth does not tell.
    #[serde(default)]
    pub encoder_quantum: f64,
    /// The recordings' nominal period (s); zero where the truth does not tell.
    #[serde(default)]
    pub period: f64,
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
    pub parameters: BTreeMap<String, serde_json::Value>,
    /// The functional form, where it is not the textbook's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<String>,
    /// When it sets in (s, on the recordings' clock), where it is not there from the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub onset: Option<f64>,
    /// The largest part of a joint's torque (in standard deviations, over the training recordings) that vanishes when the
    /// machine is run without the effect; `None` for the ordinary friction of the background.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expressed_share: Option<f64>,
}

impl Injected {
    /// The catalogue's name, also of truths that were written under another.
    pub fn name(&self) -> &str {
        match self.effect.as_str() {
            "link_mass_error" => "link_inertial_error",
            "gravity_tilt" => "gravity_misalignment",
            name => name,
        }
    }

    /// Whether `other` is the same effect on the same joint (with the same other joint), from the start or from an onset on as it is.
    /// Pushes and ripples there may be several.
    pub(crate) fn is_again(&self, other: &Self) -> bool {
        let about = |effect: &Self| {
            let (joint, with) = (effect.joint.clone(), effect.parameters.get("other").cloned());
            (effect.name().to_owned(), joint, with, effect.onset.is_some())
        };
        let several = ["external_contact", "torque_ripple"].contains(&self.name()) || self.is_outside_the_catalogue();
        !several && about(self) == about(other)
    }

    /// Whether no name of the catalogue fits it.
    pub fn is_outside_the_catalogue(&self) -> bool {
        self.effect.ends_with("_unknown")
    }
}
