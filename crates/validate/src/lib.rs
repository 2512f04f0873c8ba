//! The comparisons that complete a diagnosis: a correction learned from the same recordings, and the simulated arm driven by the recorded torques.
//!
//! [`complete`](complete()) takes a diagnosis and its recordings, and returns the report with the figures that [`diagnosis`] does not
//! compute: the held-out error of the learned correction, and how closely the simulated arm follows the recorded motion. Then
//! the report is ready to be printed or written. [`learned`] and [`rollout`] are its two parts.
//!
//! ```
//! use arm::Arm;
//! use effects::{Effect, friction::COULOMB_FRICTION};
//! use recording::Recording;
//! use validate::rollout::{RolloutOptions, rollout};
//!
//! let folder = "../../examples/double_pendulum";
//! let arm = Arm::from_urdf(format!("{folder}/robot.urdf"))?;
//! let (recording, _) = Recording::read(format!("{folder}/r143339.csv.gz").as_ref())?.regular()?;
//! let friction = |joint: &str, level: f64| Effect::of(&COULOMB_FRICTION).on(joint).with("level", level);
//! let found = [friction("joint1", 0.2), friction("joint2", 0.18)];
//! let compared = rollout(&arm, &[], &found, &recording, &RolloutOptions::default())?;
//! assert!(compared.joints[0].augmented_rms_rad < 0.5 * compared.joints[0].nominal_rms_rad);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod complete;
mod error;
pub mod learned;
mod nearest_body;
pub mod rollout;

pub use complete::{Complete, complete};
pub use error::ValidateError;
pub use nearest_body::{LEAST_MASS, nearest_body};
