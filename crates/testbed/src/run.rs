//! `testbed --scenario …`: one run, from the scenario to its folder.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use torque::{Gp, TorqueModel};

use crate::cli::{Rerun, RunArgs};
use crate::output::{self, Tracking};
use crate::scenario::Scenario;
use crate::simulation::{self, Observer, Outcome};
use crate::telemetry::Sample;
use crate::training;

/// What a run's summary.json holds.
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
    /// The regressions of the model, one a joint; none if it does not learn.
    regressions: Vec<Regression>,
}

/// What training found for one joint.
#[derive(Serialize)]
struct Regression {
    log_marginal_likelihood: f64,
    /// How many of the samples' directions the kernel matrix tells apart.
    rank: usize,
    /// What was added to the kernel matrix's diagonal, and why.
    conditioning: String,
}

#[derive(Serialize)]
struct Percentiles {
    median: f64,
    p99: f64,
}

/// Runs what `args` say.
///
/// # Errors
/// One that says what was being done, what was found and how to mend it.
pub fn run(args: &RunArgs) -> anyhow::Result<()> {
    let scenario = Scenario::load(&args.scenario)?;
    let sources = if args.model.learns() {
        args.train.as_ref().unwrap_or(&scenario.training).clone()
    } else {
        Vec::new()
    };
    if args.model.learns() && sources.is_empty() {
        bail!(
            "the model \"{}\" is trained, but the scenario names nothing to train on; give --train taskA,taskB,… or \
             [training] scenarios = […]",
            args.model.flag()
        );
    }
    let samples = training::training_samples(&scenario, &sources, args.seed)?;
    if let Some(path) = &args.json {
        output::check_writable(path)?;
    }
    let folder = RunFolder::create(args.out.as_deref(), &format!("{}-{}", scenario.name, args.model.flag()))?;
    notes(&scenario);

    let options = args.length_scales.training_options();
    let model = {
        let progress = output::spinner("training");
        if args.model.learns() {
            progress.set_message(format!(
                "training {} on {} ({} samples)",
                args.model.title(),
                sources.join(", "),
                samples.len()
            ));
        }
        let model = args
            .model
            .build(&scenario.arm, &scenario.nominal_arm(), &samples, &options);
        progress.finish_and_clear();
        model.context("training failed")?
    };
    let mut viewer = View::open(args, &scenario, &folder)?;
    let mut progress = Progress::new(scenario.duration);
    let outcome = simulation::run(
        &scenario,
        args.model,
        model.as_ref(),
        args.seed,
        &mut [&mut progress as &mut dyn Observer, &mut viewer],
    );
    progress.bar.finish_and_clear();
    let outcome = outcome?;
    let viewed = viewer.finish()?;

    let summary = Summary {
        schema: "testbed.run/1",
        scenario: &scenario.name,
        robot: scenario.arm.name(),
        joints: scenario.arm.joints().iter().map(|joint| joint.name.as_str()).collect(),
        train: &sources,
        seed: args.seed,
        tracking: [Tracking::new(args.model, &outcome)],
        torque_mse: torque_error(&scenario, model.as_ref())?,
        saturated: outcome.saturated.clone(),
        real_time_factor: outcome.real_time_factor,
        control_step_us: Percentiles {
            median: outcome.control_step_median,
            p99: outcome.control_step_p99,
        },
        regressions: model.regressions().iter().map(regression).collect(),
    };
    let recording = folder.path.join("recording.csv");
    outcome.recording.write_csv(&recording)?;
    let summary_path = folder.path.join("summary.json");
    output::write_json(&summary_path, &summary)?;
    if let Some(path) = &args.json {
        output::write_json(path, &summary)?;
    }
    print(&scenario, args, &sources, &summary, &outcome);
    println!("written: {}, {}{}", recording.display(), summary_path.display(), viewed);
    Ok(())
}

/// The model's torque error against the truth on the reference, as the paper measures it.
fn torque_error(scenario: &Scenario, model: &dyn TorqueModel) -> anyhow::Result<Vec<f64>> {
    Ok(model.mean_squared_error(&training::own_samples(scenario)?))
}

fn regression(gp: &Gp) -> Regression {
    Regression {
        log_marginal_likelihood: gp.log_marginal_likelihood(),
        rank: gp.rank(),
        conditioning: gp.conditioning().to_string(),
    }
}

/// Says what is doubtful in the robot and the reference.
fn notes(scenario: &Scenario) {
    for warning in scenario.arm.warnings() {
        eprintln!("note: {}: {warning}", scenario.urdf.display());
    }
    let mut motion = crate::reference::Motion::new(scenario.arm.dof());
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
        eprintln!(
            "note: the reference leaves the position limits of {}; the plant does not enforce them",
            names.join(", ")
        );
    }
}

fn print(scenario: &Scenario, args: &RunArgs, sources: &[String], summary: &Summary<'_>, outcome: &Outcome) {
    let trained = if sources.is_empty() {
        String::new()
    } else {
        format!(", trained on {}", sources.join(", "))
    };
    println!(
        "{}: {} ({}), {} s at {} Hz under the model \"{}\"{trained}",
        scenario.title,
        scenario.arm.name(),
        scenario.arm.dof(),
        scenario.duration,
        scenario.control_rate,
        args.model.flag()
    );
    let header = ["joint", "RMS error", "largest error", "torque error, MSE", "saturated"];
    let mut table = output::table(header.map(str::to_owned));
    for (i, joint) in scenario.arm.joints().iter().enumerate() {
        let (small, square) = match joint.kind {
            arm::JointKind::Revolute => ("mrad", "(N m)²"),
            arm::JointKind::Prismatic => ("mm", "N²"),
        };
        table.add_row([
            joint.name.clone(),
            format!("{} {small}", output::number(outcome.rms_error[i] * 1e3)),
            format!("{} {small}", output::number(outcome.max_error[i] * 1e3)),
            format!("{} {square}", output::number(summary.torque_mse[i])),
            format!("{:.1} %", 100.0 * outcome.saturated[i]),
        ]);
    }
    println!("{table}");
    println!(
        "real-time factor {:.1}; control step {:.1} µs median, {:.1} µs at the 99th percentile",
        outcome.real_time_factor, outcome.control_step_median, outcome.control_step_p99
    );
}

/// The folder of a run, removed again if the run fails and nothing else is in it.
struct RunFolder {
    path: PathBuf,
    created: bool,
}

impl RunFolder {
    /// `out`, or a new numbered folder under `runs/`.
    fn create(out: Option<&Path>, name: &str) -> anyhow::Result<Self> {
        let path = match out {
            Some(path) => path.to_owned(),
            None => next_folder(Path::new("runs"), name),
        };
        let created = !path.exists();
        std::fs::create_dir_all(&path).with_context(|| {
            format!(
                "{}: the run's folder cannot be made; give another with --out DIR",
                path.display()
            )
        })?;
        let folder = Self { path, created };
        output::check_writable(&folder.path.join("summary.json"))?;
        Ok(folder)
    }
}

impl Drop for RunFolder {
    fn drop(&mut self) {
        if self.created {
            // Only an empty folder goes; one with results stays.
            let _ = std::fs::remove_dir(&self.path);
        }
    }
}

/// `runs/<number>-<name>`, the number one above the largest there is.
fn next_folder(runs: &Path, name: &str) -> PathBuf {
    let entries = std::fs::read_dir(runs).into_iter().flatten().flatten();
    let number_of = |name: &str| name.split('-').next().and_then(|number| number.parse::<u32>().ok());
    let last = entries
        .filter_map(|entry| number_of(&entry.file_name().to_string_lossy()))
        .max();
    runs.join(format!("{:03}-{name}", last.unwrap_or(0) + 1))
}

/// A progress bar on standard error in simulated seconds, hidden where that is no terminal.
struct Progress {
    bar: ProgressBar,
}

impl Progress {
    fn new(duration: f64) -> Self {
        let bar = ProgressBar::new((duration * 10.0).ceil() as u64);
        if let Ok(style) = ProgressStyle::with_template("simulating {bar:40} {percent} %  ({elapsed})") {
            bar.set_style(style);
        }
        Self { bar }
    }
}

impl Observer for Progress {
    fn sample(&mut self, sample: &Sample<'_>) {
        let tenths = (sample.time * 10.0) as u64;
        if tenths > self.bar.position() {
            self.bar.set_position(tenths);
        }
    }
}

#[cfg(feature = "viewer")]
/// The run in Rerun, or nowhere.
struct View {
    viewer: Option<crate::viewer::Viewer>,
    file: Option<PathBuf>,
}

#[cfg(feature = "viewer")]
impl View {
    fn open(args: &RunArgs, scenario: &Scenario, folder: &RunFolder) -> anyhow::Result<Self> {
        use crate::viewer::{Sink, Viewer};
        let sink = match args.rerun.clone().unwrap_or(Rerun::Save(None)) {
            Rerun::Off => {
                return Ok(Self {
                    viewer: None,
                    file: None,
                });
            }
            Rerun::Save(file) => Sink::Save(file.unwrap_or_else(|| folder.path.join("run.rrd"))),
            Rerun::Spawn => Sink::Spawn,
            Rerun::Connect(url) => Sink::Connect(url),
        };
        let title = format!("{}, {}, seed {}", scenario.title, args.model.title(), args.seed);
        let viewer = Viewer::open(&sink, &title, &scenario.arm, &scenario.urdf).context("opening Rerun")?;
        let file = match sink {
            Sink::Save(file) => Some(file),
            Sink::Spawn | Sink::Connect(_) => None,
        };
        Ok(Self {
            viewer: Some(viewer),
            file,
        })
    }

    /// Ends the recording; what to add to the list of files.
    fn finish(self) -> anyhow::Result<String> {
        if let Some(viewer) = self.viewer {
            viewer.finish()?;
        }
        Ok(self.file.map_or(String::new(), |file| {
            format!(", {} (open with `rerun {0}`)", file.display())
        }))
    }
}

#[cfg(feature = "viewer")]
impl Observer for View {
    fn wants_variance(&self) -> bool {
        self.viewer.is_some()
    }

    fn sample(&mut self, sample: &Sample<'_>) {
        if let Some(viewer) = &mut self.viewer {
            viewer.log(sample);
        }
    }
}

#[cfg(not(feature = "viewer"))]
/// This program was built without Rerun.
struct View;

#[cfg(not(feature = "viewer"))]
impl View {
    fn open(args: &RunArgs, _: &Scenario, _: &RunFolder) -> anyhow::Result<Self> {
        match &args.rerun {
            None | Some(Rerun::Off) => Ok(Self),
            Some(_) => bail!("--rerun needs a program built with the feature \"viewer\", which this one lacks"),
        }
    }

    fn finish(self) -> anyhow::Result<String> {
        Ok(String::new())
    }
}

#[cfg(not(feature = "viewer"))]
impl Observer for View {
    fn sample(&mut self, _: &Sample<'_>) {}
}
