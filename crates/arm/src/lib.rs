//! The rigid arm: URDF to [`Arm`], kinematics, inverse and forward dynamics, mass matrix, torque regressor.
//!
//! An [`Arm`] is immutable; every algorithm writes into a [`Workspace`] that the caller keeps, so that no call
//! allocates. Joint space is `q`, `qd`, `qdd`, `tau`: positions (rad or m), velocities, accelerations, and joint
//! torques (N m) or forces (N), with one entry per moving joint from base to tip.
//!
//! A link's frame is its URDF frame, at its joint. Poses are written `a_from_b`. In spatial vectors the angular part
//! comes first.

mod batch;
mod chain;
mod derivatives;
mod energy;
mod error;
mod forward_dynamics;
mod inverse_dynamics;
mod kinematics;
mod mass_matrix;
mod model;
mod place;
mod pose;
mod real;
mod regressor;
mod small;
mod urdf;
mod variants;
mod visual;
mod workspace;

pub use chain::{ChainOptions, FixedBecause, FixedJoint};
pub use error::ArmError;
pub use inverse_dynamics::{FEATURES, NewtonEulerFeatures};
pub use model::{Arm, Frame, Inertia, Joint, JointKind, Limits, STANDARD_GRAVITY};
pub use nalgebra::{DMatrix, Matrix3, Matrix6xX, Vector3};
pub use pose::Pose;
pub use regressor::PARAMETERS_PER_LINK;
pub use visual::{Geometry, Visual};
pub use workspace::Workspace;
