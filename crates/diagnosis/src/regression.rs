//! Phase 2, regression: each hypothesis as columns of torque, their inner products, weighted least squares, resampling.

pub mod bootstrap;
pub mod columns;
pub mod fit;
pub mod table;
