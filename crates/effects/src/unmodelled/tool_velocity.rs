//! A force on the tool that depends on the tool's velocity.

use crate::{Form, Law, Regressor, Spec, Term};

/// A force on the tool that depends on the tool's velocity, as of air, water or a hose that is dragged.
pub static TOOL_VELOCITY: Spec = Spec {
    name: "tool_velocity",
    depends_on: Some(Regressor::ToolVelocity),
    forms: |_| {
        let [linear, quadratic] = [0, 1].map(|form| Term::about(&TOOL_DRAG, 0).form(form));
        [vec![linear], vec![quadratic], vec![linear, quadratic]].map(Form::of_arm).to_vec()
    },
    ..Spec::UNMODELLED
};

/// Jᵀ v (form 0) or Jᵀ v |v| (form 1), where J is the Jacobian of the tool's position and v = J q̇.
static TOOL_DRAG: Law = Law {
    name: "drag on the tool",
    column: |term, joint, motion| {
        let force = &motion.rigid.force;
        motion.map(|k| {
            let v = [0, 1, 2].map(|axis: usize| -> f64 {
                force.iter().zip(motion.qd).map(|(force, qd)| force[axis][k] * qd[k]).sum()
            });
            let along: f64 = (0..3).map(|axis| force[joint][axis][k] * v[axis]).sum();
            let speed = v.iter().map(|v| v * v).sum::<f64>().sqrt();
            if term.form == 1 { along * speed } else { along }
        })
    },
    needs_model: true,
    ..Law::PLAIN
};
