//! `testbed transfer`: the errors of models on tasks that they were not trained on, predicted and measured.

mod labels;
mod samples_file;
mod words;

use anyhow::{Context, ensure};
use rayon::prelude::*;
use serde::Serialize;
use torque::{Prediction, Samples, TorqueModel, Workspace};

use crate::cli::{ChainArgs, TransferArgs};
use crate::models::ModelKind;
use crate::output::{self, OutputFile};
use crate::progress::{Pieces, Progress};
use crate::scenario::Scenario;
use crate::training;
use labels::Labels;

/// More tasks would make more than a hundred training sets.
const MOST_TASKS: usize = 6;

/// The interval of samples at which the variance is evaluated: it is expensive, and changes little from one sample to the
/// next.
const EVERY: usize = 4;

/// The error of a joint rises if adding a task multiplies it by at least this factor, and if it rises by at least [`NOTABLE`].
const RISES: f64 = 1.05;

/// The least rise of an error that counts, as a part of the error of the rigid body.
const NOTABLE: f64 = 0.01;

/// The results of the command.
#[derive(Serialize)]
pub struct Transfer {
    schema: &'static str,
    model: ModelKind,
    /// The tasks with their short names.
    #[serde(skip)]
    labels: Labels,
    joints: Vec<String>,
    rows: Vec<Row>,
    /// Tasks whose data make the error on another task larger.
    harm: Vec<Harm>,
    correlation: Correlation,
}

/// One training set and one task that is not in it. Vectors have one entry per joint.
#[derive(Serialize)]
pub struct Row {
    train: Vec<String>,
    test: String,
    /// Root mean square of the torque error (N m or N).
    error: Vec<f64>,
    /// Root mean square of the torque error of the rigid body alone (N m or N).
    rigid: Vec<f64>,
    /// The error that the model predicts from its variance along the motion of the task, without torques of the task (N m
    /// or N).
    predicted: Vec<f64>,
    /// Mean log predictive density of the task's torques (nats per sample): the likelihood of a task that was not trained
    /// on.
    likelihood: Vec<f64>,
}

/// A training set whose error on a joint rises when a task is added.
#[derive(Serialize)]
pub struct Harm {
    /// The set without the task.
    train: Vec<String>,
    /// The task.
    added: String,
    /// The task on which the error rises.
    test: String,
    joint: String,
    /// The errors without and with the added task (N m or N).
    error: [f64; 2],
    /// Whether the likelihood of the tested task fell as well.
    likelihood_fell: bool,
    /// Whether the predicted error rose as well.
    predicted_rose: bool,
}

/// Spearman's rank correlation with the measured error over all rows, for each joint: 1 if the order is the same.
#[derive(Serialize)]
pub struct Correlation {
    /// The correlation of the predicted error.
    predicted: Vec<f64>,
    /// The correlation of the negative likelihood.
    likelihood: Vec<f64>,
}

/// Runs the command with `args`.
///
/// # Errors
/// If a scenario cannot be read, training fails or the file cannot be written.
pub fn run(args: &TransferArgs) -> anyhow::Result<()> {
    if let Some(path) = &args.json {
        output::check_writable(path)?;
        OutputFile::json(path, "\"schema\": \"testbed.transfer/").check()?;
    }
    ensure!(
        (2..=MOST_TASKS).contains(&args.train.len()),
        "--train names {} {}; 2 to {MOST_TASKS} can be compared",
        args.train.len(),
        if args.train.len() == 1 { "task" } else { "tasks" }
    );
    ensure!(
        args.model.learns(),
        "the model \"{}\" is not trained; give --model hybrid, independent-joint, …",
        args.model.flag()
    );
    for (index, task) in args.train.iter().enumerate() {
        ensure!(
            !args.train[..index].iter().any(|other| is_same(other, task)),
            "--train names {task} twice; give each task once"
        );
    }
    let progress = Progress::new("training on every set of tasks");
    let transfer = compare(args, &progress)?;
    progress.finish();
    if let Some(path) = &args.json {
        output::write_json(path, &transfer)?;
    }
    output::print_beside(args.json.as_deref(), &words::text(&transfer))
}

fn compare(args: &TransferArgs, progress: &Progress) -> anyhow::Result<Transfer> {
    let scenario = Scenario::load(&args.test)?;
    let chain = ChainArgs::default();
    let mut tasks = args.train.clone();
    // The scenario may be one of the tasks, which are all tested when they are left out.
    if !tasks.iter().any(|task| is_same(task, &args.test)) {
        tasks.push(args.test.clone());
    }
    let labels = Labels::new(&tasks);
    for note in training::unused_settings(&scenario, &tasks, &chain)? {
        output::say(format_args!("note: {note}"));
    }
    let samples_of = |names: &[String]| training::training_samples(&scenario, names, &chain, 0);
    let tests: Vec<Samples> =
        tasks.iter().map(|task| samples_of(std::slice::from_ref(task))).collect::<anyhow::Result<_>>()?;
    if let Some(folder) = &args.samples {
        samples_file::write(folder, &scenario, &labels.files(), &tests)?;
    }
    let rigid = ModelKind::RigidBody.build(
        &scenario.arm,
        &scenario.nominal_arm(),
        &tests[0],
        &args.length_scales.training_options(),
    )?;
    let sets = (1_usize << args.train.len()) - 1;
    let what = "training on every set of tasks, regressions";
    let pieces = Pieces::new(progress, what, sets * scenario.arm.dof(), 1.0);
    let of_set = |&set: &usize| -> anyhow::Result<Vec<Row>> {
        let train: Vec<String> =
            (0..args.train.len()).filter(|task| set >> task & 1 == 1).map(|task| args.train[task].clone()).collect();
        let model = args.model.build_with(
            &scenario.arm,
            &scenario.nominal_arm(),
            &samples_of(&train)?,
            &args.length_scales.training_options(),
            &|| pieces.next(),
        );
        let model = model.with_context(|| format!("training on {}", train.join(", ")))?;
        let others = tasks.iter().zip(&tests).filter(|(task, _)| !train.contains(task));
        Ok(others.map(|(task, samples)| row(model.as_ref(), rigid.as_ref(), &train, task, samples)).collect())
    };
    // Sets with fewer tasks come first, as in the table.
    let mut sets: Vec<usize> = (1..1_usize << args.train.len()).collect();
    sets.sort_by_key(|set| (set.count_ones(), set.reverse_bits().wrapping_neg()));
    let rows: Vec<Vec<Row>> = sets.par_iter().map(of_set).collect::<anyhow::Result<_>>()?;
    let rows: Vec<Row> = rows.into_iter().flatten().collect();
    let joints: Vec<String> = scenario.arm.joints().iter().map(|joint| joint.name.clone()).collect();
    let correlation = |value: fn(&Row, usize) -> f64| -> Vec<f64> {
        (0..joints.len()).map(|joint| correlation(&rows, joint, value)).collect()
    };
    Ok(Transfer {
        schema: "testbed.transfer/1",
        model: args.model,
        harm: harm(&rows, &joints),
        correlation: Correlation {
            predicted: correlation(|row, joint| row.predicted[joint] / row.rigid[joint]),
            likelihood: correlation(|row, joint| -row.likelihood[joint] - row.rigid[joint].ln()),
        },
        joints,
        rows,
        labels,
    })
}

/// The rank correlation of `value` with the error of `joint` relative to that of the rigid body, over the rows in which the rigid body
/// has an error. NaN without an order.
fn correlation(rows: &[Row], joint: usize, value: fn(&Row, usize) -> f64) -> f64 {
    let rows = rows.iter().filter(|row| row.rigid[joint] > 0.0);
    let (values, errors) = rows.map(|row| (value(row, joint), row.error[joint] / row.rigid[joint])).unzip();
    rank_correlation(values, errors)
}

/// Whether two tasks are the same name or file.
fn is_same(a: &str, b: &str) -> bool {
    a == b || std::path::absolute(a).is_ok_and(|a| std::path::absolute(b).is_ok_and(|b| a == b))
}

/// Error and predictions of `model`, trained on `train`, on the samples of `test`.
fn row(model: &dyn TorqueModel, rigid: &dyn TorqueModel, train: &[String], test: &str, samples: &Samples) -> Row {
    let dof = model.dof();
    let mut workspace = Workspace::new(dof);
    let mut prediction = Prediction::new(dof);
    let (mut expected, mut likelihood) = (vec![0.0; dof], vec![0.0; dof]);
    let mut count = 0.0;
    for sample in samples.iter().step_by(EVERY) {
        count += 1.0;
        model.predict(&mut workspace, sample.q, sample.qd, sample.qdd, &mut prediction);
        let variances = model.variance(&mut workspace, sample.q, sample.qd, sample.qdd);
        let variances = variances.unwrap_or_default();
        for (joint, variance) in variances.iter().enumerate() {
            // The variance of the torque is the sum of those of the function and of the noise.
            let variance = variance + model.noise(joint).powi(2);
            let error = sample.tau[joint] - prediction.torque(joint);
            expected[joint] += variance;
            likelihood[joint] -= 0.5 * (error * error / variance + (std::f64::consts::TAU * variance).ln());
        }
    }
    let root = |squares: Vec<f64>| squares.iter().map(|square| square.sqrt()).collect();
    Row {
        train: train.to_vec(),
        test: test.to_owned(),
        error: root(model.mean_squared_error(samples)),
        rigid: root(rigid.mean_squared_error(samples)),
        predicted: expected.iter().map(|sum| (sum / count).sqrt()).collect(),
        likelihood: likelihood.iter().map(|sum| sum / count).collect(),
    }
}

/// Each set and added task with which the error on a joint of another task is larger than with the set alone.
fn harm(rows: &[Row], joints: &[String]) -> Vec<Harm> {
    let mut found = Vec::new();
    for with in rows.iter().filter(|row| row.train.len() > 1) {
        for added in &with.train {
            let rest: Vec<String> = with.train.iter().filter(|task| *task != added).cloned().collect();
            let Some(without) = rows.iter().find(|row| row.train == rest && row.test == with.test) else {
                continue;
            };
            for (joint, name) in joints.iter().enumerate() {
                let error = [without.error[joint], with.error[joint]];
                if error[1] > RISES * error[0] && error[1] - error[0] > NOTABLE * with.rigid[joint] {
                    found.push(Harm {
                        train: rest.clone(),
                        added: added.clone(),
                        test: with.test.clone(),
                        joint: name.clone(),
                        error,
                        likelihood_fell: with.likelihood[joint] < without.likelihood[joint],
                        predicted_rose: with.predicted[joint] > without.predicted[joint],
                    });
                }
            }
        }
    }
    found
}

/// Spearman's rank correlation; equal values share their ranks' mean. NaN if all of one side are equal.
fn rank_correlation(a: Vec<f64>, b: Vec<f64>) -> f64 {
    let (a, b) = (ranks(&a), ranks(&b));
    let mean = (a.len() as f64 - 1.0) / 2.0;
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
    product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt()
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let below = |value: f64| values.iter().filter(|other| **other < value).count() as f64;
    let equal = |value: f64| values.iter().filter(|other| **other == value).count() as f64;
    values.iter().map(|&value| below(value) + (equal(value) - 1.0) / 2.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_correlate_whatever_the_scale() {
        let a = vec![3.0, 1.0, 2.0, 10.0];
        assert!((rank_correlation(a.clone(), vec![0.3, 0.1, 0.2, 0.4]) - 1.0).abs() < 1e-12);
        assert!((rank_correlation(a.clone(), vec![-3.0, -1.0, -2.0, -4.0]) + 1.0).abs() < 1e-12);
        // Ranks 2 0 1 3 and 0.5 0.5 2 3.
        let tied = rank_correlation(a, vec![1.0, 1.0, 2.0, 3.0]);
        assert!((tied - 3.0 / (5.0_f64 * 4.5).sqrt()).abs() < 1e-12, "{tied}");
    }

    fn made(train: &[&str], test: &str, error: f64, predicted: f64, likelihood: f64) -> Row {
        Row {
            train: train.iter().map(|task| (*task).to_owned()).collect(),
            test: test.into(),
            error: vec![error],
            rigid: vec![1.0],
            predicted: vec![predicted],
            likelihood: vec![likelihood],
        }
    }

    #[test]
    fn a_task_that_harms_is_found() {
        let rows =
            [made(&["A"], "D", 0.2, 0.2, 1.0), made(&["B"], "D", 0.5, 0.3, 0.5), made(&["A", "B"], "D", 0.3, 0.1, 0.8)];
        let found = harm(&rows, &["joint1".to_owned()]);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].added.as_str(), found[0].train.join(",").as_str()), ("B", "A"));
        assert!(found[0].likelihood_fell && !found[0].predicted_rose);
    }
    /// Where the rigid body is exact, the error has no relative size, and takes part in no order.
    #[test]
    fn rows_without_an_error_of_the_rigid_body_are_in_no_correlation() {
        let exact = Row { rigid: vec![0.0], ..made(&["B"], "A", 0.9, 0.01, 0.0) };
        let rows = [
            made(&["A"], "D", 0.2, 0.2, 1.0),
            made(&["B"], "D", 0.5, 0.3, 0.5),
            made(&["C"], "D", 0.6, 0.4, 0.5),
            exact,
        ];
        let predicted = |row: &Row, joint: usize| row.predicted[joint];
        assert!((correlation(&rows, 0, predicted) - 1.0).abs() < 1e-12);
        assert!(correlation(&rows[3..], 0, predicted).is_nan());
    }

    #[test]
    fn the_same_task_is_recognised() {
        assert!(is_same("taskA", "taskA") && is_same("a/b.csv", "./a/b.csv") && !is_same("a/b.csv", "c/b.csv"));
    }
}
