//! Errors of the comparisons.

use plant::PlantError;
use torque::TorqueError;

/// Why a correction cannot be learned or an arm cannot be simulated.
#[derive(Debug, thiserror::Error)]
pub enum ValidateError {
    /// There is no row to learn from, or a regression failed.
    #[error("learned correction: {0}")]
    Learning(#[source] TorqueError),
    /// The recording lacks a joint of the arm.
    #[error("joint \"{joint}\" is not in the recording, so that it cannot be simulated")]
    Joint {
        /// The joint's name.
        joint: String,
    },
    /// The recording's period or the plant's step is not positive.
    #[error("the recording's period is {period} s; it must be positive")]
    Period {
        /// The recording's period (s).
        period: f64,
    },
    /// No segment of the recording is long enough.
    #[error("no gap-free part of the recording is as long as a rollout window, {window} s")]
    Window {
        /// The window's length (s).
        window: f64,
    },
    /// There is nothing to compare.
    #[error("an arm leaves every window within one step")]
    Left,
    /// An effect does not fit the arm.
    #[error("{which} cannot be simulated: {source}")]
    Effects {
        /// Which of the two arms.
        which: &'static str,
        /// The error of the effect.
        source: TorqueError,
    },
    /// The effects take all inertia from a joint, such as a body that is not mounted from a URDF whose last link is lighter.
    #[error(
        "{which} cannot be simulated: they leave joint \"{joint}\" no inertia to move; correct the links beyond it in the URDF"
    )]
    Emptied {
        /// Which of the two arms.
        which: &'static str,
        /// The joint's name.
        joint: String,
    },
    /// The plant cannot simulate the arm.
    #[error("{which} cannot be simulated: {source}")]
    Plant {
        /// Which of the two arms.
        which: &'static str,
        /// The error of the plant.
        source: PlantError,
    },
}
