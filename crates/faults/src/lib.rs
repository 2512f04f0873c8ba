//! Injected faults: recordings of a simulated arm with faults that its URDF leaves out, and the sealed truth about them.
//!
//! A [`Robot`] is what its user believes. A [`Campaign`] decides which cases there are; [`conceal_case`] draws one, [`conceal_effects`]
//! takes what it is given: either drives the plant in a 1 kHz position loop with faults in it, records what encoders and drives report,
//! and keeps the [`Truth`]. [`write_case`] puts the two in different places, a [`Seal`] holds their hashes.

mod again;
mod campaign;
mod case;
mod conceal;
mod draw;
mod error;
mod fault;
mod machine;
mod motion;
mod part;
mod robot;
mod seal;
mod sensor;
mod share;
#[cfg(test)]
mod test_robots;
mod tracking;
mod truth;

pub use again::record_again;
pub use campaign::{Campaign, CasePlan};
pub use case::write_case;
pub use conceal::{Concealment, RATES, Settings, conceal_case, conceal_effects};
pub use error::FaultError;
pub use fault::{catalogue, families, form_parameters, outside};
pub use machine::{Inverse, LinkMotion, Seen, VelocityFilter};
pub use motion::{DURATION, PAUSE};
pub use robot::Robot;
pub use seal::{Program, Seal, SealError, SealedCase, sha256, sha256_of};
pub use tracking::{CaseMachine, Driven};
pub use truth::{Injected, Truth};
