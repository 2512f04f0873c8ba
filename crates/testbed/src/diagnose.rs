//! `testbed diagnose`: which physics the model leaves out, as a table, a page, a timeline, and a corrected model.

mod command;
pub mod effect_file;
mod held;
mod inputs;
mod mjcf_file;
mod next_file;
mod notes;
#[cfg(feature = "viewer")]
mod rerun;
mod residuals_file;
mod trace_file;
pub mod urdf_file;
mod urdf_friction;

pub use command::run;
