//! Any smooth function of the joint's own position.

use crate::{EffectKind, Form, Grounds, Regressor, Spec, Times, Turn};

/// Any smooth function of the joint's own position.
#[derive(Debug)]
pub struct OwnPosition;

static SPEC: Spec = Spec { name: "own_position", depends_on: Some(Regressor::OwnPosition), ..Spec::UNMODELLED };

impl EffectKind for OwnPosition {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn forms(&self, grounds: &Grounds<'_>) -> Vec<Form> {
        let form = |joint| Form::on(Turn::Curve, joint, grounds.tents(joint, joint, 12, Times::One));
        grounds.moving().map(form).collect()
    }
}
