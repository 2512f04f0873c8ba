//! Errors of a diagnosis.

use thiserror::Error;

/// Why recordings cannot be diagnosed.
#[derive(Debug, Error)]
pub enum DiagnosisError {
    /// A recording's joints are not the arm's.
    #[error("{recording}: its joints {found:?} are not the arm's {expected:?}")]
    Joints {
        /// The recording.
        recording: String,
        /// Its joints.
        found: Vec<String>,
        /// The arm's.
        expected: Vec<String>,
    },
    /// A known effect that does not fit the arm.
    #[error(transparent)]
    Known(#[from] torque::TorqueError),
    /// An effect to be fitted that the catalogue or the arm does not have.
    #[error("--only {effect}{}: {reason}", joint.as_ref().map(|joint| format!(" on {joint}")).unwrap_or_default())]
    Wanted {
        /// Its name.
        effect: String,
        /// Its joint.
        joint: Option<String>,
        /// What is wrong with it.
        reason: String,
    },
    /// The fit overflows: nothing can be said.
    #[error(
        "the fit of these recordings is not a finite number; check the units of their torques, and the masses and inertias of the URDF, \
         for values that are far too small or too large (testbed inspect --robot shows their ranges)"
    )]
    NotFinite,
    /// There is no recording to fit.
    #[error("no recording to train on")]
    NoTraining,
    /// All recordings are too short for the filter.
    #[error(
        "{recording}: {seconds:.2} s are too short for a filter at {cutoff} Hz, which needs {needed:.2} s in one piece; record at least \
         {} s of motion without gaps",
        crate::thresholds::LEAST_MOTION
    )]
    TooShort {
        /// The recording.
        recording: String,
        /// Its duration (s).
        seconds: f64,
        /// The cut-off (Hz).
        cutoff: f64,
        /// The least duration (s).
        needed: f64,
    },
}
