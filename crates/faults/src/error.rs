//! What can be wrong with a case.

use std::path::PathBuf;

/// Why a case cannot be made or written.
#[derive(Debug, thiserror::Error)]
pub enum FaultError {
    /// An effect cannot be concealed as it is given.
    #[error("{effect}: {reason}")]
    Effect {
        /// The effect's name.
        effect: String,
        /// What was found, and the remedy.
        reason: String,
    },
    /// A setting of the recordings is none that a logger could have.
    #[error("{0}")]
    Setting(String),
    /// The robot's URDF is none of an arm.
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
        /// The joint that is furthest away.
        joint: String,
        /// How far (rad or m).
        by: f64,
        /// How far it may be.
        most: f64,
    },
    /// No draw of the case came out as it should.
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
    /// There is something where the case would go.
    #[error("{path} is there already; give another folder, nothing is overwritten")]
    Exists {
        /// The file or folder.
        path: PathBuf,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] recording::RecordingError),
    /// A folder cannot be made or moved.
    #[error("{path}: {reason}")]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        reason: std::io::Error,
    },
}
