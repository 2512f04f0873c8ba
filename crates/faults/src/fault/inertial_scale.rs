//! A factor of all masses and inertias.

use super::prelude::*;

/// The approximate number of links that carry most of an arm's torque.
const BODIES: f64 = 3.0;

pub(super) const FAULT: Fault = Fault {
    name: "inertial_scale",
    similar_faults: Some(SimilarFaults::Scales),
    draw: |bare, at, random| {
        let parts = if at.hard { 0.03..0.1 } else { 0.06..0.2 };
        bare.with("factor", at.factor(parts, BODIES, random))
    },
    read: |reader| {
        let factor = reader.number_above("factor", 0.0)?;
        Ok(vec![Body::changed(move |arm| arm.with_scaled_inertias(factor))])
    },
    #[cfg(test)]
    example: |bare| bare.with("factor", 1.2),
    ..Fault::ON_THE_ARM
};
