//! Any smooth function of another joint's position.

use crate::{EffectKind, Form, Grounds, Regressor, Spec, Times, Turn};

/// Any smooth function of another joint's position.
#[derive(Debug)]
pub struct OtherPosition;

static SPEC: Spec = Spec { name: "other_position", depends_on: Some(Regressor::OtherJoint), ..Spec::UNMODELLED };

impl EffectKind for OtherPosition {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn has_other(&self) -> bool {
        true
    }

    fn forms(&self, grounds: &Grounds<'_>) -> Vec<Form> {
        let form = |(joint, other)| {
            let terms = grounds.tents(joint, other, 8, Times::One);
            Form::on(Turn::Others, joint, terms).with(other)
        };
        grounds.pairs().map(form).collect()
    }
}
