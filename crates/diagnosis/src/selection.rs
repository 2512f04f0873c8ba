//! Phase 4, selection: the effects that keep their name, by size, evidence and prediction of held-out recordings.

use effects::Spec;
use rayon::prelude::*;

use crate::error::DiagnosisError;
use crate::options::{Options, Step};
use crate::regression::fit::Products;
use crate::search::plan;
use crate::search::problem::Problem;
use crate::search::study::Study;
use crate::selection::bootstrap::Resampled;
use crate::selection::predict::{augmented, exported};
use crate::thresholds::MOST_REFUSED;

pub mod bootstrap;
pub mod breakaway;
pub mod constant_torques;
pub mod coupling;
pub mod direction;
mod drive_or_body;
pub mod final_fit;
pub mod gain;
pub mod held_out_friction;
pub mod hypothesis;
pub mod identified;
pub mod judge;
pub mod naming;
pub mod of_noise;
pub mod payload;
pub mod predict;
mod resembling_links;
mod restored;
pub mod rivals;
pub mod special_forms;
pub mod torque_constants;
pub mod unclear;
mod variation;

/// The final fit: the named effects, their uncertainty, and the residuals.
pub struct FinalFit {
    /// The state in which search and selection ended: the columns about the arm with the named effects, and the background.
    pub study: Study,
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
    /// The residuals of the exported model (N m or N): `[joint][row]`.
    pub exported: Vec<Vec<f64>>,
    /// The payload on an arm of few joints, and its margin over wrong links (nats).
    pub payload: Option<(usize, f64)>,
    /// Each joint's held-out error (NRMSE) with full linear identification.
    pub identified: Vec<Option<f64>>,
}

impl FinalFit {
    /// The final fit of the effects that are searched in `study`, or of those that `options` request.
    ///
    /// # Errors
    /// [`DiagnosisError::Wanted`], if a requested effect cannot be fitted.
    pub fn new(mut study: Study, options: &Options, progress: &dyn Fn(Step<'_>)) -> Result<Self, DiagnosisError> {
        let identified = identified::identified(&study);
        let (judged, mut resampled) = match &options.only {
            Some(wanted) => {
                progress(Step::new(0.3, "fitting the requested effects"));
                let mut judged = hypothesis::fit(&mut study, wanted)?;
                let resampled = final_fit::as_given(&mut study, &mut judged);
                (judged, resampled)
            }
            None => found(&mut study, progress),
        };
        resampled.allow_for_other_background(&mut study, &judged.named);
        let payload = payload::beside_few_links(&mut study, &judged.named);
        let (data, table, fit) = (&study.data, &study.table, &judged.named.fit);
        let joints = || (0..data.arm.dof()).into_par_iter();
        Ok(Self {
            residual: joints().map(|joint| augmented(data, table, fit, joint)).collect(),
            exported: joints().map(|joint| exported(data, table, fit, joint)).collect(),
            products: study.training_products(),
            held: study.held_products(),
            payload,
            identified,
            judged,
            resampled,
            study,
        })
    }

    /// Whether an effect of this kind is named on `joint`.
    pub fn names(&self, kind: &'static Spec, joint: usize) -> bool {
        self.judged.named.set.iter().any(|&c| {
            let candidate = &self.study.candidates[c];
            candidate.joint == Some(joint) && candidate.hypothesis.is(kind)
        })
    }

    /// The start and the end of each named contact (s).
    pub fn contacts(&self) -> Vec<[f64; 2]> {
        let Study { candidates, table, .. } = &self.study;
        let named = self.judged.named.set.iter();
        named.filter_map(|&c| candidates[c].window(table)).collect()
    }

    /// The problem of the training recordings.
    pub fn problem(&self) -> Problem<'_> {
        self.study.problem(&self.products)
    }
}

/// Repeats search and selection until the final fit refuses no further name.
fn found(study: &mut Study, progress: &dyn Fn(Step<'_>)) -> (judge::Judged, Resampled) {
    loop {
        let refused = study.refused();
        let selected = plan::search(study, progress);
        let selected = payload::compact::with_drives(study, selected);
        progress(Step::new(0.6, "testing the selected effects"));
        let mut judged = {
            let (products, held) = (study.training_products(), study.held_products());
            judge::judge(study, &products, held.as_ref(), selected)
        };
        progress(Step::new(0.61, "final fit and intervals"));
        let resampled = final_fit::confirmed(study, &mut judged);
        // A refused name may have prevented that another effect was found.
        if study.refused() == refused || refused > MOST_REFUSED {
            let resampled = direction::decide(study, &mut judged).unwrap_or(resampled);
            let resampled = payload::unmounted::unmounted(study, &mut judged).unwrap_or(resampled);
            return (judged, resampled);
        }
        study.restart();
    }
}
