//! Torque models behind one trait, their training, and the computed-torque controller.
//!
//! A [`TorqueModel`] predicts the joint torques (N m or N) that a motion q, q̇, q̈ requires, in parts: rigid-body
//! dynamics, named effects, and a learned part. There are the paper's four models, one of the arm's energies
//! ([`Lagrangian`]), the exact model as the reference, and the [`Corrected`] model of a diagnosis; the controller depends on the trait only.
//!
//! ```
//! use arm::Arm;
//! use effects::{Effect, friction::COULOMB_FRICTION};
//! use torque::{Corrected, Prediction, RigidBody, TorqueModel, Workspace};
//!
//! let arm = Arm::from_urdf("../../assets/puma560.urdf")?;
//! let friction = Effect::of(&COULOMB_FRICTION).on(&arm.joints()[1].name).with("level", 0.4);
//! let corrected = Corrected::new(&arm, &[friction])?;
//! let torque_of_joint_2 = |model: &dyn TorqueModel| {
//!     let (mut workspace, mut prediction) = (Workspace::new(6), Prediction::new(6));
//!     model.predict(&mut workspace, &[0.5; 6], &[1.0; 6], &[0.0; 6], &mut prediction);
//!     prediction.torque(1)
//! };
//! let added = torque_of_joint_2(&corrected) - torque_of_joint_2(&RigidBody::new(arm));
//! assert!((added - 0.4).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod controller;
mod corrected;
mod error;
mod fading;
mod inputs;
mod lagrangian;
mod learned;
mod model;
mod motion;
mod reach;
mod reference;
mod rigid_body;
mod samples;
mod summed;
mod trajectory;

pub use controller::{Command, Controller, Feedback};
pub use corrected::Corrected;
pub use error::TorqueError;
pub use fading::faded_squared_error;
pub use gp::{
    Conditioning, Gp, LagrangianConditioning, LagrangianGp, LagrangianOptions, LagrangianPrior, LengthScales, Lengths,
};
pub use inputs::Inputs;
pub use lagrangian::Lagrangian;
pub use learned::{Learned, TrainingOptions};
pub use model::{Prediction, TorqueModel, Workspace};
pub use motion::Motion;
pub use reference::{Fade, Reference, Sine};
pub use rigid_body::RigidBody;
pub use samples::{Sample, Samples};
pub use summed::summed;
pub use trajectory::Trajectory;
