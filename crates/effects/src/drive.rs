//! What a drive adds to the torque, or does to it.

mod backlash;
mod coupling;
mod delay;
mod elasticity;
mod ripple;
mod rotor_inertia;
mod saturation;

pub use backlash::Backlash;
pub use coupling::{FARTHEST_COUPLED, TransmissionCoupling};
pub use delay::ActuationDelay;
pub use elasticity::JointElasticity;
pub use ripple::{TorqueRipple, columns as ripple_columns};
pub use rotor_inertia::RotorInertia;
pub use saturation::TorqueSaturation;
