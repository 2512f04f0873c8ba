//! The next experiment as others read it: the field `next_experiment` of a diagnosis.

use schemars::JsonSchema;
use serde::Serialize;

use crate::findings::report::Confusable;

/// The proposed motion, and what it distinguishes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NextExperiment {
    /// How long the motion takes (s); `None` if none would tell more.
    pub duration: Option<f64>,
    /// The confusions that it should resolve.
    pub separates: Vec<Separation>,
    /// The confusions that it leaves: most of them no motion within the limits resolves. With what would.
    pub not_separated: Vec<NotSeparated>,
    /// Effects that are not testable, and their detectable size with the motion.
    pub shows: Vec<Shows>,
    /// How far the motion goes, joint by joint.
    pub limits: Vec<JointLimits>,
}

/// The evidence (nats) for a finding against an alternative, before and after the motion. Above `needed`, the two are
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
    /// The evidence that distinguishes them (nats).
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
    /// The evidence that distinguishes them (nats).
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
    /// No motion within the limits sets them far enough apart.
    OutOfReach,
    /// Another motion would.
    AnotherMotion,
    /// The joint has an unexplained residual, so that the outcome of a motion cannot be predicted.
    Unexplained,
    /// On paper the recordings tell the two apart already, and they did not: the paper cannot be trusted on these two.
    NotForetold,
}

/// An effect that the motion shows at a smaller size than the recordings do.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Shows {
    /// The catalogue's name.
    pub effect: &'static str,
    /// The joint.
    pub joint: Option<String>,
    /// What its size is called.
    pub parameter: &'static str,
    /// The detectable size in the present recordings (of a torque limit: the largest); `None` if there is none.
    pub before: Option<f64>,
    /// The detectable size with the motion.
    pub after: f64,
}

/// What the motion needs of a joint, and what it may: the URDF's limits with a margin, or where it has none a multiple of
/// what the joint went through in the recordings.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct JointLimits {
    /// The joint.
    pub joint: String,
    /// Lowest and highest position (rad or m).
    pub position: [f64; 2],
    /// Where it may be (rad or m).
    pub position_allowed: [f64; 2],
    /// Largest speed (rad/s or m/s).
    pub velocity: f64,
    /// The speed that it may have (rad/s or m/s).
    pub velocity_allowed: f64,
    /// Largest torque by the model with the findings (N m or N).
    pub torque: f64,
    /// The torque that it may need (N m or N).
    pub torque_allowed: f64,
}
