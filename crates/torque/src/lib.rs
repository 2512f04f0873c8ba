//! Torque models behind one trait, their training, and the computed-torque controller.
//!
//! A [`TorqueModel`] predicts the joint torques (N m or N) that a motion q, q̇, q̈ requires, in parts: rigid-body
//! dynamics, named effects, and a learned part. There are the paper's four models, one of the arm's energies
//! ([`Lagrangian`]), the exact model as the reference, and the [`Corrected`] model of a diagnosis; the controller depends on the trait only.

mod controller;
mod corrected;
mod error;
mod inputs;
mod lagrangian;
mod learned;
mod model;
mod reach;
mod reference;
mod rigid_body;
mod samples;

pub use controller::{Command, Controller, Feedback};
pub use corrected::Corrected;
pub use error::TorqueError;
pub use gp::{
    Conditioning, Gp, LagrangianConditioning, LagrangianGp, LagrangianOptions, LagrangianPrior, LengthScales, Lengths,
};
pub use inputs::Inputs;
pub use lagrangian::Lagrangian;
pub use learned::{Learned, TrainingOptions};
pub use model::{Prediction, TorqueModel, Workspace};
pub use reference::{Fade, Motion, Reference, Sine};
pub use rigid_body::RigidBody;
pub use samples::{Sample, Samples};
