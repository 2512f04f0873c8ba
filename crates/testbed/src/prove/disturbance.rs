//! The paper's own disturbance as a case: a PUMA 560 with masses and inertias 20 % too large in the URDF, trained on task A,
//! held out on task D.

pub mod words;

use std::path::Path;

use anyhow::Context;
use effects::Effect;
use effects::arm::INERTIAL_SCALE;
use faults::{Concealment, Injected, Truth};
use recording::Recording;
use scoring::{Answer, Named, Number};
use serde::Serialize;
use torque::{Corrected, RigidBody, TorqueModel, TrainingOptions};

use super::rows::Row;
use crate::models::ModelKind;
use crate::scenario::Scenario;
use crate::{paper, simulation, tables, training};
use study::urdf_file::changed_urdf;

/// The case's name; those drawn begin with `case_`.
pub const CASE: &str = "paper";
/// The training task, as in the paper's table I.
const TRAIN: &str = "taskA";
/// The held-out task, for which torque errors are given.
const TEST: &str = "taskD";
/// The effect that the wrong URDF amounts to.
const EFFECT: &str = "inertial_scale";
/// The alternative that cannot be excluded without a known load: a common scale of all measured torques.
const ALIAS: &str = "torque_scale";
/// A mean squared torque error below this is rounding error for torques of tens of N m ((N m)²).
const ROUNDING: f64 = 1e-6;

/// The outcome of the case: `paper` in `score.json`.
#[derive(Serialize)]
pub struct Disturbance {
    /// The URDF's masses and inertia tensors over the true ones.
    pub inertia_scale: f64,
    /// The effects that the diagnosis names; empty without an answer.
    pub findings: Vec<NamedEffect>,
    /// Whether the inertial scale is the only finding.
    pub is_one_finding: bool,
    /// The alternatives that the diagnosis states.
    pub aliases: Vec<NamedEffect>,
    /// Whether the alternatives are the torque scales of all joints and nothing else.
    pub aliases_are_all_torque_scales: bool,
    /// The estimated factor.
    pub factor: Option<Factor>,
    /// The torque error on task D of the URDF with the named effects.
    pub diagnosed: Option<Errors>,
    /// Whether its mean is below 1e-6 (N m)².
    pub is_rounding: bool,
    /// The torque models of table I, which learned from the same task.
    pub others: Vec<Other>,
}

/// An effect and its joint.
#[derive(Serialize)]
pub struct NamedEffect {
    /// The catalogue's name.
    pub effect: String,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
}

/// The factor that takes the URDF's inertias to the true ones.
#[derive(Serialize)]
pub struct Factor {
    /// The estimate.
    pub value: f64,
    /// Its 95 % interval.
    pub ci95: [Option<f64>; 2],
    /// The true factor, one over [`Disturbance::inertia_scale`].
    pub truth: f64,
    /// The estimate minus the truth.
    pub off: f64,
    /// Whether the interval contains the true value.
    pub is_covered: bool,
}

/// Mean squared torque errors on the reference samples of task D, (N m)².
#[derive(Serialize)]
pub struct Errors {
    /// One value per joint.
    pub mse: Vec<f64>,
    /// The mean over the joints.
    pub mean: f64,
}

/// A torque model's errors, ours and the paper's.
#[derive(Serialize)]
pub struct Other {
    /// The errors after training on task A; `paper` is the paper's table I.
    #[serde(flatten)]
    pub row: tables::Row,
    /// The paper's table II, after training on tasks A, B and C.
    pub paper_table_2: Option<[f64; 6]>,
}

/// The recordings of the exact model's closed loop on both tasks, the heavy URDF, and the truth.
///
/// # Errors
/// If the user interrupts; simulating the paper's tasks does not fail.
pub fn conceal() -> anyhow::Result<Concealment> {
    let (train, held_out) = (Scenario::built_in(TRAIN)?, Scenario::built_in(TEST)?);
    let factor = 1.0 / train.inertia_scale;
    Ok(Concealment {
        truth: Truth {
            case: CASE.to_owned(),
            robot: train.arm.name().to_owned(),
            seed: 0,
            injected: vec![Injected {
                effect: EFFECT.to_owned(),
                joint: None,
                parameters: [("factor".to_owned(), factor.into())].into(),
                form: None,
                onset: None,
                minor: false,
                // All torques are proportional to the inertias, so that this share of each torque vanishes without the
                // error.
                expressed_share: Some(train.inertia_scale - 1.0),
            }],
            background_friction: false,
            torque_noise: vec![0.0; train.arm.dof()],
            encoder_quantum: 0.0,
            period: 1.0 / train.control_rate,
            urdf_sigma: Some(0.0),
            lifelike: None,
        },
        urdf: heavy_urdf(&train)?,
        train: vec![recorded(&train)?],
        held_out: recorded(&held_out)?,
    })
}

/// The URDF of the paper's controller: [`Scenario::nominal_arm`] as an edit of the robot's own file.
fn heavy_urdf(scenario: &Scenario) -> anyhow::Result<String> {
    let urdf = study::robot::named_robot(scenario.arm.name())?.text;
    let heavier = Effect::of(&INERTIAL_SCALE).with("factor", scenario.inertia_scale);
    changed_urdf(&urdf, &scenario.arm, &[heavier])
}

/// A run under the exact model with only the columns of a robot's logger, because the parts of the torque would reveal the
/// ground truth.
fn recorded(scenario: &Scenario) -> anyhow::Result<Recording> {
    let exact = RigidBody::new(scenario.arm.clone());
    let run = simulation::run(scenario, ModelKind::True, &exact, 0, &mut [])?.recording;
    Ok(Recording { joints: run.joints, time: run.time, q: run.q, qd: run.qd, tau: run.tau, ..Recording::default() })
}

/// The assessment of the case's diagnosis, with the models of table I, which are trained here, for comparison.
///
/// # Errors
/// If the diagnosis cannot be read, or names an effect that does not fit the arm.
pub fn assess(row: &Row) -> anyhow::Result<Disturbance> {
    let (train, test) = (Scenario::built_in(TRAIN)?, Scenario::built_in(TEST)?);
    let answer = row.tried()?.answer.unwrap_or_default();
    let named = |effect: &String, joint: &Option<String>| NamedEffect { effect: effect.clone(), joint: joint.clone() };
    let main = answer.findings.iter().find(|named| named.effect == EFFECT);
    let aliases: Vec<NamedEffect> =
        main.iter().flat_map(|named| &named.confusable_with).map(|other| named(&other.effect, &other.joint)).collect();
    let diagnosed = diagnosed(&answer, &test)?;
    let factor = main.and_then(|named| factor(named.parameters.get("factor")?, 1.0 / train.inertia_scale));
    let other = |row: tables::Row| Other { paper_table_2: paper::row(2, row.model), row };
    let table = tables::table_1(&train, &test, &TrainingOptions::default()).context("training the paper's models")?;
    Ok(Disturbance {
        inertia_scale: train.inertia_scale,
        is_one_finding: main.is_some() && answer.findings.len() == 1 && answer.unexplained.is_empty(),
        findings: answer.findings.iter().map(|f| named(&f.effect, &f.joint)).collect(),
        aliases_are_all_torque_scales: are_all_scales(&aliases, &row.joints),
        aliases,
        factor,
        is_rounding: diagnosed.as_ref().is_some_and(|errors| errors.mean < ROUNDING),
        diagnosed,
        others: table.into_iter().map(other).collect(),
    })
}

/// Whether the aliases are exactly the torque scales of all `joints`.
fn are_all_scales(aliases: &[NamedEffect], joints: &[String]) -> bool {
    let has = |joint: &String| aliases.iter().any(|alias| alias.joint.as_ref() == Some(joint));
    aliases.len() == joints.len() && joints.iter().all(has) && aliases.iter().all(|alias| alias.effect == ALIAS)
}

fn factor(found: &Number, truth: f64) -> Option<Factor> {
    let value = found.value?;
    let [low, high] = found.ci95;
    Some(Factor {
        value,
        ci95: found.ci95,
        truth,
        off: value - truth,
        is_covered: low.is_some_and(|low| low <= truth) && high.is_some_and(|high| truth <= high),
    })
}

/// The errors of the heavy arm with all named effects; `None` if no effect is named, or if one has impossible parameters.
fn diagnosed(answer: &Answer, test: &Scenario) -> anyhow::Result<Option<Errors>> {
    let effects: Option<Vec<Effect>> = answer.findings.iter().map(effect).collect();
    let Some(effects) = effects.filter(|effects| !effects.is_empty()) else {
        return Ok(None);
    };
    let model = Corrected::new(&test.nominal_arm(), &effects)?;
    let mse = model.mean_squared_error(&training::own_samples(test)?);
    Ok(Some(Errors { mean: tables::mean(&mse), mse }))
}

/// A finding as an effect; `None` for effects whose parameters are not plain numbers in a finding.
fn effect(named: &Named) -> Option<Effect> {
    let mut fields = serde_json::Map::new();
    fields.insert("effect".to_owned(), named.effect.clone().into());
    if let Some(joint) = &named.joint {
        fields.insert("joint".to_owned(), joint.clone().into());
    }
    for (parameter, number) in &named.parameters {
        fields.insert(parameter.clone(), number.value?.into());
    }
    serde_json::from_value(fields.into()).ok()
}

/// Writes the case beside the drawn ones.
///
/// # Errors
/// If it cannot be made or written.
pub fn write(cases: &Path, truths: &Path) -> anyhow::Result<()> {
    faults::write_case(&conceal()?, cases, truths)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use arm::Arm;

    #[test]
    fn the_heavy_urdf_is_the_papers_controller() {
        let scenario = Scenario::built_in(TRAIN).expect("it comes with the program");
        let urdf = heavy_urdf(&scenario).expect("it can be written");
        assert!(!urdf.contains("Corrected"), "the URDF says what was done to it");
        let arm = Arm::from_urdf_text(&urdf, "heavy.urdf").expect("it is an arm");
        let samples = training::own_samples(&scenario).expect("the reference fits");
        let [read, meant, exact] = [arm, scenario.nominal_arm(), scenario.arm.clone()]
            .map(|arm| RigidBody::new(arm).mean_squared_error(&samples));
        for (read, meant) in read.iter().zip(&meant) {
            assert!((read / meant - 1.0).abs() < 1e-9, "{read} is not {meant}");
        }
        assert!(exact.iter().all(|mse| *mse == 0.0));
    }

    #[test]
    fn aliases_are_exactly_the_torque_scales_of_all_joints() {
        let joints = ["a".to_owned(), "b".to_owned()];
        let alias =
            |effect: &str, joint: &str| NamedEffect { effect: effect.to_owned(), joint: Some(joint.to_owned()) };
        assert!(are_all_scales(&[alias(ALIAS, "b"), alias(ALIAS, "a")], &joints));
        assert!(!are_all_scales(&[alias(ALIAS, "a")], &joints));
        assert!(!are_all_scales(&[alias(ALIAS, "a"), alias("payload", "b")], &joints));
    }
}
