//! From recordings to named effects: locates the residual of a rigid model, names the effects that the model omits, and
//! reports residuals that no effect in the catalogue explains.

mod data;
mod diagnose;
mod error;
mod excitation;
mod findings;
mod next;
mod regression;
mod search;
mod selection;
mod thresholds;
mod trace;

pub use data::motion::Input;
pub use data::used::{WORTH_HOLDING, worth_using};
pub use diagnose::{Diagnosis, Options, Step, diagnose};
pub use error::DiagnosisError;
pub use excitation::{
    Determined, Excitation, ExcitationError, ExcitationOptions, JointUse, MotionLimits, Quality, excite, quality_of,
};
pub use findings::report::*;
pub use findings::schema::json_schema;
pub use findings::sentences::described;
pub use next::{JointLimits, NextExperiment, NotSeparated, Obstacle, Separation, Shows};
pub use search::hypothesis::Wanted;
pub use thresholds::{LEAST_ROWS, Thresholds};
pub use trace::{Action, Decision};
