//! A nonlinear function of the joint's own torque.

use crate::{Law, Regressor, Spec, Term, Turn};

/// A nonlinear function of the joint's own torque, as of a torque sensor or current whose gain is not constant.
pub static LOAD: Spec = Spec {
    name: "load",
    depends_on: Some(Regressor::Load),
    forms: |grounds| grounds.on_moving(Turn::Others, |joint| vec![Term::on(&OWN_TORQUE, joint)]),
    ..Spec::UNMODELLED
};

/// τ |τ| of the rigid model over its scale. A dead band of the torque, sgn τ, is left out: it resembles a gap in a gear.
static OWN_TORQUE: Law = Law {
    name: "own torque",
    column: |_, joint, motion| {
        let torque = &motion.rigid.tau[joint];
        let scale = motion.scales.torque[joint].max(1e-9);
        motion.map(|k| torque[k] * torque[k].abs() / scale)
    },
    needs_model: true,
    ..Law::PLAIN
};
