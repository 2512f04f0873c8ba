//! The score of diagnoses: ground truths against answers, as pure functions.
//!
//! A [`Tried`] case contains its [`Truth`] and the [`Answer`]s to it; [`score()`] computes the score of all cases.
//! [`Published`] contains the published values of a real robot, without a ground truth. Both kinds of files are read with this
//! crate's own types.
//!
//! ```
//! use scoring::{Answer, Tried, Truth, score};
//!
//! let truth: Truth = serde_json::from_str(
//!     r#"{"case": "one", "torque_noise": [0.01],
//!         "concealed": [{"effect": "torque_offset", "joint": "elbow", "offset": 0.4}]}"#,
//! )?;
//! let case = |answer| Tried {
//!     truth: truth.clone(),
//!     joints: vec!["elbow".to_owned()],
//!     answer,
//!     true_terms: None,
//!     wrong_term: None,
//!     tracking_over_exact: None,
//!     tracking_over_exact_without_lag: None,
//!     again: None,
//! };
//! // A program that finds nothing, and one that does not answer.
//! let score = score(&[case(Some(Answer::default())), case(None)]);
//! assert_eq!((score.cases, score.unanswered.len()), (2, 1));
//! # Ok::<(), serde_json::Error>(())
//! ```

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod answer;
mod calibration;
mod catalogue;
mod controls;
mod experiments;
mod intervals;
mod numbers;
mod outcome;
mod plain;
mod published;
mod rules;
mod score;
mod strict;
mod summary;
mod sums;
mod targets;
mod tried;
mod truth;

pub use answer::{
    Answer, EffectOnJoint, JointErrors, Named, NextExperiment, NotSeparated, NotTestable, Number, Refused, Rollout,
    Separated,
};
pub use calibration::{Bin, Calibration};
pub use catalogue::{BASELINE_WITH_DRIVES, parameters};
pub use controls::{HeldOut, WrongTerm, true_terms, wrong_term};
pub use experiments::{After, Confusion, Experiments, InCase};
pub use intervals::{Counted, quantile, wilson};
pub use numbers::{ScoredNumber, truth_value};
pub use outcome::{FalseName, Fate, Outcome, OutsideOutcome};
pub use plain::Plain;
pub use published::{
    Besides, Compared, Denied, Evidence, HeldOutErrors, Published, PublishedEffect, PublishedFate, PublishedNumber,
    PublishedOutcome, RobotScore, compared_parameters,
};
pub use rules::{LEAST_SHARE, Name};
pub use score::{Family, Figure, Score, Target};
pub use strict::{SIZE_WITHIN, Strict, StrictFamily, UrdfError, UrdfGroup};
pub use summary::{Curve, Errors, Measure, ParameterScore, SizeBin};
pub use sums::score;
pub use tried::{Again, Tried};
pub use truth::{Injected, Truth};
