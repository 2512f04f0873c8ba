//! The models by name, and how each is made from an arm and training samples.

use arm::Arm;
use serde::{Serialize, Serializer};
use torque::{Inputs, Lagrangian, LagrangianOptions, Learned, RigidBody, Samples, TorqueModel, TrainingOptions};

/// The torque models that can be selected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ModelKind {
    /// The exact rigid-body model: the reference
    True,
    /// The rigid-body model alone, with the scenario's error (the paper's "RBD only")
    RigidBody,
    /// Gaussian-process regression alone, on (q, q̇, q̈) (the paper's "GPR only")
    Gp,
    /// Rigid body plus regression on (q, q̇, q̈) (the paper's "RBD+GPR")
    Hybrid,
    /// Rigid body plus one regression per joint on the 12 Newton-Euler inputs (the paper's IJL)
    IndependentJoint,
    /// The independent-joint model with the load of the next link in the link's own frame
    IndependentJointOwnFrame,
    /// The independent-joint model with its own rigid torque as the 13th input
    #[value(name = "independent-joint-13")]
    IndependentJoint13,
    /// Rigid body plus one regression of all joints by kinetic and potential energy and friction (Giacomuzzo and others, 2024)
    Lagrangian,
    /// The regression by energies and friction alone, which needs no masses and inertias
    LagrangianOnly,
}

impl ModelKind {
    /// All models: the reference, those of the paper's tables, the newer ones.
    pub const ALL: [Self; 9] = [
        Self::True,
        Self::RigidBody,
        Self::Gp,
        Self::Hybrid,
        Self::IndependentJoint,
        Self::IndependentJointOwnFrame,
        Self::IndependentJoint13,
        Self::Lagrangian,
        Self::LagrangianOnly,
    ];

    /// The name in JSON.
    pub fn json_name(self) -> &'static str {
        match self {
            Self::True => "true",
            Self::RigidBody => "rigid_body",
            Self::Gp => "gp",
            Self::Hybrid => "hybrid",
            Self::IndependentJoint => "independent_joint",
            Self::IndependentJointOwnFrame => "independent_joint_own_frame",
            Self::IndependentJoint13 => "independent_joint_13",
            Self::Lagrangian => "lagrangian",
            Self::LagrangianOnly => "lagrangian_only",
        }
    }

    /// The name on the command line.
    pub fn flag(self) -> String {
        self.json_name().replace('_', "-")
    }

    /// The name in a table for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::True => "exact model",
            Self::RigidBody => "rigid body",
            Self::Gp => "GP only",
            Self::Hybrid => "rigid body + GP",
            Self::IndependentJoint => "IJL, 12 inputs",
            Self::IndependentJointOwnFrame => "IJL, 12 in own frame",
            Self::IndependentJoint13 => "IJL, 13 inputs",
            Self::Lagrangian => "rigid body + energies",
            Self::LagrangianOnly => "energies only",
        }
    }

    /// Whether it is trained.
    pub fn learns(self) -> bool {
        !matches!(self, Self::True | Self::RigidBody)
    }

    /// Whether the model and its inputs are newer than the paper.
    pub fn is_newer_than_the_paper(self) -> bool {
        matches!(self, Self::Lagrangian | Self::LagrangianOnly)
    }

    /// Whether its regressions have length scales.
    pub fn has_length_scales(self) -> bool {
        self.learns() && !self.is_newer_than_the_paper()
    }

    /// The rigid-body model from which the controller takes its mass matrix.
    pub fn controller_arm(self, true_arm: &Arm, nominal_arm: &Arm) -> Arm {
        match self {
            Self::True => true_arm.clone(),
            _ => nominal_arm.clone(),
        }
    }

    /// Makes the model, training it on `samples` if it learns.
    ///
    /// # Errors
    /// If training fails.
    pub fn build(
        self,
        true_arm: &Arm,
        nominal_arm: &Arm,
        samples: &Samples,
        options: &TrainingOptions,
    ) -> anyhow::Result<Box<dyn TorqueModel>> {
        self.build_with(true_arm, nominal_arm, samples, options, &|| {})
    }

    /// Makes the model as [`Self::build`] does, and calls `fitted` once per joint after its regression, on any thread.
    ///
    /// # Errors
    /// If training fails.
    pub fn build_with(
        self,
        true_arm: &Arm,
        nominal_arm: &Arm,
        samples: &Samples,
        options: &TrainingOptions,
        fitted: &(dyn Fn() + Sync),
    ) -> anyhow::Result<Box<dyn TorqueModel>> {
        let train = |arm, inputs| Learned::train(arm, inputs, samples, options, fitted);
        let on_top = |inputs| train(Some(nominal_arm), inputs);
        let energies = LagrangianOptions {
            support: options.inducing.unwrap_or(LagrangianOptions::default().support),
            ..LagrangianOptions::default()
        };
        Ok(match self {
            Self::True => Box::new(RigidBody::new(true_arm.clone())),
            Self::RigidBody => Box::new(RigidBody::new(nominal_arm.clone())),
            Self::Gp => Box::new(train(None, Inputs::JointMotion)?),
            Self::Hybrid => Box::new(on_top(Inputs::JointMotion)?),
            Self::IndependentJoint => Box::new(on_top(Inputs::NewtonEuler12)?),
            Self::IndependentJointOwnFrame => Box::new(on_top(Inputs::NewtonEulerOwnFrame)?),
            Self::IndependentJoint13 => Box::new(on_top(Inputs::NewtonEuler13)?),
            Self::Lagrangian | Self::LagrangianOnly => {
                let make = match self {
                    Self::Lagrangian => Lagrangian::on_top_of,
                    _ => Lagrangian::alone,
                };
                let model = make(nominal_arm, samples, &energies)?;
                // One regression for all joints.
                (0..samples.dof()).for_each(|_| fitted());
                Box::new(model)
            }
        })
    }
}

impl Serialize for ModelKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.json_name())
    }
}
