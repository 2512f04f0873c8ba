//! From recordings to named effects: locates the residual of a rigid model, names the effects that the model omits, and
//! reports residuals that no effect in the catalogue explains.
//!
//! ```
//! use std::path::Path;
//!
//! use arm::Arm;
//! use diagnosis::{Input, Options, diagnose};
//! use recording::Recording;
//!
//! let folder = Path::new("../../examples/double_pendulum");
//! let arm = Arm::from_urdf(folder.join("robot.urdf"))?;
//! let (recording, _warnings) = Recording::read(&folder.join("r143339.csv.gz"))?.regular()?;
//! let inputs = [Input { name: "r143339", recording: &recording, held_out: false, before: false }];
//! let diagnosis = diagnose(&arm, &inputs, &Options::default(), &|_| ())?;
//! let names: Vec<&str> = diagnosis.effects.iter().map(|effect| effect.name()).collect();
//! assert!(names.contains(&"coulomb_friction"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
