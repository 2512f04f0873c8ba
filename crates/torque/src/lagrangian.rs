//! Torque models with a part learned from the arm's energies: all joints in one regression.

use arm::{Arm, JointKind};
use gp::{JointType, LagrangianGp, LagrangianOptions, LagrangianRange, TorqueSamples};

use crate::error::TorqueError;
use crate::model::{Prediction, TorqueModel, Workspace};
use crate::reach;
use crate::samples::Samples;

/// A rigid-body model (or none) plus one Lagrangian regression of the residual torques of all joints.
///
/// A regression per joint knows nothing of mechanics: whatever it learns need not be the torque of an arm. Here the residual is the
/// torque of kinetic and potential energies, as that of wrong masses and inertias is, and of friction, on all joints at once.
#[derive(Clone, Debug)]
pub struct Lagrangian {
    rigid_body: Option<Arm>,
    regression: LagrangianGp,
    range: LagrangianRange,
    /// The share of the prior variance from which the torque fades, one per joint.
    from: Vec<f64>,
}

impl Lagrangian {
    /// Learns the whole torque of `arm`, of which only the types of its joints are used.
    ///
    /// # Errors
    /// [`TorqueError`] if there are no samples, if they belong to another arm, or if the regression fails.
    pub fn alone(arm: &Arm, samples: &Samples, options: &LagrangianOptions) -> Result<Self, TorqueError> {
        Self::train(arm, None, samples, options)
    }

    /// Learns the residual torque of `arm`.
    ///
    /// # Errors
    /// [`TorqueError`] if there are no samples, if they belong to another arm, or if the regression fails.
    pub fn on_top_of(arm: &Arm, samples: &Samples, options: &LagrangianOptions) -> Result<Self, TorqueError> {
        Self::train(arm, Some(arm.clone()), samples, options)
    }

    fn train(
        arm: &Arm,
        rigid_body: Option<Arm>,
        samples: &Samples,
        options: &LagrangianOptions,
    ) -> Result<Self, TorqueError> {
        let dof = samples.dof();
        samples.check(Some(arm))?;
        let mut parts = [const { Vec::new() }; 4];
        let mut rigid = vec![0.0; dof];
        let mut workspace = rigid_body.as_ref().map(arm::Workspace::new);
        for sample in samples.iter() {
            if let (Some(arm), Some(workspace)) = (&rigid_body, &mut workspace) {
                arm.inverse_dynamics(workspace, sample.q, sample.qd, sample.qdd, &mut rigid);
            }
            let [q, qd, qdd, tau] = &mut parts;
            q.extend_from_slice(sample.q);
            qd.extend_from_slice(sample.qd);
            qdd.extend_from_slice(sample.qdd);
            tau.extend(sample.tau.iter().zip(&rigid).map(|(tau, rigid)| tau - rigid));
        }
        let joints: Vec<JointType> = arm
            .joints()
            .iter()
            .map(|joint| match joint.kind {
                JointKind::Revolute => JointType::Revolute,
                JointKind::Prismatic => JointType::Prismatic,
            })
            .collect();
        let [q, qd, qdd, tau] = &parts;
        let regression = TorqueSamples::new(&joints, [q, qd, qdd], tau)
            .and_then(|samples| LagrangianGp::fit(&samples, options))
            .map_err(TorqueError::Energies)?;
        let range = regression.range();
        let from = (0..dof).map(|joint| reach::beginning(range.mean_variance_share(joint)));
        Ok(Self { rigid_body, from: from.collect(), range, regression })
    }
}

impl TorqueModel for Lagrangian {
    fn dof(&self) -> usize {
        self.from.len()
    }

    fn energies(&self) -> Option<&LagrangianGp> {
        Some(&self.regression)
    }

    fn noise(&self, joint: usize) -> f64 {
        self.regression.noise()[joint]
    }

    fn weight(&self, workspace: &mut Workspace, joint: usize) -> Option<f64> {
        let share = self.range.variance_share(joint, workspace.lagrangian.as_mut()?);
        Some(reach::weight(share, self.from[joint]))
    }

    fn stands_alone(&self) -> bool {
        self.rigid_body.is_none()
    }

    fn predict(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64], prediction: &mut Prediction) {
        match &self.rigid_body {
            Some(arm) => arm.inverse_dynamics(workspace.arm(arm), q, qd, qdd, &mut prediction.rigid),
            None => prediction.rigid.fill(0.0),
        }
        prediction.effects.fill(0.0);
        let scratch = workspace.lagrangian(&self.regression);
        self.regression.mean([q, qd, qdd], scratch, &mut prediction.learned);
    }

    fn variance<'w>(&self, workspace: &'w mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64]) -> Option<&'w [f64]> {
        let Workspace { lagrangian, variance, .. } = workspace;
        let scratch = lagrangian.get_or_insert_with(|| self.regression.workspace());
        self.regression.variance([q, qd, qdd], scratch, variance);
        Some(variance)
    }
}
