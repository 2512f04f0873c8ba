//! The inertias of the links, in a form with which rapier computes the right motion.

use arm::{Arm, Inertia, JointKind, Matrix3, Vector3};

use crate::error::PlantError;

/// If the ratio of the smallest to the largest principal moment is below this, rapier's inverse of the tensor is
/// unreliable.
const SINGULAR: f64 = 1e-9;

/// The inertias of the links, base to tip, replaced by dynamically equivalent ones where rapier requires it.
///
/// rapier keeps a body's *inverse* tensor and inverts it again. A body without mass and a tensor of zeros come out
/// right, but a tensor without a moment about one or two axes becomes zero, and the motion is wrong without an error.
/// An equivalent body avoids this: a moment c about every axis perpendicular to joint i's own axis is added to link i and
/// subtracted from link i−1. This changes no torque, because both links have the same angular velocity about these axes
/// (the regrouping of Gautier and Khalil 1990). The base can give any amount. Across a prismatic joint, the same holds
/// for the moment about any axis.
///
/// # Errors
/// [`PlantError::Singular`], if the previous link has too little inertia to give, or if the missing moment is the one
/// about the joint's own axis.
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
            // Symmetric about the axis, so that it is the same at every q.
            let r = joint.parent_from_joint.rotation;
            inertias[parent].tensor -= r * moved * r.transpose();
        }
        if !is_simulable(&inertias[i].tensor) {
            return Err(PlantError::Singular { link: joint.link_name.clone(), smallest, largest });
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
