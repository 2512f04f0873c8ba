//! Phase 2, regression: each hypothesis as columns of torque, their inner products, weighted least squares, resampling.

pub mod background;
pub mod bodies;
pub mod bootstrap;
pub mod columns;
pub mod fit;
pub mod small;
pub mod table;
