//! The comparisons that complete a diagnosis: a correction learned from the same recordings, and the simulated arm driven by the recorded torques.
//!
//! [`complete`] takes a diagnosis and its recordings and gives the report with every figure filled in that [`diagnosis`]
//! itself leaves open: the learned correction's held-out error, and how the simulated arm follows the recorded motion.
//! After it a report is ready to be printed or written. [`learned`] and [`rollout`] are its two parts, to be called alone.

mod complete;
mod error;
pub mod learned;
pub mod rollout;
mod statistics;

pub use complete::{Complete, complete};
pub use error::ValidateError;
