//! The learned torque model of Independent Joint Learning, trained on samples of a motion.

use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use torque::{
    Inputs, LengthScales, Lengths, Prediction, Sample, Samples, TorqueError, TorqueModel, TrainingOptions, Workspace,
};

use crate::dynamics::Dynamics;
use crate::error::JointwiseError;
use crate::rows::{map_rows, rows};

/// A trained model. Results are flat arrays, row by row.
#[pyclass(frozen, module = "jointwise._core")]
pub struct Learned {
    arm: arm::Arm,
    model: torque::Learned,
}

/// Amplitude, length scales, noise and log marginal likelihood of one joint's regression.
type Regression = (f64, Vec<f64>, f64, f64);

fn unknown(what: &str, found: &str, known: &[&str]) -> PyErr {
    JointwiseError::new_err(format!("{what} is \"{found}\"; give one of {}", known.join(", ")))
}

#[pymethods]
impl Learned {
    /// Trains one regression per joint on the residual of the rigid model.
    #[staticmethod]
    #[pyo3(signature = (dynamics, q, qd, qdd, tau, inputs, length_scales, starts, max_iterations))]
    #[expect(clippy::too_many_arguments, reason = "the Python class gives them by name")]
    fn fit(
        py: Python<'_>,
        dynamics: &Dynamics,
        q: PyReadonlyArray2<'_, f64>,
        qd: PyReadonlyArray2<'_, f64>,
        qdd: PyReadonlyArray2<'_, f64>,
        tau: PyReadonlyArray2<'_, f64>,
        inputs: &str,
        length_scales: &str,
        starts: usize,
        max_iterations: u64,
    ) -> PyResult<Self> {
        let inputs = match inputs {
            "newton-euler-12" => Inputs::NewtonEuler12,
            "newton-euler-13" => Inputs::NewtonEuler13,
            "newton-euler-own-frame" => Inputs::NewtonEulerOwnFrame,
            "joint-motion" => Inputs::JointMotion,
            other => {
                let known = ["newton-euler-12", "newton-euler-13", "newton-euler-own-frame", "joint-motion"];
                return Err(unknown("inputs", other, &known));
            }
        };
        let lengths = match length_scales {
            "single" => LengthScales::Isotropic,
            "per-input" => LengthScales::PerInput,
            other => return Err(unknown("length_scales", other, &["single", "per-input"])),
        };
        if starts == 0 {
            return Err(JointwiseError::new_err("starts is 0; the search of the likelihood needs at least 1"));
        }
        let arm = dynamics.arm.clone();
        let given = [("q", &q), ("qd", &qd), ("qdd", &qdd), ("tau", &tau)];
        let [q, qd, qdd, tau] = rows(&arm, given)?;
        let train = || -> Result<torque::Learned, TorqueError> {
            let mut samples = Samples::new(arm.dof());
            for k in 0..q.len() {
                samples.push(Sample { q: q.row(k), qd: qd.row(k), qdd: qdd.row(k), tau: tau.row(k) })?;
            }
            let options = TrainingOptions { lengths, starts, max_iterations, inducing: None };
            torque::Learned::on_top_of(&arm, inputs, &samples, &options)
        };
        let model = py.detach(train).map_err(|error| match error {
            // The error gives the joint's name instead of its number.
            TorqueError::Regression { joint, source } => {
                JointwiseError::new_err(format!("{}: {source}", arm.joints()[joint - 1].name))
            }
            other => JointwiseError::new_err(other.to_string()),
        })?;
        Ok(Self { arm, model })
    }

    /// The predicted torques (N m or N): one row of joints per sample.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        qd: PyReadonlyArray2<'py, f64>,
        qdd: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let dof = self.arm.dof();
        let given = [("q", &q), ("qd", &qd), ("qdd", &qdd)];
        let scratch = || (Workspace::new(dof), Prediction::new(dof));
        map_rows(py, &self.arm, given, dof, scratch, |(workspace, prediction), [q, qd, qdd], tau| {
            self.model.predict(workspace, q, qd, qdd, prediction);
            for (joint, tau) in tau.iter_mut().enumerate() {
                *tau = prediction.torque(joint);
            }
        })
    }

    /// The variances of the learned part, without the noise (squared torque): one row of joints per sample.
    fn variance<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        qd: PyReadonlyArray2<'py, f64>,
        qdd: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let dof = self.arm.dof();
        let given = [("q", &q), ("qd", &qd), ("qdd", &qdd)];
        let scratch = || Workspace::new(dof);
        map_rows(py, &self.arm, given, dof, scratch, |workspace, [q, qd, qdd], row| {
            if let Some(variance) = self.model.variance(workspace, q, qd, qdd) {
                row.copy_from_slice(variance);
            }
        })
    }

    /// Amplitude, length scales, noise and log marginal likelihood of each joint's regression.
    fn regressions(&self) -> Vec<Regression> {
        let of = |gp: &torque::Gp| {
            let found = gp.hyperparameters();
            let lengths = match &found.lengths {
                Lengths::Isotropic(length) => vec![*length],
                Lengths::PerInput(lengths) => lengths.clone(),
            };
            (found.amplitude, lengths, found.noise, gp.log_marginal_likelihood())
        };
        self.model.regressions().iter().map(of).collect()
    }
}
