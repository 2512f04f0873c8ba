//! Closed-loop tracking: on the machines of a dozen cases, a controller tracks task D with five models, one of which is the
//! diagnosed one.

mod choice;
mod closed_loop;
mod course;
mod plan;
#[cfg(feature = "viewer")]
mod show;
mod trained;
pub mod words;

use std::path::Path;

use anyhow::Context;
use arm::Arm;
use faults::{CaseMachine, DURATION, PAUSE, Robot, Truth};
use scoring::Name;
use serde::{Deserialize, Serialize};

use self::closed_loop::Rate;
use self::course::Course;
use self::plan::Plan;
use super::case_paths::Files;
use crate::scenario::Scenario;
use study::effect_file::EffectFile;

pub use self::choice::chosen;

/// The task that is tracked.
const TASK: &str = "taskD";

/// The model of the controller's feed-forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// The URDF.
    Nominal,
    /// The URDF with the named effects.
    Diagnosed,
    /// The URDF with Independent Joint Learning on the same recordings.
    Learned,
    /// The URDF with the named effects, and Independent Joint Learning of the remaining residual.
    Both,
    /// The true machine's own laws.
    Exact,
}

impl Model {
    /// All models, in the order of the report.
    pub const ALL: [Self; 5] = [Self::Nominal, Self::Diagnosed, Self::Learned, Self::Both, Self::Exact];

    /// The title of its column in a table.
    pub fn title(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Diagnosed => "with the diagnosed effects",
            Self::Learned => "with IJL",
            Self::Both => "with both",
            Self::Exact => "exact",
        }
    }
}

/// An injected fault of the machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InjectedEffect {
    /// Its name in the ground truth.
    pub effect: String,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
    /// Its onset (s, on the recordings' clock); `None` if it always acts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub onset: Option<f64>,
}

/// The tracking error of the links under one model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tracked {
    /// The model of the feed-forward.
    pub model: Model,
    /// The root mean square error, one per joint (rad or m); empty if the loop left all bounds.
    pub rms: Vec<f64>,
    /// The largest error, one per joint (rad or m).
    pub largest: Vec<f64>,
    /// The share of ticks in which an effort limit of the URDF cut the torque, one per joint.
    pub cut: Vec<f64>,
    /// The root mean square error over joints and time (rad or m); `None` if the loop left all bounds.
    pub error: Option<f64>,
    /// Root mean square error in a loop in which the reference velocity passes the drives' filter, without its lag (rad or m).
    pub error_without_lag: Option<f64>,
}

/// The outcome of a case: `tracking/CASE.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseTracking {
    /// The case.
    pub case: String,
    /// SHA-256 of the hashes of its inputs: program, recordings and URDF, ground truth, named effects.
    pub made_of: String,
    /// When the task begins, on the recordings' clock (s).
    pub start: f64,
    /// The joints' names, base to tip.
    pub joints: Vec<String>,
    /// The injected faults.
    #[serde(rename = "concealed")]
    pub injected: Vec<InjectedEffect>,
    /// The effects of the diagnosed model.
    pub named: Vec<Name>,
    /// The errors of the models, in the order of [`Model::ALL`].
    pub runs: Vec<Tracked>,
}

impl CaseTracking {
    /// The error under a model (rad or m).
    pub fn error(&self, model: Model) -> Option<f64> {
        self.runs.iter().find(|run| run.model == model)?.error
    }

    /// The error under a model without the velocity filter's lag (rad or m).
    pub fn error_without_lag(&self, model: Model) -> Option<f64> {
        self.runs.iter().find(|run| run.model == model)?.error_without_lag
    }

    /// The error with the diagnosed model over that with the exact one; infinite if the loop with the diagnosed model left
    /// all bounds.
    pub fn over_exact(&self) -> Option<f64> {
        over(self.error(Model::Diagnosed), self.error(Model::Exact))
    }

    /// The tracking error with the diagnosed effects over that with the exact model, in the loop without the lag of the velocity filter.
    pub fn over_exact_without_lag(&self) -> Option<f64> {
        over(self.error_without_lag(Model::Diagnosed), self.error_without_lag(Model::Exact))
    }
}

/// An error over that with the exact model; `None` if the loop with the exact model left all bounds.
fn over(error: Option<f64>, exact: Option<f64>) -> Option<f64> {
    let exact = exact?.max(f64::MIN_POSITIVE);
    Some(error.map_or(f64::INFINITY, |error| error / exact))
}

/// The inputs for tracking a task in a case.
pub struct Case<'a> {
    /// The robot it was drawn on.
    pub robot: &'a Robot,
    /// Its folder, with recordings and URDF.
    pub folder: &'a Path,
    /// The truth.
    pub truth: &'a Truth,
    /// The effects that the diagnosis named, as TOML; `None` if it gave no answer.
    pub named: Option<&'a str>,
}

impl Case<'_> {
    /// Tracks the task on the machine of the case with all models. If `timeline` is given, the recording for the viewer is
    /// written to that file.
    ///
    /// # Errors
    /// If the case cannot be read, nothing can be learned from its recordings, or the timeline cannot be written.
    pub fn track(&self, made_of: String, timeline: Option<&Path>) -> anyhow::Result<CaseTracking> {
        let case = &self.truth.case;
        let task = Scenario::built_in(TASK)?;
        let files = Files::of(self.folder)?;
        let machine = CaseMachine::new(self.robot, self.truth)?;
        // The pause before the task is that between recordings.
        let start = (files.train.len() + files.held_out.len()) as f64 * (DURATION + PAUSE);
        let course = Course::new(&task, start);
        // The arm of the user's URDF, which may differ from the machine.
        let believed = Arm::from_urdf(self.folder.join(&files.robot)).with_context(|| case.clone())?;
        let arm = &believed;
        let effects = match self.named {
            Some(text) => EffectFile::parse(text.to_owned(), &self.folder.with_file_name("model.toml"), arm)?.effects,
            None => Vec::new(),
        };
        let recorded = trained::Recorded::read(arm, self.folder, &files.train).with_context(|| case.clone())?;
        let (nominal, diagnosed) = (Plan::nominal(arm, &course), Plan::diagnosed(arm, &effects, &course)?);
        let plans = [
            nominal.clone(),
            diagnosed.clone(),
            nominal.with(&recorded.learn(arm, &[])?, &course),
            diagnosed.with(&recorded.learn(arm, &effects)?, &course),
            Plan::exact(&machine, &course),
        ];
        let driven = believed.clone().with_rotor_inertias(self.robot.rotor_inertias());
        let run = |plan: &Plan, rate| closed_loop::run(&machine, &driven, &task, &course, plan, rate);
        let each = |rate| plans.iter().map(|plan| run(plan, rate)).collect::<anyhow::Result<Vec<_>>>();
        let (runs, without_lag) = (each(Rate::AsItIs)?, each(Rate::Filtered)?);
        if let Some(path) = timeline {
            self.show(path, &task, &course, &runs)?;
        }
        let pairs = runs.iter().zip(&without_lag);
        let tracked = Model::ALL.iter().zip(pairs).map(|(&model, (run, other))| run.tracked(model, other, &course));
        let baseline = |effect: &faults::Injected| effect.expressed_share.is_none();
        let injected = self.truth.injected.iter().filter(|effect| !baseline(effect));
        Ok(CaseTracking {
            case: case.clone(),
            made_of,
            start,
            joints: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
            injected: injected
                .map(|effect| InjectedEffect {
                    effect: effect.effect.clone(),
                    joint: effect.joint.clone(),
                    onset: effect.onset,
                })
                .collect(),
            named: effects.iter().map(|effect| (effect.name().to_owned(), effect.joint().map(str::to_owned))).collect(),
            runs: tracked.collect(),
        })
    }

    #[cfg(feature = "viewer")]
    fn show(&self, path: &Path, task: &Scenario, course: &Course, runs: &[closed_loop::Run]) -> anyhow::Result<()> {
        let title = format!("{} of {}, {}", task.title, self.truth.case, self.robot.name());
        show::write(path, &title, self.robot.arm(), &self.folder.join("robot.urdf"), course, runs)
    }

    #[cfg(not(feature = "viewer"))]
    fn show(&self, path: &Path, _: &Scenario, _: &Course, _: &[closed_loop::Run]) -> anyhow::Result<()> {
        anyhow::bail!("{}: this testbed was built without the viewer", path.display())
    }
}

#[cfg(test)]
mod tests;
