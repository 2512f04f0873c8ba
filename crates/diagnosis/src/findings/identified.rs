//! The control for comparison: full linear identification, without names.

use effects::drive::RotorInertia;
use effects::friction::{CoulombFriction, ViscousFriction};
use effects::sensor::TorqueOffset;

use crate::regression::strengths::Strengths;
use crate::search::study::Study;
use crate::selection::predict::{augmented, errors};

/// The standard deviation of the prior on inertial parameters, in multiples of their size. It is so wide that it only
/// regularises the normal equations.
const FREE: f64 = 3.0;

/// The held-out error (NRMSE) of each joint with least squares on all inertial parameters, and on viscous and Coulomb friction,
/// drive inertia and a constant of every joint.
pub fn identified(study: &Study) -> Vec<Option<f64>> {
    let strengths = Strengths {
        links: vec![FREE; study.arm.dof()],
        ..Strengths::none(study.arm.dof())
    };
    let products = study.products_at(&strengths);
    let problem = study.problem(&products);
    let is_part = |&candidate: &usize| {
        let hypothesis = study.candidates[candidate].hypothesis;
        let always = study.always_acts(candidate);
        let is = |kind: &'static dyn effects::EffectKind| hypothesis.is(kind);
        always && (is(&ViscousFriction) || is(&CoulombFriction) || is(&RotorInertia) || is(&TorqueOffset))
    };
    let set: Vec<usize> = (0..study.candidates.len()).filter(is_part).collect();
    let selected = problem.reweighted(problem.choose(set, &products.first_weights()));
    (0..study.arm.dof())
        .map(|joint| errors(study, joint, &augmented(study, &selected, joint)).held_out_nrmse_augmented)
        .collect()
}
