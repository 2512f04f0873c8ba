//! The feed-forward that fades to the rigid body where a learned torque is not reliable.

use std::ops::Range;

use arm::Arm;

use crate::model::{Prediction, TorqueModel, Workspace};
use crate::samples::Samples;

/// The weights of the learned torques.
pub(crate) struct Fading {
    /// One weight per joint.
    pub(crate) weights: Vec<f64>,
    /// The joint whose weight is renewed next; none before the first step, which computes all.
    due: Option<usize>,
    /// The torque of the rigid body, for a model without a rigid-body part.
    rigid: Vec<f64>,
}

impl Fading {
    /// Full weights for `dof` joints.
    pub(crate) fn new(dof: usize) -> Self {
        Self { weights: vec![1.0; dof], due: None, rigid: vec![0.0; dof] }
    }

    /// The joints whose weights this control step renews: all in the first step, then one after the other.
    pub(crate) fn due(&mut self) -> Range<usize> {
        let dof = self.weights.len();
        let due = self.due.map_or(0..dof, |joint| joint..joint + 1);
        self.due = Some(self.due.map_or(0, |joint| (joint + 1) % dof));
        due
    }

    /// Renews the weights of `joints` for the motion of the last prediction of `model` with `workspace`.
    pub(crate) fn renew(&mut self, model: &dyn TorqueModel, workspace: &mut Workspace, joints: Range<usize>) {
        for joint in joints {
            if let Some(weight) = model.weight(workspace, joint) {
                self.weights[joint] = weight;
            }
        }
    }

    /// Multiplies the learned torques of `prediction` by their weights. If `model` stands alone, the rest is the torque of `arm` at the
    /// `motion` (q, q̇, q̈).
    pub(crate) fn apply(
        &mut self,
        model: &dyn TorqueModel,
        arm: (&Arm, &mut arm::Workspace),
        motion: [&[f64]; 3],
        prediction: &mut Prediction,
    ) {
        let stands_alone = model.stands_alone();
        if stands_alone {
            arm.0.inverse_dynamics(arm.1, motion[0], motion[1], motion[2], &mut self.rigid);
        }
        for (joint, weight) in self.weights.iter().enumerate() {
            prediction.learned[joint] *= weight;
            if stands_alone {
                prediction.rigid[joint] = (1.0 - weight) * self.rigid[joint];
            }
        }
    }
}

/// The mean squared error on `samples`, for each joint ((N m)² or N²), of the torque that a controller with `arm` feeds forward from
/// `model` with the fade of [`crate::Controller::fading`], with the weights of each sample.
///
/// # Panics
/// If model, arm and samples have different numbers of joints.
pub fn faded_squared_error(model: &dyn TorqueModel, arm: &Arm, samples: &Samples) -> Vec<f64> {
    let dof = model.dof();
    let (mut workspace, mut arm_workspace) = (Workspace::new(dof), arm::Workspace::new(arm));
    let mut prediction = Prediction::new(dof);
    let mut fading = Fading::new(dof);
    let mut sum = vec![0.0; dof];
    for sample in samples.iter() {
        let motion = [sample.q, sample.qd, sample.qdd];
        model.predict(&mut workspace, sample.q, sample.qd, sample.qdd, &mut prediction);
        fading.renew(model, &mut workspace, 0..dof);
        fading.apply(model, (arm, &mut arm_workspace), motion, &mut prediction);
        for (joint, sum) in sum.iter_mut().enumerate() {
            *sum += (sample.tau[joint] - prediction.torque(joint)).powi(2);
        }
    }
    sum.iter().map(|sum| sum / samples.len() as f64).collect()
}
