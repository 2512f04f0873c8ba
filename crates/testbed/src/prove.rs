//! `testbed prove`: injected faults, sealed, diagnosed by processes without access to the ground truth, opened and scored.

mod case_paths;
mod cases;
mod child;
mod command;
mod disturbance;
mod experiments;
mod given;
mod proof;
mod published;
mod report;
mod rows;
mod shards;
mod tracking;
mod tracking_step;
mod vault;
mod work;

pub use command::run;
