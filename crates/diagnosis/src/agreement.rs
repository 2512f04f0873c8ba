//! How well recordings, as they are read, agree with the model of the arm.

use arm::Arm;
use effects::drive::RotorInertia;
use effects::friction::{CoulombFriction, ViscousFriction};
use effects::sensor::TorqueOffset;
use effects::{Effect, EffectKind};

use crate::data::Data;
use crate::data::input::Input;
use crate::data::statistics::deviation;
use crate::diagnose::check;
use crate::error::DiagnosisError;
use crate::options::{Options, Wanted};
use crate::search::study::Study;
use crate::thresholds::CUTOFF;

/// The effects that nearly every URDF leaves out.
const PLAIN: [&dyn EffectKind; 4] = [&CoulombFriction, &ViscousFriction, &RotorInertia, &TorqueOffset];

/// How well the model of an arm explains recordings, with plain friction, drive inertia and a constant torque at every joint, and
/// with a background of inertial parameters, forms of friction and torque constants that differ from the URDF as far as the evidence
/// says.
#[derive(Clone, Debug)]
pub struct Agreement {
    /// Minus the logarithm of the evidence of the torques, each joint's relative to its standard deviation (nats). It is comparable
    /// between several ways to read the same rows: other signs, zeros and orders of the joints.
    pub misfit: f64,
    /// That of each joint's torque alone, without the cost of the background (nats).
    pub misfit_of: Vec<f64>,
    /// The share of the variance of each joint's torque that is not explained.
    pub unexplained: Vec<f64>,
    /// The half-power frequency of the low-pass filter (Hz).
    pub cutoff: f64,
}

/// The agreement of all `inputs` that are not held out with `arm`, the effects `known` included. Effects that are physically
/// impossible with their coefficients, such as friction that drives the joint, are left out.
///
/// # Errors
/// [`DiagnosisError`], if there is nothing to fit or a recording does not fit the arm.
pub fn agreement(
    arm: &Arm,
    inputs: &[Input<'_>],
    known: &[Effect],
    cutoff: Option<f64>,
) -> Result<Agreement, DiagnosisError> {
    check(arm, inputs, cutoff.unwrap_or(CUTOFF))?;
    let wanted = |kind: &&dyn EffectKind| {
        let joints = arm.joints().iter();
        let of = |joint: &arm::Joint| Wanted {
            effect: kind.spec().name.to_owned(),
            joint: Some(joint.name.clone()),
            ..Wanted::default()
        };
        joints.map(of).collect::<Vec<_>>()
    };
    let options = Options {
        cutoff,
        known: known.to_vec(),
        only: Some(PLAIN.iter().flat_map(wanted).collect()),
        ..Options::default()
    };
    let mut study = Study::new(Data::new(arm, inputs, &options)?, &options);
    // Forms of friction in the background have no sign, and may drive a joint.
    study.stated.is_friction_plain = true;
    let is_plain = |&candidate: &usize| study.terms(candidate).iter().all(|term| term.onset().is_none());
    let mut set: Vec<usize> = (0..study.candidates.len()).filter(is_plain).collect();
    loop {
        let products = study.training_products();
        let problem = study.problem(&products);
        let chosen = problem.reweighted(problem.choose(set.clone(), &products.first_weights()));
        let chosen = study.with_best_strengths(chosen);
        let products = study.training_products();
        let problem = study.problem(&products);
        let before = set.len();
        set.retain(|&candidate| problem.is_possible(candidate, &chosen.fit));
        if set.len() == before {
            // The mean square about the mean, of the rows that are fitted.
            let variance = |joint: usize| {
                let rows = study.training_rows(joint);
                let torques: Vec<f64> = rows.iter().map(|&row| study.measured[joint][row]).collect();
                deviation(torques.iter()).powi(2).max(f64::MIN_POSITIVE)
            };
            let variances: Vec<f64> = (0..arm.dof()).map(variance).collect();
            let size: Vec<f64> = (0..arm.dof())
                .map(|j| 0.5 * products.evidence[j] * variances[j].ln())
                .collect();
            let unexplained =
                |joint: usize| chosen.fit.rss[joint] / (products.count[joint].max(1.0) * variances[joint]);
            return Ok(Agreement {
                misfit: chosen.score - size.iter().sum::<f64>(),
                misfit_of: (0..arm.dof())
                    .map(|joint| products.joint_loss(joint, chosen.fit.rss[joint]) - size[joint])
                    .collect(),
                unexplained: (0..arm.dof()).map(unexplained).collect(),
                cutoff: study.motions.cutoff,
            });
        }
    }
}
