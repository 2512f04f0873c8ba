//! One control step of a run, as the recording and the viewer see it.
#![cfg_attr(not(feature = "viewer"), expect(dead_code, reason = "the viewer is its reader"))]

/// One control step; slices have one entry per joint, in rad and N m (or m and N).
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Time since the start of the run (s).
    pub time: f64,
    /// Position of the plant.
    pub q: &'a [f64],
    /// Position of the reference.
    pub q_ref: &'a [f64],
    /// Feed-forward torque of the rigid-body part of the model.
    pub tau_rigid: &'a [f64],
    /// Feed-forward torque of the learned part of the model.
    pub tau_learned: &'a [f64],
    /// Feedback torque.
    pub tau_feedback: &'a [f64],
    /// Torque applied to the plant, after saturation.
    pub tau_applied: &'a [f64],
    /// Variance of the learned torque ((N m)² or N²); `None` if it was not evaluated at this step.
    pub variance: Option<&'a [f64]>,
}
