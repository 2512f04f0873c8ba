//! What can be wrong with a robot description.

use std::path::PathBuf;

/// Why a URDF is not an [`crate::Arm`]. `place` names the line and the element.
#[derive(Debug, thiserror::Error)]
pub enum ArmError {
    /// The file cannot be read.
    #[error("{path}: cannot be read: {source}; give the path of a URDF file")]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The text is not a URDF.
    #[error("{path}{place}: {reason}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// `:line`, or nothing where the line is not known.
        place: String,
        /// What the parser found, and the remedy.
        reason: String,
    },
    /// The URDF is well formed but does not describe a serial arm with physical inertias.
    #[error("{path}:{line}: {element} {reason}; {remedy}")]
    Model {
        /// The file.
        path: PathBuf,
        /// The line of the element, from 1.
        line: usize,
        /// The element, as `joint "elbow"`.
        element: String,
        /// What was found: a verb and what follows it.
        reason: String,
        /// How to correct it.
        remedy: String,
    },
    /// An `<inertial>` element alone, without its URDF.
    #[error("the <inertial> cannot be read: {reason}")]
    Inertial {
        /// The parser's reason, or the attribute that is not a number.
        reason: String,
    },
}
