//! The trait of all torque models.

use arm::{Arm, NewtonEulerFeatures};
use gp::{Gp, LagrangianGp, LagrangianWorkspace};

use crate::samples::Samples;

/// A model of the joint torques that a motion requires.
pub trait TorqueModel: Send + Sync {
    /// The number of joints.
    fn dof(&self) -> usize;

    /// Writes the parts of the torques (N m or N) for the motion `q`, `qd`, `qdd` to the workspace without allocating;
    /// parts that the model does not have are zero.
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    fn predict(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64], prediction: &mut Prediction);

    /// The variance ((N m)² or N²) of the learned part for each joint; `None` for a model without a learned part. It
    /// takes much longer than [`Self::predict`].
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    fn variance<'w>(&self, workspace: &'w mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64]) -> Option<&'w [f64]>;

    /// The regressions of the learned part, one per joint; none in a model that does not have one per joint.
    fn regressions(&self) -> &[Gp] {
        &[]
    }

    /// The regression of the learned part by the arm's energies, if it is that.
    fn energies(&self) -> Option<&LagrangianGp> {
        None
    }

    /// The standard deviation (N m or N) of the noise that the learned part of `joint` has found in its training data; 0 without a
    /// learned part.
    fn noise(&self, joint: usize) -> f64 {
        self.regressions().get(joint).map_or(0.0, |gp| gp.hyperparameters().noise)
    }

    /// The reliability of the learned part of `joint` from 0 (no training data near the motion) to 1, for the motion
    /// of the last prediction with this workspace; `None` from a model without a learned part. See
    /// [`crate::Controller::fading`].
    fn weight(&self, _workspace: &mut Workspace, _joint: usize) -> Option<f64> {
        None
    }

    /// Whether the learned part is the whole torque, without a rigid-body model.
    fn stands_alone(&self) -> bool {
        false
    }

    /// The mean squared torque error on `samples` for each joint ((N m)² or N²), which is the measure of the paper.
    fn mean_squared_error(&self, samples: &Samples) -> Vec<f64> {
        let mut workspace = Workspace::new(self.dof());
        let mut prediction = Prediction::new(self.dof());
        let mut sum = vec![0.0; self.dof()];
        for sample in samples.iter() {
            self.predict(&mut workspace, sample.q, sample.qd, sample.qdd, &mut prediction);
            for (joint, sum) in sum.iter_mut().enumerate() {
                let error = sample.tau[joint] - prediction.torque(joint);
                *sum += error * error;
            }
        }
        let n = samples.len() as f64;
        sum.iter().map(|sum| sum / n).collect()
    }
}

/// The torque of a model, one entry per joint (N m or N).
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// The rigid-body torque.
    pub rigid: Vec<f64>,
    /// The torque of the named effects, including scales and limits.
    pub effects: Vec<f64>,
    /// The learned torque.
    pub learned: Vec<f64>,
}

impl Prediction {
    /// Zero torque for `dof` joints.
    pub fn new(dof: usize) -> Self {
        Self { rigid: vec![0.0; dof], effects: vec![0.0; dof], learned: vec![0.0; dof] }
    }

    /// The sum of the parts for `joint`.
    pub fn torque(&self, joint: usize) -> f64 {
        self.rigid[joint] + self.effects[joint] + self.learned[joint]
    }
}

/// Scratch for any torque model of an arm; make it once and pass it to every call.
#[derive(Clone, Debug)]
pub struct Workspace {
    pub(crate) arm: Option<arm::Workspace>,
    pub(crate) features: Vec<NewtonEulerFeatures>,
    pub(crate) input: Vec<f64>,
    pub(crate) gp: gp::Workspace,
    pub(crate) lagrangian: Option<LagrangianWorkspace>,
    pub(crate) rigid: Vec<f64>,
    pub(crate) variance: Vec<f64>,
}

impl Workspace {
    /// Scratch for models of arms with `dof` joints. It grows to its final size in the first call.
    pub fn new(dof: usize) -> Self {
        Self {
            arm: None,
            features: vec![[0.0; arm::FEATURES]; dof],
            input: vec![0.0; 3 * dof],
            gp: gp::Workspace::default(),
            lagrangian: None,
            rigid: vec![0.0; dof],
            variance: vec![0.0; dof],
        }
    }

    pub(crate) fn arm(&mut self, arm: &Arm) -> &mut arm::Workspace {
        self.arm.get_or_insert_with(|| arm::Workspace::new(arm))
    }

    pub(crate) fn lagrangian(&mut self, gp: &LagrangianGp) -> &mut LagrangianWorkspace {
        self.lagrangian.get_or_insert_with(|| gp.workspace())
    }
}
