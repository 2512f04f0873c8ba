//! Phase 5, findings: rivals, places, what is not testable with these recordings, what stays unexplained, the verdict.

pub mod conclusion;
pub mod dual_sensor;
pub mod found;
pub mod identified;
pub mod inertials;
pub mod locate;
pub mod observability;
pub mod report;
pub mod rivals;
pub mod schema;
pub mod sentences;
pub mod traces;
pub mod transients;
pub mod verdict;
