//! What acts on a joint by where it stands.

mod spring;

pub use spring::Spring;
