//! Friction in the drive and its gear.

mod asymmetry;
mod coulomb;
mod drag;
mod load_dependent;
mod stribeck;
mod thermal;
mod viscous;

pub use asymmetry::FrictionAsymmetry;
pub use coulomb::CoulombFriction;
pub use drag::QuadraticDrag;
pub use load_dependent::LoadDependentFriction;
pub use stribeck::{StribeckFriction, velocity as stribeck_velocity};
pub use thermal::{FASTEST_WARMING, ThermalDrift};
pub use viscous::ViscousFriction;
