//! A base that sways under the torque of the arm.

use crate::compliance::{Compliant, LinkSide, swaying};
use crate::{Form, Law, Regressor, Signals, Spec, Term};

/// A base that sways under the torque of the arm, such as a table, a cart or a pedestal.
pub static BASE_MOTION: Spec = Spec {
    name: "base_motion",
    depends_on: Some(Regressor::BaseMotion),
    forms: |grounds| {
        let inertia = grounds.inertia_about_base();
        let form = |hertz: f64| {
            let omega = std::f64::consts::TAU * hertz;
            let term = |axis: usize| {
                let sizes = [inertia[axis] * omega * omega, 2.0 * DAMPING_RATIO * inertia[axis] * omega];
                Term::about(&SWAY, axis).sized(sizes)
            };
            Form::of_arm(vec![term(0), term(1)])
        };
        let sways = grounds.dof() >= LEAST_JOINTS && inertia.iter().all(|inertia| *inertia > 0.0);
        if sways { FREQUENCIES.map(form).to_vec() } else { Vec::new() }
    },
    // No base yields against the torque; one that hardly sways about an axis has any small coefficient there.
    is_possible: |fitted| {
        let values = [fitted.value(0), fitted.value(1)];
        let [least, most] = [f64::min, f64::max].map(|of| of(values[0], values[1]));
        least > -LEAST_OF_LARGER * most
    },
    ..Spec::UNMODELLED
};

/// The torque on the joints of a base that turns about its x axis (`of[0]` is 0) or y axis (1) on a spring and a damper; sizes are
/// stiffness (N m/rad) and damping (N m s/rad).
static SWAY: Law = Law {
    name: "sway",
    column: |term, joint, motion| Some(link_side(term, motion).torque(joint, motion.rigid)),
    needs_model: true,
    link_side: Some(link_side),
    is_of_base: true,
    ..Law::PLAIN
};

fn link_side(term: &Term, motion: &Signals<'_>) -> LinkSide {
    let (axis, [stiffness, damping, ..]) = (term.of[0], term.sizes);
    LinkSide::new(Compliant::Base(axis), swaying(axis, stiffness, damping, motion))
}

/// The frequencies at which the base sways under the arm (Hz). Above the highest one, it follows the torque.
const FREQUENCIES: [f64; 4] = [3.0, 6.0, 12.0, 25.0];
/// The damping ratio of the base.
const DAMPING_RATIO: f64 = 0.05;
/// The part of the larger coefficient by which that about the other axis may be negative.
const LEAST_OF_LARGER: f64 = 0.2;
/// The least number of joints with which a swaying base is told from wrong masses and drives. Source: a real double pendulum, whose residual
/// it resembled.
const LEAST_JOINTS: usize = 3;
