//! The next experiment in the report: the field `next_experiment` of a diagnosis.

use schemars::JsonSchema;
use serde::Serialize;

use super::Confusable;

/// The proposed motion, and what it distinguishes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NextExperiment {
    /// The duration of the motion (s); `None` if no motion gives more information.
    pub duration: Option<f64>,
    /// The confusions that it is predicted to resolve.
    pub separates: Vec<Separation>,
    /// The confusions that it does not resolve, with the experiments that do.
    pub not_separated: Vec<NotSeparated>,
    /// Effects that are not testable, with their detectable size after the motion.
    pub shows: Vec<Shows>,
    /// The demands of the motion, joint by joint.
    pub limits: Vec<JointLimits>,
}

/// The evidence (nats) for a finding against an alternative, before and after the motion. From `needed` on, the two are reliably
/// distinguished.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Separation {
    /// The finding.
    pub finding: Confusable,
    /// The alternative.
    pub rival: Confusable,
    /// The evidence in the present recordings (nats).
    pub before: f64,
    /// The evidence with the motion (nats).
    pub after: f64,
    /// The evidence that reliably distinguishes them (nats).
    pub needed: f64,
}

/// A finding and an alternative that the motion does not distinguish.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NotSeparated {
    /// The finding.
    pub finding: Confusable,
    /// The alternative.
    pub rival: Confusable,
    /// The largest evidence of all motions that were tried (nats).
    pub best: f64,
    /// The evidence that reliably distinguishes them (nats).
    pub needed: f64,
    /// The reason in one word.
    pub kind: Obstacle,
    /// The reason in a sentence.
    pub because: String,
    /// The experiment that distinguishes them.
    pub instead: String,
}

/// Why a motion does not distinguish two effects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Obstacle {
    /// The two are the same torque in every motion.
    SameTorque,
    /// No motion within the limits distinguishes them.
    OutOfReach,
    /// Another motion distinguishes them.
    AnotherMotion,
    /// The joint has an unexplained residual, so that the outcome of a motion cannot be predicted.
    Unexplained,
    /// No outcome is predicted: the alternative is a correction of the inertial parameters of a link or of all links, or multiplies masses or
    /// torques beside such corrections, or the prediction fails on the present recordings, because it states that they already
    /// distinguish the two.
    #[serde(rename = "not_foretold")]
    NoPrediction,
}

/// An effect that the motion makes detectable at a smaller size than the recordings do.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Shows {
    /// The catalogue's name.
    pub effect: &'static str,
    /// The joint.
    pub joint: Option<String>,
    /// The name of its size.
    pub parameter: &'static str,
    /// The detectable size in the present recordings (of a torque limit: the largest); `None` if there is none.
    pub before: Option<f64>,
    /// The detectable size with the motion.
    pub after: f64,
}

/// The demands of the motion on a joint, and the allowed values: the URDF's limits with a margin, or a multiple of the values
/// in the recordings where the URDF has none.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct JointLimits {
    /// The joint.
    pub joint: String,
    /// Lowest and highest position (rad or m).
    pub position: [f64; 2],
    /// The allowed positions (rad or m).
    pub position_allowed: [f64; 2],
    /// Largest speed (rad/s or m/s).
    pub velocity: f64,
    /// The allowed speed (rad/s or m/s).
    pub velocity_allowed: f64,
    /// Largest torque by the model with the findings (N m or N).
    pub torque: f64,
    /// The allowed torque (N m or N).
    pub torque_allowed: f64,
}

impl JointLimits {
    /// Before the motion begins; the allowed positions are within `room` of `middle`.
    pub(crate) fn at_rest(joint: &str, (middle, room): (f64, f64), velocity_allowed: f64, torque_allowed: f64) -> Self {
        Self {
            joint: joint.to_owned(),
            position: [f64::INFINITY, f64::NEG_INFINITY],
            position_allowed: [middle - room, middle + room],
            velocity: 0.0,
            velocity_allowed,
            torque: 0.0,
            torque_allowed,
        }
    }

    /// Includes a state of the motion and its torque in the demands.
    pub(crate) fn include(&mut self, q: f64, qd: f64, torque: f64) {
        self.position = [self.position[0].min(q), self.position[1].max(q)];
        self.velocity = self.velocity.max(qd.abs());
        self.torque = self.torque.max(torque.abs());
    }
}
