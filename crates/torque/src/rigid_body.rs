//! Rigid-body dynamics as a torque model.

use arm::Arm;

use crate::model::{Prediction, TorqueModel, Workspace};

/// The inverse dynamics of an arm: the exact model for the true arm, the paper's "RBD only" for the nominal one.
#[derive(Clone, Debug)]
pub struct RigidBody {
    arm: Arm,
}

impl RigidBody {
    /// The model of `arm`.
    pub fn new(arm: Arm) -> Self {
        Self { arm }
    }
}

impl TorqueModel for RigidBody {
    fn dof(&self) -> usize {
        self.arm.dof()
    }

    fn predict(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64], prediction: &mut Prediction) {
        self.arm.inverse_dynamics(workspace.arm(&self.arm), q, qd, qdd, &mut prediction.rigid);
        prediction.effects.fill(0.0);
        prediction.learned.fill(0.0);
    }

    fn variance<'w>(&self, _: &'w mut Workspace, _: &[f64], _: &[f64], _: &[f64]) -> Option<&'w [f64]> {
        None
    }
}
