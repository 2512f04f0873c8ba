//! Torque models with a part learned by Gaussian-process regression: the paper's GPR only, RBD + GPR, and IJL.

use arm::Arm;
use gp::{FitOptions, Gp, LengthScales, TrainingSet};
use rayon::prelude::*;

use crate::error::TorqueError;
use crate::inputs::Inputs;
use crate::model::{Prediction, TorqueModel, Workspace};
use crate::reach::Reach;
use crate::samples::Samples;

/// Options of the training; the default is the paper's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrainingOptions {
    /// One length scale for all inputs (the paper's equation 4), or one per input.
    pub lengths: LengthScales,
    /// The number of starts of the likelihood search, at least 1: [`FitOptions::starts`].
    pub starts: usize,
    /// Iterations from each start: [`FitOptions::max_iterations`].
    pub max_iterations: u64,
    /// The number of inducing points by which the regressions are approximated if there are more samples than that:
    /// [`FitOptions::inducing`].
    pub inducing: Option<usize>,
}

impl Default for TrainingOptions {
    fn default() -> Self {
        let fit = FitOptions::default();
        Self {
            lengths: LengthScales::Isotropic,
            starts: fit.starts,
            max_iterations: fit.max_iterations,
            inducing: fit.inducing,
        }
    }
}

/// A rigid-body model (or none) plus one regression of the residual torque per joint.
#[derive(Clone, Debug)]
pub struct Learned {
    rigid_body: Option<Arm>,
    inputs: Inputs,
    regressions: Vec<Gp>,
    reaches: Vec<Reach>,
}

impl Learned {
    /// Learns the residual torque of `arm` from `inputs`: the paper's "RBD + GPR" on [`Inputs::JointMotion`], and Independent
    /// Joint Learning on the Newton-Euler inputs (algorithm 2).
    ///
    /// # Errors
    /// [`TorqueError`] if there are no samples, if they belong to another arm, or if a regression fails.
    pub fn on_top_of(
        arm: &Arm,
        inputs: Inputs,
        samples: &Samples,
        options: &TrainingOptions,
    ) -> Result<Self, TorqueError> {
        Self::train(Some(arm), inputs, samples, options, &|| {})
    }

    /// Learns as [`Self::on_top_of`] does if there is an `arm`, and the whole torque if there is none (the paper's "GPR only"). `fitted` is called after
    /// the regression of each joint, on any thread.
    ///
    /// # Errors
    /// Those of [`Self::on_top_of`].
    pub fn train(
        arm: Option<&Arm>,
        inputs: Inputs,
        samples: &Samples,
        options: &TrainingOptions,
        fitted: &(dyn Fn() + Sync),
    ) -> Result<Self, TorqueError> {
        let dof = samples.dof();
        samples.check(arm)?;
        let mut model = Self { rigid_body: arm.cloned(), inputs, regressions: Vec::new(), reaches: Vec::new() };
        let mut workspace = Workspace::new(dof);
        let dimension = inputs.dimension(dof);
        let mut x = vec![Vec::with_capacity(samples.len() * dimension); dof];
        let mut y = vec![Vec::with_capacity(samples.len()); dof];
        for sample in samples.iter() {
            model.evaluate_features(&mut workspace, sample.q, sample.qd, sample.qdd);
            for joint in 0..dof {
                x[joint].extend_from_slice(inputs.of(joint, &workspace));
                y[joint].push(sample.tau[joint] - workspace.rigid[joint]);
            }
        }
        let fit = FitOptions {
            lengths: options.lengths,
            starts: options.starts,
            max_iterations: options.max_iterations,
            inducing: options.inducing,
            ..FitOptions::default()
        };
        // The regressions are independent of each other, so that the result does not depend on the number of threads.
        let regressions: Result<Vec<Gp>, TorqueError> = (0..dof)
            .into_par_iter()
            .map(|joint| {
                let regression = TrainingSet::new(dimension, &x[joint], &y[joint]).and_then(|set| Gp::fit(&set, &fit));
                fitted();
                regression.map_err(|source| TorqueError::Regression { joint: joint + 1, source })
            })
            .collect();
        model.regressions = regressions?;
        model.reaches = model.regressions.iter().zip(&y).map(|(gp, targets)| Reach::of(gp, targets)).collect();
        Ok(model)
    }

    /// Computes the rigid-body torque and the inputs of the regressions in the workspace.
    fn evaluate_features(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64]) {
        let dof = q.len();
        match &self.rigid_body {
            None => workspace.rigid.fill(0.0),
            Some(arm) => {
                let scratch = workspace.arm.get_or_insert_with(|| arm::Workspace::new(arm));
                match self.inputs {
                    Inputs::JointMotion => arm.inverse_dynamics(scratch, q, qd, qdd, &mut workspace.rigid),
                    Inputs::NewtonEuler12 | Inputs::NewtonEuler13 | Inputs::NewtonEulerOwnFrame => {
                        let (rigid, features) = (&mut workspace.rigid, &mut workspace.features);
                        arm.newton_euler_features(scratch, q, qd, qdd, rigid, features);
                        if self.inputs == Inputs::NewtonEulerOwnFrame {
                            arm.turn_loads_into_own_frames(scratch, features);
                        }
                    }
                }
            }
        }
        if self.inputs == Inputs::JointMotion {
            workspace.input[..dof].copy_from_slice(q);
            workspace.input[dof..2 * dof].copy_from_slice(qd);
            workspace.input[2 * dof..3 * dof].copy_from_slice(qdd);
        }
    }
}

impl TorqueModel for Learned {
    fn dof(&self) -> usize {
        self.regressions.len()
    }

    fn regressions(&self) -> &[Gp] {
        &self.regressions
    }

    fn weight(&self, workspace: &mut Workspace, joint: usize) -> Option<f64> {
        Some(self.reaches[joint].weight(self.inputs.of(joint, workspace)))
    }

    fn stands_alone(&self) -> bool {
        self.rigid_body.is_none()
    }

    fn predict(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64], prediction: &mut Prediction) {
        self.evaluate_features(workspace, q, qd, qdd);
        prediction.rigid.copy_from_slice(&workspace.rigid);
        prediction.effects.fill(0.0);
        for (joint, gp) in self.regressions.iter().enumerate() {
            prediction.learned[joint] = gp.mean(self.inputs.of(joint, workspace));
        }
    }

    fn variance<'w>(&self, workspace: &'w mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64]) -> Option<&'w [f64]> {
        self.evaluate_features(workspace, q, qd, qdd);
        // Moved out of the workspace, because the inputs are read while the scratch is written.
        let mut scratch = std::mem::take(&mut workspace.gp);
        for (joint, gp) in self.regressions.iter().enumerate() {
            let (_, variance) = gp.mean_and_variance(self.inputs.of(joint, workspace), &mut scratch);
            workspace.variance[joint] = variance;
        }
        workspace.gp = scratch;
        Some(&workspace.variance)
    }
}
