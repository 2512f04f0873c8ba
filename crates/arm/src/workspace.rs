//! Memory that the algorithms write to, kept by the caller so that no call allocates.

use crate::model::Arm;
use crate::pose::Pose;
use crate::scratch::Scratch;

/// Scratch for the algorithms on one [`Arm`]; make it once and pass it to every call.
#[derive(Clone, Debug)]
pub struct Workspace {
    pub(crate) scratch: Scratch<f64>,
    pub(crate) base_from_link: Vec<Pose>,
    pub(crate) zeros: Vec<f64>,
}

impl Workspace {
    /// Scratch for `arm`, or for any other arm with the same number of joints.
    pub fn new(arm: &Arm) -> Self {
        Self {
            scratch: Scratch::new((), arm.dof()),
            base_from_link: vec![Pose::identity(); arm.dof()],
            zeros: vec![0.0; arm.dof()],
        }
    }

    /// Checks that this workspace and the joint vectors have the arm's number of joints.
    pub(crate) fn check(&self, arm: &Arm, vectors: &[&[f64]]) {
        let n = arm.dof();
        assert_eq!(self.base_from_link.len(), n, "the workspace was made for another arm");
        for vector in vectors {
            assert_eq!(vector.len(), n, "a joint vector has one entry per joint");
        }
    }
}
