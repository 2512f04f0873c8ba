//! The rigid arm: URDF to [`Arm`], kinematics, inverse and forward dynamics, mass matrix, torque regressor.
//!
//! An [`Arm`] is immutable; every algorithm writes into a [`Workspace`] that the caller keeps, so that no call
//! allocates. Joint space is `q`, `qd`, `qdd`, `tau`: positions (rad or m), velocities, accelerations, and joint
//! torques (N m) or forces (N), with one entry per moving joint from base to tip.
//!
//! A link's frame is its URDF frame, at its joint. Poses are written `a_from_b`. In spatial vectors the angular part
//! comes first.
//!
//! ```
//! use arm::{Arm, Workspace};
//!
//! let arm = Arm::from_urdf("../../assets/puma560.urdf")?;
//! let mut workspace = Workspace::new(&arm);
//! let (q, rest) = ([0.0, -1.0, 1.0, 0.0, 0.5, 0.0], [0.0; 6]);
//! let (mut holding, mut acceleration) = ([0.0; 6], [1.0; 6]);
//! arm.gravity_torque(&mut workspace, &q, &mut holding);
//! arm.forward_dynamics(&mut workspace, &q, &rest, &holding, &mut acceleration);
//! assert!(acceleration.iter().all(|a| a.abs() < 1e-9));
//! # Ok::<(), arm::ArmError>(())
//! ```

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod batch;
mod chain;
mod derivatives;
mod energy;
mod error;
mod forward_dynamics;
mod inertia;
mod inverse_dynamics;
mod joint;
mod kinematics;
mod mass_matrix;
mod model;
mod placeholder;
mod pose;
mod real;
mod regressor;
mod scratch;
mod small;
mod units;
mod urdf;
mod variants;
mod visual;
mod workspace;

pub use chain::{ChainOptions, FixedBecause, FixedJoint};
pub use error::ArmError;
pub use inertia::Inertia;
pub use inverse_dynamics::{FEATURES, NewtonEulerFeatures};
pub use joint::{Joint, JointKind, Limits};
pub use model::{Arm, FixedBody, Frame, STANDARD_GRAVITY};
pub use nalgebra::{DMatrix, Matrix3, Matrix6xX, Vector3};
pub use placeholder::Placeholder;
pub use pose::Pose;
pub use regressor::PARAMETERS_PER_LINK;
pub use visual::{Geometry, Visual};
pub use workspace::Workspace;
