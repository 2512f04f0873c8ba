//! `testbed diagnose`: which physics the model leaves out, as a table, a page, a timeline, and a corrected model.

mod command;
pub mod effect_file;
mod inputs;
mod next_file;
mod next_words;
pub mod numbers;
pub mod page;
#[cfg(feature = "viewer")]
mod rerun;
#[cfg(test)]
mod sample;
mod terminal;
pub mod urdf_file;
mod words;

pub use command::run;
