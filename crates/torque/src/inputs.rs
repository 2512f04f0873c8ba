//! The inputs of a learned correction.

use crate::model::Workspace;

/// The inputs of the regressions, one regression per joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inputs {
    /// q, q̇ and q̈ of all joints, the same for every joint (the paper's "Lagrangian" form).
    JointMotion,
    /// ω_i, ω̇_i (in link i's frame), τ_{i+1}, f_{i+1} (in link i+1's frame) of the rigid-body model: the paper's twelve (equation 19). They
    /// are designed for revolute joints: the acceleration of a link along a prismatic joint is not among them.
    NewtonEuler12,
    /// The twelve and the model's own torque τ_i (the paper's algorithms 1 to 3).
    NewtonEuler13,
    /// The twelve, with τ_{i+1} and f_{i+1} in link i's frame, in which they enter τ_i without q_{i+1}.
    NewtonEulerOwnFrame,
}

impl Inputs {
    /// How many inputs the regression of one joint has, for an arm of `dof` joints.
    pub fn dimension(self, dof: usize) -> usize {
        match self {
            Self::JointMotion => 3 * dof,
            Self::NewtonEuler12 | Self::NewtonEulerOwnFrame => 12,
            Self::NewtonEuler13 => 13,
        }
    }

    /// Computes the inputs for `joint` from the features in `workspace`.
    pub(crate) fn of(self, joint: usize, workspace: &Workspace) -> &[f64] {
        match self {
            Self::JointMotion => &workspace.input,
            Self::NewtonEuler12 | Self::NewtonEuler13 | Self::NewtonEulerOwnFrame => {
                &workspace.features[joint][..self.dimension(0)]
            }
        }
    }
}
