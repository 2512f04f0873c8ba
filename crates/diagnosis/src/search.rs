//! Phase 3, search: which effects, in which form and of which size, explain the training recordings together.

pub mod candidate;
pub mod hypothesis;
pub mod physics;
pub mod plan;
pub mod problem;
pub mod refine;
pub mod scan;
pub mod study;
mod suggest;
