//! Any smooth function of another joint's position.

use crate::{Form, Regressor, Spec, Times, Turn};

/// Any smooth function of another joint's position.
pub static OTHER_POSITION: Spec = Spec {
    name: "other_position",
    depends_on: Some(Regressor::OtherJoint),
    has_other: true,
    forms: |grounds| {
        let form = |(joint, other)| {
            let terms = grounds.tents(joint, other, 8, Times::One);
            Form::on(Turn::Others, joint, terms).with(other)
        };
        grounds.pairs().map(form).collect()
    },
    ..Spec::UNMODELLED
};
