//! Phase 5, findings: alternatives, location of the residual, effects that are not testable, unexplained residuals, the
//! verdict.

mod at_rest;
pub mod conclusion;
pub mod dual_sensor;
pub mod found;
mod gaps;
mod held_out_friction;
pub mod inertials;
pub mod locate;
pub mod observability;
mod other_friction;
mod own_friction;
pub mod sentences;
pub mod traces;
pub mod transients;
pub mod verdict;
