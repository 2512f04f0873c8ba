//! Any smooth function of the joint's own position.

use crate::{Regressor, Spec, Times, Turn};

/// Any smooth function of the joint's own position.
pub static OWN_POSITION: Spec = Spec {
    name: "own_position",
    depends_on: Some(Regressor::OwnPosition),
    forms: |grounds| grounds.on_moving(Turn::Curve, |joint| grounds.tents(joint, joint, 12, Times::One)),
    ..Spec::UNMODELLED
};
