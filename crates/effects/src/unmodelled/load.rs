//! A nonlinear function of the joint's own torque.

use crate::{EffectKind, Form, Grounds, Law, Regressor, Spec, Term, Turn};

/// A nonlinear function of the joint's own torque, as of a torque sensor or current whose gain is not constant.
#[derive(Debug)]
pub struct Load;

static SPEC: Spec = Spec { name: "load", depends_on: Some(Regressor::Load), ..Spec::UNMODELLED };

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

impl EffectKind for Load {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn forms(&self, grounds: &Grounds<'_>) -> Vec<Form> {
        let form = |joint| Form::on(Turn::Others, joint, vec![Term::on(&OWN_TORQUE, joint)]);
        grounds.moving().map(form).collect()
    }
}
