//! The report of a diagnosis: `testbed diagnose --json`, schema `testbed.diagnosis/1`.

use std::collections::BTreeMap;

use arm::PARAMETERS_PER_LINK;
use effects::{CATALOGUE, Effect};
use schemars::JsonSchema;
use serde::Serialize;

mod change;
mod dependence;
mod different_load;
mod doubt;
mod held_out_friction;
mod joint_fit;
mod next_experiment;
mod not_diagnosed;
mod recording_names;
mod schema;
mod verdict;

pub use change::Change;
pub use dependence::{Axis, Dependence};
pub use different_load::DifferentLoad;
pub use doubt::Doubt;
pub use held_out_friction::HeldOutFriction;
pub use joint_fit::JointFit;
pub use next_experiment::{JointLimits, NextExperiment, NotSeparated, Obstacle, Separation, Shows};
pub use not_diagnosed::NotDiagnosed;
pub use recording_names::{RecordingNames, UsedPart};
pub use schema::json_schema;
pub use verdict::Verdict;

/// The values of [`Finding::sensor`].
pub(crate) const MOTOR_CURRENT: &str = "motor_current";
pub(crate) const SECOND_ENCODER: &str = "second_encoder";

/// The value of [`Report::schema`].
pub(crate) const SCHEMA: &str = "testbed.diagnosis/1";

/// The result of a diagnosis. Maps are keyed by the URDF joint's name.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "testbed.diagnosis/1")]
pub struct Report {
    /// `testbed.diagnosis/1`.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: &'static str,
    /// The robot's name in its URDF.
    pub robot: String,
    /// The recordings, with the names that the user gave.
    pub recordings: RecordingNames,
    /// The half-power frequency of the low-pass filter through which the recordings were compared (Hz).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cutoff: Option<f64>,
    /// The lag of all recorded torques behind the positions that was removed (s); negative if they were ahead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_lag: Option<f64>,
    /// The lags of the torques of single recordings beyond `torque_lag`, by the recordings' names, which were removed (s).
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub own_torque_lags: BTreeMap<String, f64>,
    /// The verdict in one word.
    pub verdict: Verdict,
    /// Doubts about the units, signs, order or zeros of the recordings, with their remedies. No effect is searched before
    /// they are corrected. Empty for every other verdict.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<Doubt>,
    /// What contradicts the URDF in the recordings as they were read, and does not prevent a diagnosis: limits that are exceeded, or a
    /// sign, zero or order that may be wrong.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Doubt>,
    /// The effects found, the largest share first.
    pub findings: Vec<Finding>,
    /// Structured residuals that no effect in the catalogue explains.
    pub unexplained: Vec<Unexplained>,
    /// Joints whose torque channels hold no usable torque. What is said about the recordings is about the other joints.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_diagnosed: Vec<NotDiagnosed>,
    /// Effects that are not testable with these recordings.
    pub not_observable: Vec<NotObservable>,
    /// The reasons why the data are not sufficient for a diagnosis; empty if they are.
    pub not_enough_data: Vec<String>,
    /// Where the nominal model differs from the recordings, joint by joint.
    pub located: Vec<Located>,
    /// How well each joint's torque is predicted, without joints that have none, or none in the held-out recordings.
    pub fit: BTreeMap<String, JointFit>,
    /// What changed since the recordings from before, if there are such recordings: places and effects as noun phrases. The same change
    /// on several joints is one phrase.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub changed: Option<Vec<String>>,
    /// The load at the tip that only some of the recordings have, if there is one. No model of one arm holds for all of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub different_load: Option<DifferentLoad>,
    /// The joints whose friction in a held-out recording is a multiple of that in the training recordings; empty if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub held_out_friction: Vec<HeldOutFriction>,
    /// The estimates of the links' inertial parameters, by the joint before the link; empty if the links do not differ from the
    /// URDF's.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub inertials: BTreeMap<String, LinkInertials>,
    /// The constant torques that correct the joints and that no finding names: small offsets of the torque sensors of most joints, and
    /// constants that may be a part of what is unexplained on their joint. Empty if the recordings need none.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub constant_torques: BTreeMap<String, Parameter>,
    /// How closely the simulated arm follows the recorded one; empty where it was not simulated.
    pub rollout: BTreeMap<String, JointRollout>,
    /// The motion that best distinguishes the remaining alternatives, if one was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next_experiment: Option<NextExperiment>,
    /// Whether only requested effects were fitted, and no others searched (`--only`).
    #[serde(skip)]
    pub is_requested: bool,
}

/// The names of all effects.
fn effect_names() -> Vec<&'static str> {
    CATALOGUE.iter().map(|spec| spec.name).collect()
}

/// One effect named.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Finding {
    /// The catalogue's name.
    #[schemars(extend("examples" = effect_names()))]
    pub effect: &'static str,
    /// The joint, or `None` for the whole arm.
    pub joint: Option<String>,
    /// The joint whose motion it depends on (transmission coupling).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other: Option<String>,
    /// Its parameters.
    pub parameters: BTreeMap<&'static str, Parameter>,
    /// The probability that this effect is present on this joint; `None` where it was not calibrated: for findings of a second sensor or
    /// of a held-out recording alone, for an effect that another one brings along, and where only requested effects were fitted.
    pub probability: Option<f64>,
    /// Standard deviation of its torque over that of the measured torque, training recordings; the largest of the joints. Of a
    /// spring between two encoders: that of the encoders' difference over the joint's range.
    pub share: f64,
    /// The share of each joint that it acts on.
    pub share_by_joint: BTreeMap<String, f64>,
    /// Relative reduction of the NRMSE on recordings that the finding was not fitted to; `None` if none of them tests it. Of a
    /// finding between two sensors: of their difference.
    pub held_out_gain: Option<f64>,
    /// Effects that explain nearly as much in its place.
    pub confusable_with: Vec<Confusable>,
    /// Pairs of effects that explain nearly as much together as the finding does, and neither alone.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub confusable_with_pairs: Vec<[Confusable; 2]>,
    /// Where it acts.
    #[serde(rename = "where")]
    pub place: Place,
    /// One sentence for a person.
    pub sentence: String,
    /// Whether it is present since the recordings from before.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub since_before: bool,
    /// How it changed since the recordings from before; `None` if it did not. An effect that was `removed`, or the part by which one
    /// was `reduced`, is in those recordings only, and the corrected model does not contain it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub change: Option<Change>,
    /// The further sensor that shows it, where the torque does not: `motor_current` (friction between the motor and a torque sensor) or
    /// `second_encoder`. Such a finding may stand beside another of the same name on the joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<&'static str>,
    /// Whether it corrects the model of the measured torque; not if another sensor shows it (a second encoder, motor currents).
    #[serde(skip)]
    pub corrects: bool,
    /// The effect in the form of `--known` and of the corrected model.
    #[serde(skip)]
    pub as_effect: Effect,
}

impl Finding {
    /// Whether it acts in the recordings of today, and not only in those from before a change.
    pub fn acts_today(&self) -> bool {
        !self.change.is_some_and(Change::is_past)
    }

    /// Whether only the motor's current shows it: friction between the motor and a torque sensor.
    pub fn is_motor_side(&self) -> bool {
        self.sensor == Some(MOTOR_CURRENT)
    }

    /// A finding of `effect` with only its name and joint.
    pub fn of(effect: Effect) -> Self {
        Self {
            effect: effect.name(),
            joint: effect.joint().map(str::to_owned),
            other: None,
            parameters: BTreeMap::new(),
            probability: None,
            share: 0.0,
            share_by_joint: BTreeMap::new(),
            held_out_gain: None,
            confusable_with: Vec::new(),
            confusable_with_pairs: Vec::new(),
            place: Place::default(),
            sentence: String::new(),
            since_before: false,
            change: None,
            sensor: None,
            corrects: false,
            as_effect: effect,
        }
    }
}

/// A number with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Parameter {
    /// The estimate.
    pub value: f64,
    /// Its 95 % interval; `null` at an open end. Of the `relative` error of all links, it is the strengths that were tried next to the
    /// best one; of a contact's `start` and `duration`, ±0.1 s and ±0.2 s, the resolution of the search.
    #[schemars(with = "[Option<f64>; 2]")]
    pub ci95: [f64; 2],
    /// SI unit at the joint.
    pub unit: &'static str,
}

/// An alternative of a finding.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Confusable {
    /// The catalogue's name.
    pub effect: &'static str,
    /// The joint, or `None` for the whole arm.
    pub joint: Option<String>,
}

/// Where a finding acts.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct Place {
    /// Stretches of time (s); the whole time if empty.
    pub time: Vec<[f64; 2]>,
    /// The recording of `time`, if it is within one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recording: Option<String>,
    /// Region of state, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<String>,
}

/// A structured residual that no effect in the catalogue explains.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Unexplained {
    /// The joint.
    pub joint: String,
    /// Standard deviation of the structured residual over that of the measured torque.
    pub share: f64,
    /// `own_position`, `own_speed`, `load`, `time`, `history`, `other_joint:NAME`, …; empty if no tried regressor predicts it. In
    /// a diagnosis without findings, where no tried regressor predicts anything, it is the state in which the residual is largest.
    #[schemars(with = "Vec<String>")]
    pub depends_on: Vec<Dependence>,
    /// Stretches of time where it is largest; the whole time if empty.
    pub time: Vec<TimeWindow>,
    /// The experiment that narrows it down.
    pub next: String,
}

/// An effect that is not testable with the recordings.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct NotObservable {
    /// The catalogue's name.
    #[schemars(extend("examples" = effect_names()))]
    pub effect: &'static str,
    /// The joint, or `None` for the whole arm.
    pub joint: Option<String>,
    /// The reason.
    pub because: String,
    /// The size from which it is detectable.
    pub would_be_seen_above: BTreeMap<&'static str, f64>,
    /// The size below which it is detectable, for a limit or a stiffness.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub would_be_seen_below: BTreeMap<&'static str, f64>,
}

/// Where a joint's nominal residual is larger than the errors of noise and filtering.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Located {
    /// The joint.
    pub joint: String,
    /// RMS of the nominal residual over that of the errors of noise and filtering.
    pub over_noise: f64,
    /// The part of the residual's power that repeats with the motion; `None` without repetitions.
    pub repeatable: Option<f64>,
    /// Regions of state where it is largest, in words, with the RMS there over the torque's standard deviation.
    pub regions: Vec<Region>,
    /// Stretches of time where it is largest.
    pub time: Vec<TimeWindow>,
}

/// A stretch of one recording.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TimeWindow {
    /// The recording, with the name that the user gave.
    pub recording: String,
    /// Start (s), on the recording's clock.
    pub start: f64,
    /// End (s), on the recording's clock.
    pub end: f64,
}

/// A region of state.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Region {
    /// `near_reversal`, `speed`, `load`, `angle`, `elapsed_time`.
    #[schemars(with = "String")]
    pub axis: Axis,
    /// Its bounds, in the axis' unit.
    pub range: [f64; 2],
    /// RMS of the nominal residual there, over the torque's standard deviation.
    pub residual: f64,
    /// RMS of the augmented residual there, over the torque's standard deviation.
    pub residual_augmented: f64,
}

/// The estimate of a link's inertial parameters.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LinkInertials {
    /// The URDF's mass (kg).
    pub nominal_mass: f64,
    /// Mass, centre of mass (m, in the link's frame), moments of inertia about it (kg m²), with 95 % intervals.
    pub parameters: BTreeMap<&'static str, Parameter>,
    /// For each of m, m c (x, y, z) and Ixx … Izz about the link frame's origin, the relative reduction of the prior's variance
    /// by the recordings: 1 where they determine the parameter, 0 where only the prior does.
    pub determined: [f64; PARAMETERS_PER_LINK],
    /// The standard deviation of the torque of the change over that of the measured torque, the largest of the joints.
    pub share: f64,
}

/// How closely the simulated joint follows the recorded one.
#[derive(Clone, Copy, Debug, Default, Serialize, JsonSchema)]
pub struct JointRollout {
    /// RMS distance, nominal model (rad or m).
    pub nominal_rms_rad: f64,
    /// RMS distance, with the named effects (rad or m).
    pub augmented_rms_rad: f64,
}

/// The data of the figures: all recordings on the diagnosis' own grid.
#[derive(Clone, Debug, Default)]
pub struct Traces {
    /// The recordings.
    pub recordings: Vec<Trace>,
}

/// One recording; signals are `[joint][row]`, effects `[finding][joint][row]` (empty where it does not act).
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// The file, with the name that the user gave.
    pub name: String,
    /// Whether it is held out.
    pub held_out: bool,
    /// Time (s).
    pub time: Vec<f64>,
    /// Position (rad or m).
    pub q: Vec<Vec<f64>>,
    /// Velocity (rad/s or m/s).
    pub qd: Vec<Vec<f64>>,
    /// Acceleration (rad/s² or m/s²).
    pub qdd: Vec<Vec<f64>>,
    /// Measured torque, filtered (N m or N).
    pub tau: Vec<Vec<f64>>,
    /// Measured minus nominal torque (N m or N).
    pub residual: Vec<Vec<f64>>,
    /// Measured torque minus nominal torque and named effects (N m or N).
    pub residual_augmented: Vec<Vec<f64>>,
    /// Measured torque minus that of the exported model: the links' inertial parameters and the named effects, without the
    /// background's corrections of friction and torque constants (N m or N).
    pub residual_exported: Vec<Vec<f64>>,
    /// The torque of each finding (N m or N).
    pub effects: Vec<Vec<Vec<f64>>>,
    /// Whether the joint moves. Rows at rest were not fitted.
    pub moving: Vec<Vec<bool>>,
}
