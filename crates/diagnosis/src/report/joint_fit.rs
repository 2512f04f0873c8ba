//! How well one joint's torque is predicted.

use schemars::JsonSchema;
use serde::Serialize;

/// How well one joint's torque is predicted. NRMSE: RMS error over the standard deviation of the measured torque.
#[derive(Clone, Copy, Debug, Default, Serialize, JsonSchema)]
pub struct JointFit {
    /// Standard deviation of the measured torque, training recordings (N m or N).
    pub torque_std: f64,
    /// Standard deviation of the noise after filtering (N m or N).
    pub noise: f64,
    /// Held-out NRMSE of the nominal model over the samples in motion (over all where the joint hardly moves); `None` where
    /// there is no held-out recording.
    pub held_out_nrmse_nominal: Option<f64>,
    /// Held-out NRMSE with the named effects.
    pub held_out_nrmse_augmented: Option<f64>,
    /// Held-out NRMSE with a correction learned (IJL) from the same recordings.
    pub held_out_nrmse_learned: Option<f64>,
    /// Held-out NRMSE of the exported model: the links' inertial parameters and the named effects. The augmented model also
    /// contains the background's corrections of friction and torque constants, which no file holds.
    pub held_out_nrmse_exported: Option<f64>,
    /// Held-out NRMSE of full linear identification on the same recordings: least squares on all inertial parameters, viscous
    /// and Coulomb friction, drive inertia and a constant of every joint.
    pub held_out_nrmse_identified: Option<f64>,
    /// NRMSE with the named effects over the samples at rest: the excess over the torque that dry friction may hold.
    pub held_out_nrmse_resting: Option<f64>,
    /// NRMSE of the nominal model over the samples at rest.
    pub held_out_nrmse_resting_nominal: Option<f64>,
    /// NRMSE of the nominal model, training recordings, samples in motion.
    pub train_nrmse_nominal: f64,
    /// NRMSE with the named effects, training recordings, samples in motion.
    pub train_nrmse_augmented: f64,
    /// Autocorrelation of the augmented residual at a lag of 0.1 s (0: white).
    pub residual_autocorrelation: f64,
    /// Autocorrelation of the nominal residual at a lag of 0.1 s.
    pub residual_autocorrelation_nominal: f64,
}

impl JointFit {
    /// The error (NRMSE) with the named effects: the held-out one if there is one.
    pub fn error(&self) -> f64 {
        self.held_out_nrmse_augmented.unwrap_or(self.train_nrmse_augmented)
    }
}
