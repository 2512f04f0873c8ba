//! Errors of cases.

use std::path::PathBuf;

/// Why a case cannot be made or written.
#[derive(Debug, thiserror::Error)]
pub enum FaultError {
    /// An effect cannot be injected as it is given.
    #[error("{effect}: {reason}")]
    Effect {
        /// The effect's name.
        effect: String,
        /// The description, with the remedy.
        reason: String,
    },
    /// A setting of the recordings is impossible.
    #[error("{0}")]
    Setting(String),
    /// The robot's URDF contains no arm.
    #[error(transparent)]
    Arm(#[from] arm::ArmError),
    /// The plant cannot be built.
    #[error(transparent)]
    Plant(#[from] plant::PlantError),
    /// The position loop does not hold the machine on its reference.
    #[error(
        "joint \"{joint}\" leaves its reference by {by:.2} rad or m, more than {most} rad or m; make the effects smaller"
    )]
    Lost {
        /// The joint with the largest distance.
        joint: String,
        /// The distance (rad or m).
        by: f64,
        /// The allowed distance.
        most: f64,
    },
    /// No draw of the case was accepted.
    #[error(
        "{case}: {effects} could not be injected on {robot} so that it is detectable and the position loop is stable; leave the robot out, or take another seed"
    )]
    NotExpressed {
        /// The case.
        case: String,
        /// The effects.
        effects: String,
        /// The robot's name.
        robot: String,
    },
    /// The case exists already.
    #[error("{path} is there already; give another folder, nothing is overwritten")]
    Exists {
        /// The file or folder.
        path: PathBuf,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] recording::RecordingError),
    /// A folder cannot be made or moved.
    #[error("{path}: cannot be written: {reason}; {}", recording::write_remedy(reason))]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The reason.
        reason: std::io::Error,
    },
}
