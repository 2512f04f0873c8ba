//! Phase 3, search: the effects, forms and sizes that together explain the training recordings.

pub mod candidate;
mod connection;
mod drag;
pub mod own_load;
pub mod physics;
pub mod plan;
pub mod problem;
pub mod refine;
pub mod scan;
pub mod study;
mod suggest;
