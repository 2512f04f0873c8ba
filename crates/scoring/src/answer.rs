//! A diagnosis as others read it: the fields of `testbed.diagnosis/1` that are scored.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// A diagnosis; what is not scored is not read.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct Answer {
    /// In one word.
    #[serde(default)]
    pub verdict: String,
    /// The effects named.
    pub findings: Vec<Named>,
    /// The joints with structure that was given no name.
    #[serde(default)]
    pub unexplained: Vec<Refused>,
    /// What the recordings could not show.
    #[serde(default)]
    pub not_observable: Vec<DeclaredUnseen>,
    /// Errors of prediction, by joint.
    #[serde(default)]
    pub fit: BTreeMap<String, JointErrors>,
    /// How far the simulated arm goes from the recorded motion, by joint.
    #[serde(default)]
    pub rollout: BTreeMap<String, Rollout>,
    /// The motion it proposes, where it was asked for one.
    #[serde(default)]
    pub next_experiment: Option<NextExperiment>,
}

/// A proposed experiment.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct NextExperiment {
    /// The confusions that it should resolve.
    pub separates: Vec<Separated>,
    /// Those that it leaves.
    pub not_separated: Vec<NotSeparated>,
}

/// A confusion that a motion should resolve.
#[derive(Clone, Debug, Deserialize)]
pub struct Separated {
    /// What was named.
    pub finding: EffectOnJoint,
    /// What it could be instead.
    pub rival: EffectOnJoint,
}

/// A confusion that it leaves.
#[derive(Clone, Debug, Deserialize)]
pub struct NotSeparated {
    /// What was named.
    pub finding: EffectOnJoint,
    /// What it could be instead.
    pub rival: EffectOnJoint,
    /// Why, in a word.
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
    /// The joint that turns this one's drive, too, of a coupling.
    #[serde(default)]
    pub other: Option<String>,
    /// Its numbers.
    #[serde(default)]
    pub parameters: BTreeMap<String, Number>,
    /// How likely it is said to be right.
    #[serde(default)]
    pub probability: Option<f64>,
    /// Its part of the joint's torque.
    #[serde(default)]
    pub share: f64,
    /// What it could be instead.
    #[serde(default)]
    pub confusable_with: Vec<EffectOnJoint>,
    /// In words.
    #[serde(default)]
    pub sentence: String,
}

/// An effect, and where it is.
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
    /// Whether the interval holds `value`; one that is open at both ends says nothing, and holds nothing.
    pub fn holds(&self, value: f64) -> bool {
        let [low, high] = self.ci95;
        (low.is_some() || high.is_some()) && low.is_none_or(|low| low <= value) && high.is_none_or(|high| value <= high)
    }
}

/// Structure that was given no name.
#[derive(Clone, Debug, Deserialize)]
pub struct Refused {
    /// The joint.
    pub joint: String,
}

/// An effect that is said not to show.
#[derive(Clone, Debug, Deserialize)]
pub struct DeclaredUnseen {
    /// The catalogue's name.
    pub effect: String,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
    /// The size from which it would have been seen; none at all if this and the other are empty.
    #[serde(default)]
    pub would_be_seen_above: BTreeMap<String, Option<f64>>,
    /// The size below which it would have been seen.
    #[serde(default)]
    pub would_be_seen_below: BTreeMap<String, Option<f64>>,
}

/// Errors of prediction of a joint (NRMSE).
#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub struct JointErrors {
    /// Standard deviation of the measured torque (N m or N).
    #[serde(default)]
    pub torque_std: f64,
    /// Of the model as it was given, on the recording held out.
    #[serde(default)]
    pub held_out_nrmse_nominal: Option<f64>,
    /// With the effects named.
    #[serde(default)]
    pub held_out_nrmse_augmented: Option<f64>,
    /// With a learned correction instead.
    #[serde(default)]
    pub held_out_nrmse_learned: Option<f64>,
}

/// Root mean square distance of a joint's simulated motion from the recorded one (rad or m).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rollout {
    /// Of the model as it was given.
    #[serde(rename = "nominal_rms_rad")]
    pub nominal: f64,
    /// With the effects named.
    #[serde(rename = "augmented_rms_rad")]
    pub diagnosed: f64,
}
