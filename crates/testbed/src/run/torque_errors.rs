//! The error of the torque that is fed forward, on the samples of the reference.

use torque::{RigidBody, TorqueModel, faded_squared_error};

use crate::models::ModelKind;
use crate::scenario::Scenario;
use crate::training;

/// Mean squares on the samples of the reference, one per joint ((N m)² or N²).
pub struct TorqueErrors {
    /// Of the error of the torque that the controller feeds forward: with the fade, if there is one.
    pub fed_forward: Vec<f64>,
    /// Of the error of the controller's rigid body alone.
    pub rigid: Vec<f64>,
    /// Of the torque itself.
    pub torque: Vec<f64>,
}

impl TorqueErrors {
    /// The errors in a run of `scenario` under `model`.
    ///
    /// # Errors
    /// If the reference cannot be sampled.
    pub fn new(scenario: &Scenario, kind: ModelKind, model: &dyn TorqueModel) -> anyhow::Result<Self> {
        let samples = training::own_samples(scenario)?;
        let nominal = scenario.nominal_arm();
        let fed_forward = if scenario.fade && kind.learns() {
            faded_squared_error(model, &nominal, &samples)
        } else {
            model.mean_squared_error(&samples)
        };
        let mut torque = vec![0.0; samples.dof()];
        for sample in samples.iter() {
            for (sum, tau) in torque.iter_mut().zip(sample.tau) {
                *sum += tau * tau / samples.len() as f64;
            }
        }
        Ok(Self { fed_forward, rigid: RigidBody::new(nominal).mean_squared_error(&samples), torque })
    }
}
