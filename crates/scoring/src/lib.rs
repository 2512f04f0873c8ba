//! The score of diagnoses: truths against answers, as pure functions.
//!
//! A [`Tried`] case holds its [`Truth`] and the [`Answer`]s to it; [`score()`] adds up what came of all. [`Published`] is what publishers
//! say of a real robot, where nobody made a truth. Both kinds of file are read through this crate's own types.

mod answer;
mod calibration;
mod controls;
mod experiment;
mod intervals;
mod outcome;
mod plain;
mod published;
mod rules;
mod score;
mod sizes;
mod summary;
mod targets;
mod truth;

pub use answer::{Answer, Fit, Left, Named, Next, Number, Other, Refused, Rollout, Told, Unseen};
pub use calibration::{Bin, Calibration};
pub use controls::{HeldOut, WrongTerm, true_terms, wrong_term};
pub use experiment::{After, Again, Confusion, Experiments, InCase};
pub use intervals::{Counted, quantile, wilson};
pub use outcome::{FalseName, Fate, Outcome, OutsideOutcome};
pub use plain::Plain;
pub use published::{
    Besides, Compared, Denied, Evidence, HeldOutErrors, Published, PublishedNumber, RobotScore, Said, SaidFate,
    SaidOutcome, compared_parameters,
};
pub use rules::{LEAST_SHARE, Name};
pub use score::{Family, Score, Tried, score};
pub use sizes::Sized;
pub use summary::{Curve, Errors, ParameterScore, SizeBin};
pub use targets::Target;
pub use truth::{Injected, Truth};
