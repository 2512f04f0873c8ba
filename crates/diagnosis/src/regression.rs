//! Phase 2, regression: hypotheses as columns of torque, inner products, weighted least squares, background.

pub mod background;
pub mod bodies;
pub mod columns;
pub mod fit;
mod lazy;
pub mod small;
pub mod stated;
pub mod strengths;
pub mod table;
