//! The arm that a fit found: what is not linear in a tilt, an encoder's offset or a payload is small about it.

use arm::{Arm, Vector3};

use super::Study;
use crate::data::measure::inertia;
use crate::regression::fit::Fit;
use crate::regression::term::Term;

/// An arm with what a fit found in it.
pub struct About {
    /// Payload, link errors, scale and base in it.
    pub arm: Arm,
    /// How far the joints stand beyond their encoders (rad or m).
    pub offset: Vec<f64>,
    /// The terms that are in it, by their coefficients.
    pub carried: Vec<(Term, f64)>,
}

impl About {
    /// The arm of `study` with what `fit` found.
    pub fn new(study: &Study, fit: &Fit) -> Self {
        let mut arm = study.arm.clone();
        let mut offset = vec![0.0; arm.dof()];
        let mut carried = Vec::new();
        let mut tilt = Vector3::zeros();
        let mut payload = [0.0; 10];
        for (&column, &value) in fit.columns.iter().zip(&fit.coefficients) {
            let term = study.table.terms[column];
            match term {
                Term::Payload(k) => payload[k] = value,
                Term::Link(link) => arm = arm.with_scaled_link(link, 1.0 + value),
                Term::Scale => arm = arm.with_scaled_inertias(1.0 + value),
                Term::EncoderOffset(joint) => offset[joint] = value,
                Term::Tilt(axis) => tilt[axis] = value,
                _ => continue,
            }
            carried.push((term, value));
        }
        if payload[0] != 0.0 {
            arm = arm.with_payload(&inertia(&payload));
        }
        if tilt.norm() > 0.0 {
            arm = arm.with_turned_base(tilt, tilt.norm());
        }
        Self { arm, offset, carried }
    }
}
