//! Another body in the place of a link.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "inertial_parameters",
    // Campaigns draw `link_inertial_error`, and URDFs with errors.
    is_drawn: false,
    read: |reader| {
        let joint = reader.joint()?;
        let body = Inertia {
            mass: reader.number_above("mass", 0.0)?,
            com: reader.numbers("com")?.into(),
            tensor: tensor(reader)?,
        };
        Ok(vec![Body::changed(move |arm| arm.with_link_inertia(joint, body))])
    },
    #[cfg(test)]
    example: |bare| {
        let bare = bare.with("mass", 3.5).with("com", json!([0.02, 0.01, 0.09]));
        bare.with("inertia", json!([0.02, 0.0, 0.02, 0.0, 0.0, 0.01]))
    },
    ..Fault::ON_A_JOINT
};

/// The moments of inertia about the centre of mass (kg m²), zero for a point; those of a negative mass are negative, too.
pub(super) fn tensor(reader: &Reader<'_>) -> Result<Matrix3<f64>, FaultError> {
    let inertia = if reader.has("inertia") { reader.numbers("inertia")? } else { [0.0; 6] };
    let [xx, xy, yy, xz, yz, zz] = inertia;
    let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let sign = if reader.number("mass")? < 0.0 { -1.0 } else { 1.0 };
    let second = (Matrix3::identity() * (0.5 * tensor.trace()) - tensor) * sign;
    let moments = second.symmetric_eigenvalues();
    if moments.min() < -ROUNDING * moments.amax() {
        return Err(reader.fail(format!(
            "no body has the inertia {inertia:?}: of its principal moments, the two smaller must add up to the largest at least; \
             correct it, or leave that line out for a point mass"
        )));
    }
    Ok(tensor)
}

/// The part of the largest second moment of mass by which another may be negative, for rounding.
const ROUNDING: f64 = 1e-6;
