//! Injected faults: recordings of a simulated arm with faults that its URDF does not have, and the sealed ground
//! truth.
//!
//! A [`Robot`] is the user's model. A [`Campaign`] decides which cases there are; [`conceal_case`] draws the faults of
//! one, [`conceal_effects`] injects given effects. Both simulate the plant with the faults in a 1 kHz position loop,
//! record what encoders and drives report, and return the [`Truth`]. [`write_case`] writes recordings and truth to
//! different places, and a [`Seal`] contains their hashes.
//!
//! ```
//! use faults::Campaign;
//!
//! let campaign = Campaign { seed: 7, cases: 12, lifelike: true, urdf_error: None };
//! let plans = campaign.plans();
//! assert_eq!(plans.len(), 12);
//! assert_eq!(plans.iter().filter(|plan| plan.effects.is_empty()).count(), 4);
//! assert_eq!(campaign.case(3), plans.get(3).cloned());
//! ```

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod campaign;
mod case;
mod case_machine;
mod conceal;
mod draw;
mod error;
mod expressed_share;
mod fault;
mod machine;
mod motion;
mod part;
mod pseudo_inertia;
mod record_again;
mod robot;
mod seal;
mod sensor;
mod site;
#[cfg(test)]
mod test_robots;
mod truth;
mod urdf_error;

pub use campaign::{Campaign, CasePlan};
pub use case::write_case;
pub use case_machine::{CaseMachine, Driven};
pub use conceal::{Concealment, RATES, Settings, conceal_case, conceal_effects};
pub use error::FaultError;
pub use fault::{catalogue, families, form_parameters, is_outside, more_parameters, outside};
pub use machine::{Inverse, LinkMotion, Measured, VelocityFilter};
pub use motion::{DURATION, PAUSE};
pub use record_again::record_again;
pub use robot::Robot;
pub use seal::{Program, Seal, SealError, SealedCase, sha256, sha256_of};
pub use truth::{Injected, Lifelike, Truth};
