//! Rigid-body dynamics of an arm, row by row.

use arm::{Arm, ChainOptions, DMatrix, PARAMETERS_PER_LINK, Workspace};
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use study::robot;

use crate::error::{JointwiseError, in_python, raised};
use crate::rows::{flat, map_rows};

/// The arm of a URDF. Results are flat arrays, row by row.
#[pyclass(frozen, module = "jointwise._core")]
pub struct Dynamics {
    pub(crate) arm: Arm,
}

#[pymethods]
impl Dynamics {
    /// Reads the arm among the robot's joints.
    #[new]
    #[pyo3(signature = (urdf, base, tip, locks))]
    fn new(urdf: &str, base: Option<String>, tip: Option<String>, locks: Vec<(String, f64)>) -> PyResult<Self> {
        let options = ChainOptions { base, tip, locks, recorded: Vec::new() };
        let arm = robot::named_robot(urdf).and_then(|robot| robot.arm(&options)).map_err(|error| raised(&error))?;
        Ok(Self { arm })
    }

    /// The robot's name.
    #[getter]
    fn name(&self) -> &str {
        self.arm.name()
    }

    /// The joints, base to tip.
    #[getter]
    fn joints(&self) -> Vec<&str> {
        self.arm.joints().iter().map(|joint| joint.name.as_str()).collect()
    }

    /// Doubts about the URDF, and the joints that were fixed.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.arm.warnings().iter().map(|warning| in_python(warning)).collect()
    }

    /// The inertial parameters that the regressor multiplies: ten per link, link by link.
    fn inertial_parameters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        flat(py, self.arm.inertial_parameters())
    }

    /// The torque of a motion (inverse dynamics, N m or N): one row of joints per sample.
    fn torque<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        qd: PyReadonlyArray2<'py, f64>,
        qdd: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let arm = &self.arm;
        let given = [("q", &q), ("qd", &qd), ("qdd", &qdd)];
        let scratch = || Workspace::new(arm);
        map_rows(py, arm, given, arm.dof(), scratch, |workspace, [q, qd, qdd], tau| {
            arm.inverse_dynamics(workspace, q, qd, qdd, tau);
        })
    }

    /// The torque that holds the arm at rest (N m or N): one row of joints per sample.
    fn gravity<'py>(&self, py: Python<'py>, q: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let arm = &self.arm;
        let scratch = || Workspace::new(arm);
        map_rows(py, arm, [("q", &q)], arm.dof(), scratch, |workspace, [q], tau| {
            arm.gravity_torque(workspace, q, tau);
        })
    }

    /// The acceleration under a torque (forward dynamics, rad/s² or m/s²): one row of joints per sample.
    fn forward<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        qd: PyReadonlyArray2<'py, f64>,
        tau: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let arm = &self.arm;
        if let Some(joint) = arm.massless_joint() {
            return Err(JointwiseError::new_err(format!(
                "joint \"{}\" of {} moves no mass and no rotor, so that its acceleration is not defined; give its link an \
                 <inertial>",
                arm.joints()[joint].name,
                arm.name()
            )));
        }
        let given = [("q", &q), ("qd", &qd), ("tau", &tau)];
        let scratch = || Workspace::new(arm);
        map_rows(py, arm, given, arm.dof(), scratch, |workspace, [q, qd, tau], qdd| {
            arm.forward_dynamics(workspace, q, qd, tau, qdd);
        })
    }

    /// The joint-space mass matrix: joints × joints per sample.
    fn mass_matrix<'py>(&self, py: Python<'py>, q: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let arm = &self.arm;
        let dof = arm.dof();
        let scratch = || (Workspace::new(arm), DMatrix::zeros(dof, dof));
        map_rows(py, arm, [("q", &q)], dof * dof, scratch, |(workspace, matrix), [q], row| {
            arm.mass_matrix(workspace, q, matrix);
            // The matrix is symmetric, so that column-major order equals row-major order.
            row.copy_from_slice(matrix.as_slice());
        })
    }

    /// The torque regressor: joints × (10 × links) per sample.
    fn regressor<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        qd: PyReadonlyArray2<'py, f64>,
        qdd: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let arm = &self.arm;
        let (dof, columns) = (arm.dof(), arm.dof() * PARAMETERS_PER_LINK);
        let given = [("q", &q), ("qd", &qd), ("qdd", &qdd)];
        let scratch = || (Workspace::new(arm), DMatrix::zeros(dof, columns));
        map_rows(py, arm, given, dof * columns, scratch, |(workspace, matrix), [q, qd, qdd], row| {
            arm.torque_regressor(workspace, q, qd, qdd, matrix);
            for (joint, row) in row.chunks_exact_mut(columns).enumerate() {
                for (column, value) in row.iter_mut().enumerate() {
                    *value = matrix[(joint, column)];
                }
            }
        })
    }
}
