//! Phase 4, selection: the effects that keep their name, by size, evidence and prediction of held-out recordings.

use rayon::prelude::*;

use crate::error::DiagnosisError;
use crate::options::{Options, Step};
use crate::regression::fit::Products;
use crate::search::plan;
use crate::search::study::Study;
use crate::selection::bootstrap::Resampled;
use crate::thresholds::MOST_REFUSED;

pub mod bootstrap;
pub mod constant_torques;
pub mod direction;
pub mod final_fit;
pub mod gain;
pub mod hypothesis;
pub mod judge;
pub mod naming;
pub mod predict;
pub mod rivals;
pub mod special_forms;
pub mod torque_constants;
pub mod unmounted;
pub mod without_moment;

/// The final fit: the named effects, their uncertainty, and the residuals.
pub struct FinalFit {
    /// The named effects and the unmodelled forms.
    pub judged: judge::Judged,
    /// The resampled coefficients of the named effects.
    pub resampled: Resampled,
    /// Inner products over the training recordings.
    pub products: Products,
    /// Inner products over the held-out recordings, if there are any.
    pub held: Option<Products>,
    /// The residuals of the named effects (N m or N): `[joint][row]`.
    pub residual: Vec<Vec<f64>>,
}

impl FinalFit {
    /// The final fit of the effects that are searched, or of those that `options` request.
    ///
    /// # Errors
    /// [`DiagnosisError::Wanted`], if a requested effect cannot be fitted.
    pub fn new(study: &mut Study, options: &Options, progress: &dyn Fn(Step<'_>)) -> Result<Self, DiagnosisError> {
        let (judged, mut resampled) = match &options.only {
            Some(wanted) => {
                progress(Step::new(0.3, "fitting the requested effects"));
                let mut judged = hypothesis::fit(study, wanted)?;
                let resampled = final_fit::as_given(study, &mut judged);
                (judged, resampled)
            }
            None => found(study, progress),
        };
        resampled.allow_for_other_background(study, &judged.named);
        let joints = (0..study.data.arm.dof()).into_par_iter();
        let residual = joints
            .map(|joint| predict::augmented(&study.data, &study.table, &judged.named.fit, joint))
            .collect();
        Ok(Self {
            products: study.training_products(),
            held: study.held_products(),
            judged,
            resampled,
            residual,
        })
    }
}

/// Repeats search and selection until the final fit refuses no further name.
fn found(study: &mut Study, progress: &dyn Fn(Step<'_>)) -> (judge::Judged, Resampled) {
    loop {
        let refused = study.refused();
        let selected = plan::search(study, progress);
        progress(Step::new(0.6, "testing the selected effects"));
        let (products, held) = (study.training_products(), study.held_products());
        let mut judged = judge::judge(study, &products, held.as_ref(), selected);
        progress(Step::new(0.61, "final fit and intervals"));
        let resampled = final_fit::confirmed(study, &mut judged);
        // A refused name may have prevented that another effect was found.
        if study.refused() == refused || refused > MOST_REFUSED {
            let resampled = direction::decide(study, &mut judged).unwrap_or(resampled);
            let resampled = unmounted::unmounted(study, &mut judged).unwrap_or(resampled);
            return (judged, resampled);
        }
        study.restart();
    }
}
