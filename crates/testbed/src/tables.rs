//! `testbed tables`: the paper's tables I and II and its figure 4, with our results beside the published ones.

use std::path::Path;
use std::time::Instant;

use anyhow::Context;
use rayon::prelude::*;
use report::numbers::rounded;
use serde::Serialize;
use torque::{Samples, TorqueModel, TrainingOptions};

use crate::cli::ChainArgs;
use crate::models::ModelKind;
use crate::output::{self, OutputFile};
use crate::progress::{Pieces, Progress};
use crate::scenario::Scenario;
use crate::simulation::{self, Tracking};
use crate::{paper, training};

/// The training tasks of tables I and II.
const TRAINING: [&[&str]; 2] = [&["taskA"], &["taskA", "taskB", "taskC"]];

/// The rows of a table: the paper's in its order, then ours.
const ROWS: [ModelKind; 6] = [
    ModelKind::Gp,
    ModelKind::RigidBody,
    ModelKind::Hybrid,
    ModelKind::IndependentJoint,
    ModelKind::IndependentJointOwnFrame,
    ModelKind::IndependentJoint13,
];

/// The rows of newer models, which follow on request.
const NEWER_ROWS: [ModelKind; 2] = [ModelKind::LagrangianOnly, ModelKind::Lagrangian];

/// The results of the command.
#[derive(Serialize)]
struct Tables {
    tables: Vec<Table>,
    tracking: Vec<Tracking>,
}

/// Torque errors of every model after one training set.
#[derive(Serialize)]
struct Table {
    train: Vec<String>,
    test: String,
    rows: Vec<Row>,
}

/// Torque errors of one model.
#[derive(Serialize)]
pub struct Row {
    /// The model.
    pub model: ModelKind,
    /// The mean squared torque error, one per joint ((N m)²).
    pub mse: Vec<f64>,
    /// The mean over the joints.
    pub mean: f64,
    /// The row of the paper; `None` if the paper does not have the model.
    pub paper: Option<[f64; 6]>,
}

impl Row {
    /// The errors of `model` on `samples`, beside those of the paper's table `number`.
    fn new(kind: ModelKind, model: &dyn TorqueModel, samples: &Samples, number: usize) -> Self {
        let mse = model.mean_squared_error(samples);
        Self { model: kind, mean: mean(&mse), mse, paper: paper::row(number, kind) }
    }
}

/// The mean over the joints.
pub fn mean(mse: &[f64]) -> f64 {
    mse.iter().sum::<f64>() / mse.len() as f64
}

/// The rows of table I alone: trained on task `train`, tested on task `test`.
///
/// # Errors
/// If training fails.
pub fn table_1(train: &Scenario, test: &Scenario, options: &TrainingOptions) -> anyhow::Result<Vec<Row>> {
    let nominal = test.nominal_arm();
    let (samples, test_samples) = (training::own_samples(train)?, training::own_samples(test)?);
    let row = |&kind: &ModelKind| -> anyhow::Result<Row> {
        let model = kind.build(&test.arm, &nominal, &samples, options)?;
        Ok(Row::new(kind, model.as_ref(), &test_samples, 1))
    };
    ROWS.par_iter().map(row).collect()
}

/// Computes the tables, with the newer models if `today` is set, prints them, and writes them to `json` if it is given.
///
/// # Errors
/// If the file cannot be written; training and simulating the paper's tasks do not fail.
pub fn run(json: Option<&Path>, options: &TrainingOptions, today: bool) -> anyhow::Result<()> {
    if let Some(path) = json {
        output::check_writable(path)?;
        OutputFile::json(path, "\"tables\": [").check()?;
    }
    let started = Instant::now();
    let rows: Vec<ModelKind> = ROWS.into_iter().chain(NEWER_ROWS.into_iter().filter(|_| today)).collect();
    let progress = Progress::new("reading");
    let mut test = Scenario::load("taskD")?;
    // The paper's controller.
    test.fade = false;
    let nominal = test.nominal_arm();
    let test_samples = training::own_samples(&test)?;
    let mut training_samples = Vec::new();
    for tasks in TRAINING {
        let names: Vec<String> = tasks.iter().map(|task| (*task).to_owned()).collect();
        training_samples.push(training::training_samples(&test, &names, &ChainArgs::default(), 0)?);
    }
    // The most expensive models come first, so that no thread waits for one of them at the end.
    let jobs: Vec<(usize, ModelKind)> =
        (0..TRAINING.len()).rev().flat_map(|set| rows.iter().map(move |&model| (set, model))).collect();
    let learned = jobs.iter().filter(|(_, model)| model.learns()).count();
    let what = format!("training {learned} models, regressions");
    let pieces = Pieces::new(&progress, what, learned * test.arm.dof(), 0.8);
    let train = |&(set, model): &(usize, ModelKind)| {
        let samples: &Samples = &training_samples[set];
        let built = model.build_with(&test.arm, &nominal, samples, options, &|| pieces.next());
        built.with_context(|| format!("training \"{}\" on {}", model.flag(), TRAINING[set].join(", ")))
    };
    let models: Vec<Box<dyn TorqueModel>> = jobs.par_iter().map(train).collect::<anyhow::Result<_>>()?;
    let model_of = |set: usize, model: ModelKind| {
        let index = jobs.iter().position(|job| *job == (set, model));
        index.map(|index| models[index].as_ref())
    };

    progress.done(0.8, "predicting task D");
    let mut tables = Vec::new();
    for (set, tasks) in TRAINING.iter().enumerate() {
        let row = |&kind: &ModelKind| Some(Row::new(kind, model_of(set, kind)?, &test_samples, set + 1));
        tables.push(Table {
            train: tasks.iter().map(|task| short(task)).collect(),
            test: short(&test.name),
            rows: rows.par_iter().filter_map(row).collect(),
        });
    }

    let tracked: Vec<ModelKind> =
        ModelKind::ALL.into_iter().filter(|model| today || !model.is_newer_than_the_paper()).collect();
    progress.done(0.82, format!("tracking task D with {} models", tracked.len()));
    let exact = ModelKind::True.build(&test.arm, &nominal, &test_samples, options)?;
    let track = |&kind: &ModelKind| -> anyhow::Result<Tracking> {
        let model = model_of(TRAINING.len() - 1, kind).unwrap_or(exact.as_ref());
        let outcome = simulation::run(&test, kind, model, 0, &mut [])?;
        Ok(Tracking::new(kind, &outcome))
    };
    let tracking = tracked.par_iter().map(track).collect::<anyhow::Result<_>>()?;
    progress.finish();

    let results = Tables { tables, tracking };
    if let Some(path) = json {
        output::write_json(path, &results)?;
    }
    output::print_beside(json, &text(&results))?;
    eprintln!("done in {:.1} s", started.elapsed().as_secs_f64());
    Ok(())
}

fn short(task: &str) -> String {
    task.trim_start_matches("task").to_owned()
}

/// The tables as text for the terminal.
fn text(results: &Tables) -> String {
    let header = |first: &str, last: &[&str]| {
        let joints = (1..=6).map(|joint| format!("joint {joint}"));
        let last = last.iter().map(|last| (*last).to_owned());
        let cells: Vec<String> = [first.to_owned()].into_iter().chain(joints).chain(last).collect();
        report::terminal::table(cells)
    };
    let numbers = |values: &[f64], last: &[f64]| -> Vec<String> {
        values.iter().chain(last).map(|value| rounded(*value, 3)).collect()
    };
    let mut text = String::new();
    for (table, number) in results.tables.iter().zip(["I", "II"]) {
        text += &format!(
            "Table {number}: mean squared torque error on task {} after training on {}, (N m)²\n",
            table.test,
            table.train.join(", ")
        );
        let mut printed = header("model", &["mean"]);
        for row in &table.rows {
            let mut cells = vec![row.model.title().to_owned()];
            cells.extend(numbers(&row.mse, &[row.mean]));
            printed.add_row(cells);
            if let Some(paper) = row.paper {
                let mut cells = vec!["  the paper's".to_owned()];
                cells.extend(numbers(&paper, &[mean(&paper)]));
                printed.add_row(cells);
            }
        }
        text += &format!("{printed}\n\n");
    }
    text += "Figure 4: RMS tracking error on task D in the closed loop after A, B, C, mrad (last two: mean of joints \
             1 to 3, root mean square of all)\n";
    let mut printed = header("model", &["1 to 3", "all"]);
    for row in &results.tracking {
        let errors: Vec<f64> = row.rms_error_rad.iter().map(|rad| rad * 1e3).collect();
        let mut cells = vec![row.model.title().to_owned()];
        let squares: Vec<f64> = errors.iter().map(|error| error * error).collect();
        cells.extend(numbers(&errors, &[mean(&errors[..3]), mean(&squares).sqrt()]));
        printed.add_row(cells);
    }
    text + &format!("{printed}\n")
}
