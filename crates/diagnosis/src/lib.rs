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

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod agreement;
mod data;
mod diagnose;
mod diagnosis;
mod error;
mod excitation;
mod findings;
mod lanes;
mod next;
mod options;
mod regression;
mod report;
mod search;
mod selection;
mod thresholds;
mod torque_lag;
mod trace;
mod words;

pub use agreement::{Agreement, agreement, searched};
pub use data::input::Input;
pub use data::signal::Kernel;
pub use data::statistics;
pub use data::used::worth_using;
pub use diagnose::diagnose;
pub use diagnosis::Diagnosis;
pub use error::DiagnosisError;
pub use excitation::{
    Determined, Excitation, ExcitationError, ExcitationOptions, JointUse, MotionLimits, Quality, excite, quality_of,
};
pub use findings::sentences::{Written, described, is_undetermined};
pub use options::{Options, Step, Wanted};
pub use report::*;
pub use thresholds::{LARGEST_CUTOFF, LEAST_ROWS, Thresholds, WORTH_HOLDING};
pub use torque_lag::WithoutLag;
pub use trace::{Action, Decision};
pub use words::{late, list};
