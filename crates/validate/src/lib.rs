//! The comparisons that complete a diagnosis: a correction learned from the same recordings, and the simulated arm driven by the recorded torques.
//!
//! [`complete`](complete()) takes a diagnosis and its recordings, and returns the report with the figures that [`diagnosis`] does not
//! compute: the held-out error of the learned correction, and how closely the simulated arm follows the recorded motion. Then
//! the report is ready to be printed or written. [`learned`] and [`rollout`] are its two parts.

mod complete;
mod error;
pub mod learned;
pub mod rollout;
mod statistics;

pub use complete::{Complete, complete};
pub use error::ValidateError;
