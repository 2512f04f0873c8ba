//! `testbed --scenario …`: one run, from the scenario to its folder.

mod fitted;
mod folder;
mod hardly_learned;
mod observers;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use report::numbers::rounded;
use report::terminal::table;
use serde::Serialize;
use torque::{Samples, TorqueModel};

use crate::cli::{ChainArgs, RunArgs};
use crate::interrupt;
use crate::models::ModelKind;
use crate::output::{self, OutputFile};
use crate::progress::{Pieces, Progress};
use crate::scenario::Scenario;
use crate::simulation::{self, Observer, Outcome, Tracking, Weight};
use crate::training;
use crate::written::Written;
use fitted::{Energies, Regression, approximated, energies, regression};
use folder::RunFolder;
use observers::{Simulating, View};

/// The number of samples from which a note announces a long training.
const MANY_SAMPLES: usize = 8000;

/// The content of a run's summary.json.
#[derive(Serialize)]
struct Summary<'a> {
    schema: &'static str,
    scenario: &'a str,
    robot: &'a str,
    joints: Vec<&'a str>,
    train: &'a [String],
    seed: u64,
    tracking: [Tracking; 1],
    /// Mean squared error of the model's torque on the reference, (N m)².
    torque_mse: Vec<f64>,
    /// Share of the control steps in which the effort limit cut the torque.
    saturated: Vec<f64>,
    real_time_factor: f64,
    control_step_us: Percentiles,
    /// The weights of the learned torques, one per joint; absent if they do not fade.
    #[serde(skip_serializing_if = "<[Weight]>::is_empty")]
    fade_weights: &'a [Weight],
    /// The regressions of the model, one per joint; empty if it does not learn.
    regressions: Vec<Regression>,
    /// The regression of all joints by energies; absent if the model has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    energies: Option<Energies<'a>>,
}

#[derive(Serialize)]
struct Percentiles {
    median: f64,
    p99: f64,
}

/// Runs the scenario of `args`, with the arm that `chain` selects.
///
/// # Errors
/// With the step that failed, the reason and the remedy.
pub fn run(args: &RunArgs, chain: &ChainArgs) -> anyhow::Result<()> {
    let mut scenario = Scenario::load_chain(&args.scenario, chain)?;
    scenario.fade = args.fade.unwrap_or(scenario.fade);
    let kind = args.model.unwrap_or(scenario.model);
    let sources = if kind.learns() { args.train.as_ref().unwrap_or(&scenario.training).clone() } else { Vec::new() };
    if kind.learns() && sources.is_empty() {
        bail!(
            "the model \"{}\" is trained, but the scenario names nothing to train on; give --train taskA,taskB,… or \
             [training] scenarios = […], or take a model that needs no training: --model rigid-body",
            kind.flag()
        );
    }
    let out = args.out.as_deref();
    check_outputs(args, &scenario, &sources)?;
    let samples = training::training_samples(&scenario, &sources, chain, args.seed)?;
    notes(args, kind, &scenario, &samples);

    let length_scales = args.length_scales.unwrap_or(scenario.length_scales);
    let mut options = length_scales.training_options();
    options.inducing = args.inducing.map(|count| count as usize);
    let model = {
        let progress = Progress::new("training");
        let (title, sources, count) = (kind.title(), sources.join(", "), samples.len());
        let what = format!("training {title} on {sources} ({count} samples), regressions");
        let pieces = kind.learns().then(|| Pieces::new(&progress, what, scenario.arm.dof(), 1.0));
        let fitted = || pieces.iter().for_each(Pieces::next);
        let model = kind.build_with(&scenario.arm, &scenario.nominal_arm(), &samples, &options, &fitted);
        progress.finish();
        model.context("training failed")?
    };
    let deferred = interrupt::Deferred::start();
    let folder = RunFolder::create(out, &format!("{}-{}", scenario.name, kind.flag()))?;
    let rerun_file = observers::rerun_file(args, &folder.path);
    let replaces = rerun_file.as_ref().is_some_and(|path| path.is_file());
    let mut viewer = View::open(args, kind, &scenario, rerun_file.as_deref())?;
    let mut progress = Simulating::new(scenario.duration);
    let outcome = simulation::run(
        &scenario,
        kind,
        model.as_ref(),
        args.seed,
        &mut [&mut progress as &mut dyn Observer, &mut viewer],
    );
    progress.finish();
    let outcome = outcome?;

    let summary = Summary {
        schema: "testbed.run/1",
        scenario: &scenario.name,
        robot: scenario.arm.name(),
        joints: scenario.arm.joints().iter().map(|joint| joint.name.as_str()).collect(),
        train: &sources,
        seed: args.seed,
        tracking: [Tracking::new(kind, &outcome)],
        torque_mse: torque_error(&scenario, model.as_ref())?,
        saturated: outcome.saturated.clone(),
        real_time_factor: outcome.real_time_factor,
        fade_weights: &outcome.weights,
        control_step_us: Percentiles { median: outcome.control_step_median, p99: outcome.control_step_p99 },
        regressions: model.regressions().iter().map(regression).collect(),
        energies: model.energies().map(energies),
    };
    let mut written = Written::default();
    let [recording, file] = ["recording.csv", "summary.json"].map(|name| folder.path.join(name));
    written.add(&recording, || Ok(outcome.recording.write_csv(&recording)?));
    written.add(&file, || output::write_json(&file, &summary));
    if let Some(path) = &args.json {
        written.add(path, || output::write_json(path, &summary));
    }
    if viewer.finish()
        && let Some(path) = &rerun_file
    {
        written.note(path, replaces);
    }
    drop(deferred);
    let mut text = text(&scenario, kind, &sources, &summary, &outcome);
    if kind.learns() {
        let length_scales = kind.has_length_scales().then_some(length_scales);
        text += &hardly_learned::remarks(&scenario, &summary.torque_mse, length_scales)?;
        text += &approximated(model.regressions());
    }
    text += &written.lines();
    if rerun_file.is_some_and(|file| written.has(&file)) {
        text += "The .rrd file opens with `rerun FILE` (pip install rerun-sdk==0.36.3).\n";
    }
    output::print_beside(args.json.as_deref(), &text)?;
    written.finish()
}

/// Refuses outputs that cannot be written or that coincide, before any work is done.
fn check_outputs(args: &RunArgs, scenario: &Scenario, sources: &[String]) -> anyhow::Result<()> {
    let out = args.out.as_deref();
    observers::check_rerun(args)?;
    RunFolder::check(out)?;
    let here = out.unwrap_or(Path::new("runs/new"));
    let mut outputs =
        vec![("the run's recording", here.join("recording.csv")), ("the run's summary", here.join("summary.json"))];
    outputs.extend(observers::rerun_file(args, here).map(|file| ("the file for Rerun", file)));
    if let Some(json) = &args.json {
        folder::check_json(json, out)?;
        outputs.push(("the --json file", json.clone()));
    }
    let mut inputs = vec![("the scenario", scenario.path.clone()), ("the robot", scenario.urdf.clone())];
    inputs.extend(sources.iter().map(|source| ("the model's training data", PathBuf::from(source))));
    folder::check_distinct(&outputs, &inputs)?;
    let rerun = observers::rerun_file(args, here);
    let asked = args.json.as_deref();
    asked
        .map(|path| OutputFile::json(path, "\"schema\": \"testbed.run/"))
        .into_iter()
        .chain(rerun.as_deref().map(OutputFile::rerun))
        .try_for_each(|file| file.check())
}

/// The mean squared error of the model's torque on the reference, one per joint ((N m)² or N²), as in the paper.
fn torque_error(scenario: &Scenario, model: &dyn TorqueModel) -> anyhow::Result<Vec<f64>> {
    Ok(model.mean_squared_error(&training::own_samples(scenario)?))
}

/// Prints notes on doubtful arguments, and on the robot and the reference.
fn notes(args: &RunArgs, kind: ModelKind, scenario: &Scenario, samples: &Samples) {
    for note in &scenario.notes {
        output::say(format_args!("note: {note}"));
    }
    if args.train.is_some() && !kind.learns() {
        eprintln!("note: the model \"{}\" is not trained; --train is ignored", kind.flag());
    }
    if args.length_scales.is_some() && !kind.has_length_scales() {
        eprintln!("note: the model \"{}\" has no length scales; --length-scales is ignored", kind.flag());
    }
    if samples.len() > MANY_SAMPLES && args.inducing.is_none() && kind.has_length_scales() {
        eprintln!(
            "note: training on {} samples may take minutes; --inducing 200 or a lower reference.sample_rate shortens it",
            samples.len()
        );
    }
    let mut motion = torque::Motion::new(scenario.arm.dof());
    let mut outside = vec![false; scenario.arm.dof()];
    for time in scenario.sample_times() {
        scenario.reference.at(time, &mut motion);
        for (joint, outside) in scenario.arm.joints().iter().zip(&mut outside).enumerate() {
            let q = motion.q[joint];
            let limits = outside.0.limits;
            *outside.1 |= q < limits.lower || q > limits.upper;
        }
    }
    let names: Vec<&str> = scenario
        .arm
        .joints()
        .iter()
        .zip(&outside)
        .filter(|(_, outside)| **outside)
        .map(|(joint, _)| joint.name.as_str())
        .collect();
    if !names.is_empty() {
        output::say(format_args!(
            "note: the reference exceeds the position limits of {}; the plant does not enforce them",
            names.join(", ")
        ));
    }
}

/// A sentence on the joints whose learned torque was faded.
fn faded(scenario: &Scenario, outcome: &Outcome) -> String {
    let joints = scenario.arm.joints().iter().zip(&outcome.weights);
    let joints: Vec<String> = joints
        .filter(|(_, weight)| weight.least < 0.995)
        .map(|(joint, weight)| format!("{} ({:.2}, {:.2})", joint.name, weight.mean, weight.least))
        .collect();
    if joints.is_empty() {
        return String::new();
    }
    format!(
        "The reference leaves the range of the training data, where the learned torque is faded out; its mean and least weight: {}. \
         --fade false disables this.\n",
        joints.join(", ")
    )
}

/// The result as text for the terminal.
fn text(scenario: &Scenario, kind: ModelKind, sources: &[String], summary: &Summary<'_>, outcome: &Outcome) -> String {
    let trained = if sources.is_empty() { String::new() } else { format!(", trained on {}", sources.join(", ")) };
    let mut text = format!(
        "{}: {} ({} joints), {} s at {} Hz under the model \"{}\"{trained}\n",
        scenario.title,
        scenario.arm.name(),
        scenario.arm.dof(),
        scenario.duration,
        scenario.control_rate,
        kind.flag()
    );
    let header = ["joint", "RMS error", "largest error", "torque error, MSE", "saturated"];
    let mut table = table(header.map(str::to_owned));
    for (i, joint) in scenario.arm.joints().iter().enumerate() {
        let (small, square) = match joint.kind {
            arm::JointKind::Revolute => ("mrad", "(N m)²"),
            arm::JointKind::Prismatic => ("mm", "N²"),
        };
        table.add_row([
            joint.name.clone(),
            format!("{} {small}", rounded(outcome.rms_error[i] * 1e3, 4)),
            format!("{} {small}", rounded(outcome.max_error[i] * 1e3, 4)),
            format!("{} {square}", rounded(summary.torque_mse[i], 4)),
            format!("{:.1} %", 100.0 * outcome.saturated[i]),
        ]);
    }
    text += &format!("{table}\n");
    text += &faded(scenario, outcome);
    text += &format!(
        "real-time factor {:.1}; control step {:.1} µs median, {:.1} µs at the 99th percentile\n",
        outcome.real_time_factor, outcome.control_step_median, outcome.control_step_p99
    );
    text
}
