//! The fields of a diagnosis (`testbed.diagnosis/1`) that are scored.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// A diagnosis; fields that are not scored are not read.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct Answer {
    /// The verdict.
    #[serde(default)]
    pub verdict: String,
    /// The effects named.
    pub findings: Vec<Named>,
    /// The joints with an unexplained residual.
    #[serde(default)]
    pub unexplained: Vec<Refused>,
    /// The effects that are not testable with the recordings.
    #[serde(default)]
    pub not_observable: Vec<NotTestable>,
    /// Errors of prediction, by joint.
    #[serde(default)]
    pub fit: BTreeMap<String, JointErrors>,
    /// How closely the simulated arm follows the recorded motion, by joint.
    #[serde(default)]
    pub rollout: BTreeMap<String, Rollout>,
    /// The proposed motion, if one was requested.
    #[serde(default)]
    pub next_experiment: Option<NextExperiment>,
}

/// A proposed experiment.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct NextExperiment {
    /// The confusions that it is predicted to resolve.
    pub separates: Vec<Separated>,
    /// The confusions that it does not resolve.
    pub not_separated: Vec<NotSeparated>,
}

/// A confusion that a motion is predicted to resolve.
#[derive(Clone, Debug, Deserialize)]
pub struct Separated {
    /// The finding.
    pub finding: EffectOnJoint,
    /// The alternative.
    pub rival: EffectOnJoint,
}

/// A confusion that the motion does not resolve.
#[derive(Clone, Debug, Deserialize)]
pub struct NotSeparated {
    /// The finding.
    pub finding: EffectOnJoint,
    /// The alternative.
    pub rival: EffectOnJoint,
    /// The reason in one word.
    #[serde(default)]
    pub kind: String,
}

/// An effect named.
#[derive(Clone, Debug, Deserialize)]
pub struct Named {
    /// The catalogue's name.
    pub effect: String,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
    /// The other joint of a coupling.
    #[serde(default)]
    pub other: Option<String>,
    /// Its parameters.
    #[serde(default)]
    pub parameters: BTreeMap<String, Number>,
    /// The stated probability that it is right.
    #[serde(default)]
    pub probability: Option<f64>,
    /// Its share of the joint's torque.
    #[serde(default)]
    pub share: f64,
    /// Its alternatives.
    #[serde(default)]
    pub confusable_with: Vec<EffectOnJoint>,
    /// Its sentence.
    #[serde(default)]
    pub sentence: String,
}

/// An effect and its joint.
#[derive(Clone, Debug, Deserialize)]
pub struct EffectOnJoint {
    /// The catalogue's name.
    pub effect: String,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
}

/// A number with its interval; JSON has no infinite numbers.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Number {
    /// The estimate.
    pub value: Option<f64>,
    /// Its 95 % interval.
    pub ci95: [Option<f64>; 2],
}

impl Number {
    /// Whether the interval contains `value`; an interval that is open at both ends contains nothing.
    pub fn holds(&self, value: f64) -> bool {
        let [low, high] = self.ci95;
        (low.is_some() || high.is_some()) && low.is_none_or(|low| low <= value) && high.is_none_or(|high| value <= high)
    }
}

/// An unexplained residual.
#[derive(Clone, Debug, Deserialize)]
pub struct Refused {
    /// The joint.
    pub joint: String,
}

/// An effect that is declared not testable.
#[derive(Clone, Debug, Deserialize)]
pub struct NotTestable {
    /// The catalogue's name.
    pub effect: String,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
    /// The size from which it is detectable. If this and the following field are empty, it is detectable at no size.
    #[serde(default)]
    pub would_be_seen_above: BTreeMap<String, Option<f64>>,
    /// The size below which it is detectable.
    #[serde(default)]
    pub would_be_seen_below: BTreeMap<String, Option<f64>>,
}

/// Prediction errors of a joint (NRMSE).
#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub struct JointErrors {
    /// Standard deviation of the measured torque (N m or N).
    #[serde(default)]
    pub torque_std: f64,
    /// The error of the nominal model on the held-out recording.
    #[serde(default)]
    pub held_out_nrmse_nominal: Option<f64>,
    /// The error with the effects named.
    #[serde(default)]
    pub held_out_nrmse_augmented: Option<f64>,
    /// The error with a learned correction instead of effects.
    #[serde(default)]
    pub held_out_nrmse_learned: Option<f64>,
}

/// Root mean square distance of a joint's simulated motion from the recorded one (rad or m).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rollout {
    /// The distance with the nominal model.
    #[serde(rename = "nominal_rms_rad")]
    pub nominal: f64,
    /// The distance with the effects named.
    #[serde(rename = "augmented_rms_rad")]
    pub diagnosed: f64,
}
