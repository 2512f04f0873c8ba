//! The links' inertias, made such that rapier moves them rightly.

use arm::{Arm, Inertia, JointKind, Matrix3, Vector3};

use crate::error::PlantError;

/// Below this ratio of the smallest to the largest principal moment, rapier's inverse of the tensor is not to
/// be trusted.
const SINGULAR: f64 = 1e-9;

/// The links' inertias, base to tip, replaced by dynamically equivalent ones where rapier needs it.
///
/// rapier keeps a body's *inverse* tensor and inverts it again: no mass, and no tensor at all, come out
/// right, but a tensor that has no moment about one or two axes becomes nothing at all, and the motion is
/// silently wrong. A moment c about every axis across joint i's own turns with link i and with link i−1
/// alike, so that taking it from the one and giving it to the other changes no torque (the regrouping of
/// Gautier and Khalil 1990); the base has any amount of it to give. Across a prismatic joint so does a moment
/// about any axis.
///
/// # Errors
/// [`PlantError::Singular`], if the joint before has nothing to give or the missing moment is the
/// one about the joint's own axis.
pub(crate) fn simulable_inertias(arm: &Arm) -> Result<Vec<Inertia>, PlantError> {
    let mut inertias: Vec<Inertia> = arm.joints().iter().map(|joint| joint.inertia).collect();
    for i in 0..inertias.len() {
        let joint = &arm.joints()[i];
        if is_simulable(&inertias[i].tensor) {
            continue;
        }
        let (smallest, largest) = moments(&inertias[i].tensor);
        let given = match i.checked_sub(1) {
            None => largest,
            Some(parent) => 0.5 * moments(&inertias[parent].tensor).0.max(0.0),
        };
        let transferable = match joint.kind {
            JointKind::Revolute => Matrix3::identity() - joint.axis * joint.axis.transpose(),
            JointKind::Prismatic => Matrix3::identity(),
        };
        let moved = given * transferable;
        inertias[i].tensor += moved;
        if let Some(parent) = i.checked_sub(1) {
            // Symmetric about the axis, so the same at every q.
            let r = joint.parent_from_joint.rotation;
            inertias[parent].tensor -= r * moved * r.transpose();
        }
        if !is_simulable(&inertias[i].tensor) {
            return Err(PlantError::Singular {
                link: joint.link_name.clone(),
                smallest,
                largest,
            });
        }
    }
    Ok(inertias)
}

fn is_simulable(tensor: &Matrix3<f64>) -> bool {
    let (smallest, largest) = moments(tensor);
    *tensor == Matrix3::zeros() || smallest > SINGULAR * largest
}

fn moments(tensor: &Matrix3<f64>) -> (f64, f64) {
    let moments: Vector3<f64> = tensor.symmetric_eigenvalues();
    (moments.min(), moments.max())
}
