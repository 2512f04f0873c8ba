//! Physics concealed in recordings, the sealed truth about it, and what a diagnosis of them is worth.
//!
//! A [`Robot`] is what its user believes. A [`Campaign`] decides which cases there are; [`conceal_case`] draws one, [`conceal_effects`]
//! takes what it is given: either drives the plant in a 1 kHz position loop with physics in it that the URDF leaves out, records what
//! encoders and drives report, and keeps the [`Truth`]. [`write_case`] puts the two in different places.

mod campaign;
mod case;
mod conceal;
mod draw;
mod error;
mod law;
mod machine;
mod motion;
mod physics;
mod robot;
mod sensor;
mod share;
#[cfg(test)]
mod test_robots;
mod truth;

pub use campaign::{Campaign, CasePlan};
pub use case::write_case;
pub use conceal::{Concealment, RATES, Settings, conceal_case, conceal_effects};
pub use draw::FAMILIES;
pub use error::ProofError;
pub use motion::{DURATION, PAUSE};
pub use physics::{EFFECTS, UNKNOWN, form_parameters, forms};
pub use robot::Robot;
pub use truth::{Concealed, Truth};
