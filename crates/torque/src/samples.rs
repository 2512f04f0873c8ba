//! Motion and torque samples: what a torque model learns from and is tested on.

use arm::Arm;

use crate::error::TorqueError;

/// Samples of joint motion and of the torque that it required, row by row: n × dof each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    dof: usize,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    tau: Vec<f64>,
}

/// One row of [`Samples`]; a slice has one entry per joint.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Positions (rad or m).
    pub q: &'a [f64],
    /// Velocities (rad/s or m/s).
    pub qd: &'a [f64],
    /// Accelerations (rad/s² or m/s²).
    pub qdd: &'a [f64],
    /// Torques (N m or N).
    pub tau: &'a [f64],
}

impl Samples {
    /// An empty set of samples of an arm with `dof` joints.
    pub fn new(dof: usize) -> Self {
        Self { dof, ..Self::default() }
    }

    /// Whether there are samples, of `arm` if it is given.
    ///
    /// # Errors
    /// [`TorqueError::Joints`] if the arm has another number of joints, [`TorqueError::NoSamples`] if there is none.
    pub(crate) fn check(&self, arm: Option<&Arm>) -> Result<(), TorqueError> {
        if let Some(arm) = arm
            && arm.dof() != self.dof
        {
            return Err(TorqueError::Joints { what: "training samples".into(), found: self.dof, expected: arm.dof() });
        }
        if self.is_empty() {
            return Err(TorqueError::NoSamples);
        }
        Ok(())
    }

    /// Adds one sample.
    ///
    /// # Errors
    /// [`TorqueError::Joints`] if a slice does not have one entry per joint.
    pub fn push(&mut self, sample: Sample<'_>) -> Result<(), TorqueError> {
        for (what, values) in [("q", sample.q), ("qd", sample.qd), ("qdd", sample.qdd), ("tau", sample.tau)] {
            if values.len() != self.dof {
                return Err(TorqueError::Joints { what: what.into(), found: values.len(), expected: self.dof });
            }
        }
        self.q.extend_from_slice(sample.q);
        self.qd.extend_from_slice(sample.qd);
        self.qdd.extend_from_slice(sample.qdd);
        self.tau.extend_from_slice(sample.tau);
        Ok(())
    }

    /// The number of joints.
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// The number of samples.
    pub fn len(&self) -> usize {
        self.q.len().checked_div(self.dof).unwrap_or(0)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.q.is_empty()
    }

    /// All samples in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Sample<'_>> {
        let dof = self.dof;
        (0..self.len()).map(move |k| {
            let row = k * dof..(k + 1) * dof;
            Sample {
                q: &self.q[row.clone()],
                qd: &self.qd[row.clone()],
                qdd: &self.qdd[row.clone()],
                tau: &self.tau[row],
            }
        })
    }
}
