//! The computed-torque controller: feed-forward by a torque model, feedback by gains.

use arm::{Arm, DMatrix};

use crate::error::TorqueError;
use crate::fading::Fading;
use crate::model::{Prediction, TorqueModel, Workspace};

/// The feedback of position and velocity errors; one gain per joint.
#[derive(Clone, Debug, PartialEq)]
pub enum Feedback {
    /// τ = M(q) (K_p e + K_d ė) with the controller's own mass matrix; K_p in 1/s², K_d in 1/s.
    MassMatrix {
        /// Position gains (1/s²).
        kp: Vec<f64>,
        /// Velocity gains (1/s).
        kd: Vec<f64>,
    },
    /// τ = K_p e + K_d ė; K_p in N m/rad (or N/m), K_d in N m s/rad (or N s/m).
    Gains {
        /// Position gains (N m/rad or N/m).
        kp: Vec<f64>,
        /// Velocity gains (N m s/rad or N s/m).
        kd: Vec<f64>,
    },
}

/// The torques of one control step, one entry per joint (N m or N).
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// The feed-forward of the model, in parts.
    pub feedforward: Prediction,
    /// The feedback.
    pub feedback: Vec<f64>,
    /// The sum of feed-forward and feedback within the joints' effort limits.
    pub torque: Vec<f64>,
    /// Whether the limit reduced the sum.
    pub saturated: Vec<bool>,
}

impl Command {
    /// A command with zero torques for `dof` joints.
    pub fn new(dof: usize) -> Self {
        Self {
            feedforward: Prediction::new(dof),
            feedback: vec![0.0; dof],
            torque: vec![0.0; dof],
            saturated: vec![false; dof],
        }
    }
}

/// Feed-forward of the reference motion by a torque model, plus proportional-derivative feedback.
///
/// τ = model(q_r, q̇_r, q̈_r) + feedback(q_r − q, q̇_r − q̇), limited to the effort limits: the computed-torque
/// feed-forward scheme of An, Atkeson and Hollerbach 1988, chapter 5.
pub struct Controller<'a> {
    model: &'a dyn TorqueModel,
    arm: Arm,
    feedback: Feedback,
    workspace: Workspace,
    arm_workspace: arm::Workspace,
    mass_matrix: DMatrix<f64>,
    fade: Option<Fading>,
}

impl<'a> Controller<'a> {
    /// A controller with the feed-forward of `model`; the mass matrix and the effort limits are those of `arm`.
    ///
    /// # Errors
    /// [`TorqueError`] if the model belongs to another arm, or if a gain is negative, not finite, or missing.
    pub fn new(model: &'a dyn TorqueModel, arm: Arm, feedback: Feedback) -> Result<Self, TorqueError> {
        let n = arm.dof();
        let sized = |what: &str, found: usize| {
            let what = what.to_owned();
            (found == n).then_some(()).ok_or(TorqueError::Joints { what, found, expected: n })
        };
        sized("torque model", model.dof())?;
        let (Feedback::MassMatrix { kp, kd } | Feedback::Gains { kp, kd }) = &feedback;
        for (what, gains) in [("kp", kp), ("kd", kd)] {
            sized(what, gains.len())?;
            if let Some(joint) = gains.iter().position(|gain| !(gain.is_finite() && *gain >= 0.0)) {
                return Err(TorqueError::Gain { what, joint: joint + 1, value: gains[joint] });
            }
        }
        Ok(Self {
            workspace: Workspace::new(n),
            arm_workspace: arm::Workspace::new(&arm),
            mass_matrix: DMatrix::zeros(n, n),
            model,
            arm,
            feedback,
            fade: None,
        })
    }

    /// Lets the learned part of the feed-forward fade to the rigid-body model where there are no training data near
    /// the motion: τ_j = τ_rigid,j + w_j (τ_model,j − τ_rigid,j) with the weight w_j of [`TorqueModel::weight`]. For a
    /// model without a rigid-body part, the rigid body is that of the controller.
    ///
    /// A weight takes a part of the time of a control step, and the motion is slow compared with the control rate:
    /// after the first step, each step renews the weight of one joint, in turn. A model without a learned part does
    /// not fade.
    #[must_use]
    pub fn fading(mut self) -> Self {
        self.fade = Some(Fading::new(self.arm.dof()));
        self
    }

    /// The weights of the learned torques in the last step, if they fade: 1 for the whole learned torque, 0 for the
    /// rigid body alone.
    pub fn weights(&self) -> Option<&[f64]> {
        self.fade.as_ref().map(|fade| fade.weights.as_slice())
    }

    /// Writes the feed-forward torques for the reference motion `q`, `qd`, `qdd` to `command`.
    ///
    /// # Panics
    /// If a slice is of another size than the arm.
    pub fn feed_forward(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], command: &mut Command) {
        self.model.predict(&mut self.workspace, q, qd, qdd, &mut command.feedforward);
        if let Some(fade) = &mut self.fade {
            let due = fade.due();
            fade.renew(self.model, &mut self.workspace, due);
            let arm = (&self.arm, &mut self.arm_workspace);
            fade.apply(self.model, arm, [q, qd, qdd], &mut command.feedforward);
        }
    }

    /// Writes the feedback torques at the measured `q` for the errors `error` (rad or m) and `error_rate` (rad/s or
    /// m/s), and the sum of feed-forward and feedback within the effort limits, to `command`.
    ///
    /// # Panics
    /// If a slice is of another size than the arm.
    pub fn feed_back(&mut self, q: &[f64], error: &[f64], error_rate: &[f64], command: &mut Command) {
        let n = self.arm.dof();
        match &self.feedback {
            Feedback::Gains { kp, kd } => {
                for i in 0..n {
                    command.feedback[i] = kp[i] * error[i] + kd[i] * error_rate[i];
                }
            }
            Feedback::MassMatrix { kp, kd } => {
                self.arm.mass_matrix(&mut self.arm_workspace, q, &mut self.mass_matrix);
                command.feedback.fill(0.0);
                for j in 0..n {
                    let acceleration = kp[j] * error[j] + kd[j] * error_rate[j];
                    for i in 0..n {
                        command.feedback[i] += self.mass_matrix[(i, j)] * acceleration;
                    }
                }
            }
        }
        for (i, joint) in self.arm.joints().iter().enumerate() {
            let wanted = command.feedforward.torque(i) + command.feedback[i];
            let limit = joint.limits.effort;
            command.torque[i] = wanted.clamp(-limit, limit);
            command.saturated[i] = wanted.abs() > limit;
        }
    }

    /// The variance of the model's learned part at a motion, as [`TorqueModel::variance`].
    ///
    /// # Panics
    /// If a slice is of another size than the arm.
    pub fn variance(&mut self, q: &[f64], qd: &[f64], qdd: &[f64]) -> Option<&[f64]> {
        self.model.variance(&mut self.workspace, q, qd, qdd)
    }
}
