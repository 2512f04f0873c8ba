//! `testbed prove`: physics concealed and sealed, diagnosed by processes that know nothing of it, opened and scored.

mod cases;
mod child;
mod command;
mod disturbance;
mod experiments;
mod published;
mod report;
mod rows;
mod shards;
mod tracking;
mod vault;
mod work;

pub use command::run;
pub use shards::Shard;
