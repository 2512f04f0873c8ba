//! The arm that a fit found: what is not linear in a tilt, an encoder's offset or a payload is small about it.

use arm::{Arm, Vector3};
use effects::{Carried, Term, arm::body};

use super::Study;
use crate::regression::fit::Fit;

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
        let mut found = Carried {
            arm: study.arm.clone(),
            offset: vec![0.0; study.arm.dof()],
            payload: [0.0; 10],
            tilt: [0.0; 2],
        };
        let mut carried = Vec::new();
        for (&column, &value) in fit.columns.iter().zip(&fit.coefficients) {
            let term = study.table.terms[column];
            if let (Some(carry), None) = (term.law.carry, term.onset()) {
                carry(&term, value, &mut found);
                carried.push((term, value));
            }
        }
        let Carried {
            mut arm,
            offset,
            payload,
            tilt: [x, y],
        } = found;
        let tilt = Vector3::new(x, y, 0.0);
        if payload[0] != 0.0 {
            arm = arm.with_payload(&body(&payload));
        }
        if tilt.norm() > 0.0 {
            arm = arm.with_turned_base(tilt, tilt.norm());
        }
        Self { arm, offset, carried }
    }
}
