//! A force on the tool that depends on the tool's velocity.

use crate::{Form, Law, Regressor, Spec, Term};

/// A force on the tool that depends on the tool's velocity, as of air, water or a hose that is dragged.
pub static TOOL_VELOCITY: Spec = Spec {
    name: "tool_velocity",
    depends_on: Some(Regressor::ToolVelocity),
    forms: |_| {
        let form = |powers: &[usize]| Form::of_arm(powers.iter().map(|&k| Term::about(&TOOL_DRAG, k)).collect());
        vec![form(&[LINEAR]), form(&[QUADRATIC]), form(&[LINEAR, QUADRATIC])]
    },
    ..Spec::UNMODELLED
};

const LINEAR: usize = 0;
const QUADRATIC: usize = 1;

/// Jᵀ v or Jᵀ v |v|, where J is the Jacobian of the tool's position and v = J q̇.
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
            if term.of[0] == QUADRATIC { along * speed } else { along }
        })
    },
    needs_model: true,
    ..Law::PLAIN
};
