//! How well recordings agree with the model of the arm.

use arm::Arm;
use effects::{Effect, OMITTED_BY_MOST, Spec};

use crate::data::Data;
use crate::data::input::{Input, check};
use crate::data::statistics::deviation;
use crate::error::DiagnosisError;
use crate::options::{Options, Wanted};
use crate::regression::fit::Products;
use crate::regression::strengths::PriorStrengths;
use crate::search::plan;
use crate::search::problem::Selection;
use crate::search::study::Study;
use crate::thresholds::{CUTOFF, FAR_LESS};

/// How well the model of an arm explains recordings, with plain friction, drive inertia and a constant torque at every joint, and
/// with a background of inertial parameters and torque constants that differ from the URDF as far as the evidence says, and with a load at
/// the tip that only some of the recordings have.
#[derive(Clone, Debug)]
pub struct Agreement {
    /// Minus the logarithm of the evidence of the torques, each joint's relative to its standard deviation (nats). It is comparable
    /// between corrections of the columns of the same rows: other signs, zeros and orders of the joints.
    pub misfit: f64,
    /// Minus the log-likelihood of each joint's torque alone, without the cost of the background (nats).
    pub misfit_of: Vec<f64>,
    /// The share of the variance of each joint's torque that is not explained.
    pub unexplained: Vec<f64>,
    /// The half-power frequency of the low-pass filter (Hz).
    cutoff: f64,
    /// The strengths of the background.
    strengths: PriorStrengths,
}

/// The agreement of all `inputs` that are not held out with `arm`, the effects `known` included. Effects that are physically
/// impossible with their coefficients, such as friction that drives the joint, are left out.
///
/// If `other` is given, the agreement of the same rows before a correction of their columns, they are filtered with its cut-off. If
/// they agree much less (200 nats), no other background is tried.
///
/// # Errors
/// [`DiagnosisError`], if there is nothing to fit or a recording does not fit the arm.
pub fn agreement(
    arm: &Arm,
    inputs: &[Input<'_>],
    known: &[Effect],
    other: Option<&Agreement>,
) -> Result<Agreement, DiagnosisError> {
    let cutoff = other.map(|other| other.cutoff);
    check(arm, inputs, cutoff.unwrap_or(CUTOFF))?;
    let wanted = |spec: &&Spec| {
        let joints = arm.joints().iter();
        let of = |joint: &arm::Joint| Wanted {
            effect: spec.name.to_owned(),
            joint: Some(joint.name.clone()),
            ..Wanted::default()
        };
        joints.map(of).collect::<Vec<_>>()
    };
    let options = Options {
        cutoff,
        known: known.to_vec(),
        only: Some(OMITTED_BY_MOST.iter().flat_map(wanted).collect()),
        ..Options::default()
    };
    // What is compared needs only the torques and masses of the model, but known effects may need more.
    let data = Data::before_a_correction(arm, inputs, &options, !known.is_empty())?;
    let mut study = Study::new(data, &options).with_any_own_load(&options);
    // Forms of friction in the background have no sign, and may drive a joint.
    study.stated.is_friction_plain = true;
    let is_plain = |&candidate: &usize| study.always_acts(candidate);
    let mut set: Vec<usize> = (0..study.candidates.len()).filter(is_plain).collect();
    if let Some(other) = other {
        study.strengths = other.strengths.clone();
    }
    let is_far = |found: &Agreement| other.is_some_and(|other| found.misfit > other.misfit + FAR_LESS);
    loop {
        let products = study.training_products();
        let problem = study.problem(&products);
        let mut selected = problem.reweighted(problem.choose(set.clone(), &products.first_weights()));
        if !is_far(&found(&study, &products, &selected)) {
            selected = study.with_best_strengths(selected);
        }
        let products = study.training_products();
        let problem = study.problem(&products);
        let before = set.len();
        set.retain(|&candidate| problem.is_possible(candidate, &selected.fit));
        let found = found(&study, &products, &selected);
        if set.len() == before || is_far(&found) {
            return Ok(found);
        }
    }
}

/// The misfit of the recordings as in [`Agreement::misfit`], if the whole catalogue of effects is searched (nats), with the filter of
/// `other`. It is comparable only with other results of this function.
///
/// # Errors
/// [`DiagnosisError`], if there is nothing to fit or a recording does not fit the arm.
pub fn searched(arm: &Arm, inputs: &[Input<'_>], known: &[Effect], other: &Agreement) -> Result<f64, DiagnosisError> {
    check(arm, inputs, other.cutoff)?;
    let options = Options { cutoff: Some(other.cutoff), known: known.to_vec(), ..Options::default() };
    let mut study =
        Study::new(Data::before_a_correction(arm, inputs, &options, true)?, &options).with_any_own_load(&options);
    let selected = plan::search(&mut study, &|_| ());
    Ok(found(&study, &study.training_products(), &selected).misfit)
}

/// What the fit `selected` says.
fn found(study: &Study, products: &Products, selected: &Selection) -> Agreement {
    let joints = || 0..study.data.arm.dof();
    // The mean square about the mean, of the rows that are fitted.
    let variance = |joint: usize| {
        let rows = study.table.moving_rows(joint, &study.data.fitted);
        let torques: Vec<f64> = rows.iter().map(|&row| study.data.measured[joint][row]).collect();
        deviation(torques.iter()).powi(2) + products.floor[joint]
    };
    let variances: Vec<f64> = joints().map(|joint| variance(joint).max(f64::MIN_POSITIVE)).collect();
    let size = |joint: usize| 0.5 * products.evidence[joint] * variances[joint].ln();
    Agreement {
        misfit: selected.score - joints().map(size).sum::<f64>(),
        misfit_of: joints().map(|joint| products.joint_loss(joint, selected.fit.rss[joint]) - size(joint)).collect(),
        unexplained: joints()
            .map(|joint| selected.fit.rss[joint] / (products.count[joint].max(1.0) * variances[joint]))
            .collect(),
        cutoff: study.data.motions.cutoff,
        strengths: study.strengths.clone(),
    }
}
