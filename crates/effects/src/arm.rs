//! What is wrong with the arm's bodies, where it stands, or what pushes it.

mod contact;
mod inertial_scale;
mod link_error;
mod payload;
mod tilt;

pub use contact::{ExternalContact, columns as contact_columns, window as contact_window};
pub use inertial_scale::InertialScale;
pub use link_error::LinkInertialError;
pub use payload::{Payload, body};
pub use tilt::GravityMisalignment;
