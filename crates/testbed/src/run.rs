//! `testbed --scenario …`: one run, from the scenario to its folder.

mod fitted;
mod folder;
mod hardly_learned;
mod not_followed;
mod notes;
mod observers;
mod summary;
mod torque_errors;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use report::numbers::rounded;
use report::terminal::table;

use crate::cli::{ChainArgs, RunArgs};
use crate::interrupt;
use crate::models::ModelKind;
use crate::output::{self, OutputFile};
use crate::progress::{Pieces, Progress};
use crate::scenario::Scenario;
use crate::simulation::{self, Observer, Outcome, Tracking};
use crate::training;
use crate::written::Written;
use fitted::{approximated, energies, regression};
use folder::RunFolder;
use observers::{Simulating, View};
use summary::{Percentiles, Settings, Summary};
use torque_errors::TorqueErrors;

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
    notes::print(args, kind, &scenario, &sources, samples.len());
    for note in training::unused_settings(&scenario, &sources, chain)? {
        output::say(format_args!("note: {note}"));
    }

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

    let errors = TorqueErrors::new(&scenario, kind, model.as_ref())?;
    let trained = kind.has_length_scales().then_some(length_scales);
    let summary = Summary {
        schema: "testbed.run/1",
        scenario: &scenario.name,
        robot: scenario.arm.name(),
        joints: scenario.arm.joints().iter().map(|joint| joint.name.as_str()).collect(),
        train: &sources,
        seed: args.seed,
        tracking: [Tracking::new(kind, &outcome)],
        settings: Settings::new(&scenario, kind, trained, options.inducing, samples.len()),
        torque_mse: errors.fed_forward.clone(),
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
    text += &not_followed::remark(&scenario, kind, &outcome);
    if kind.learns() {
        text += &hardly_learned::remarks(&scenario, &errors, trained);
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
        "{}: {} ({}), {} s at {} Hz under the model \"{}\"{trained}\n",
        scenario.title,
        scenario.arm.name(),
        if scenario.arm.dof() == 1 { "1 joint".to_owned() } else { format!("{} joints", scenario.arm.dof()) },
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
