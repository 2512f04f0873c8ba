//! `testbed diagnose`: the effects that a model omits, as a table, a page, a timeline, and a corrected model.

mod command;
mod next_file;
mod outputs;
#[cfg(feature = "viewer")]
mod rerun;
mod residuals_file;
mod trace_file;

pub use command::run;
