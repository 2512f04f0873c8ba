//! `testbed prove --published`: recordings of real robots, diagnosed under seal, with published values as the ground truth.

mod figure;
mod file;
mod fold;
mod misses;
mod page;
mod quantities;
mod robot_page;
mod robots;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;

use anyhow::{Context, ensure};
use faults::Seal;
use scoring::{Answer, Published, PublishedFate, RobotScore};
use serde::Serialize;

use super::case_paths::CasePaths;
use super::child::{Task, list};
use super::vault::Vault;
use super::work;
use crate::cli::ProveArgs;
use crate::written::Written;
use crate::{interrupt, output};
use file::{File, Robot};

/// The content of `score.json`.
#[derive(Serialize)]
pub struct Real {
    /// `testbed.published_proof/1`.
    pub schema: &'static str,
    /// The command that repeats the proof.
    pub command: String,
    /// The seal, made before the first diagnosis.
    pub seal: Seal,
    /// The SHA-256 of each diagnosis by robot, fixed before the published values were opened.
    pub answers: BTreeMap<String, Option<String>>,
    /// The outcome of each robot.
    pub robots: Vec<Tried>,
    /// Robots of the file without a folder.
    pub absent: Vec<String>,
}

/// A robot with its recordings and its results.
#[derive(Serialize)]
pub struct Tried {
    /// The robot in the file.
    #[serde(skip)]
    pub robot: Robot,
    /// The message of the program if there is no diagnosis.
    pub error: Option<String>,
    /// The number of (effect, joint) pairs that a publication excludes.
    pub deniable: usize,
    /// The score.
    pub score: RobotScore,
}

/// Runs the protocol on the robots of the file at `path` whose folders are in `recordings`; finished steps are not
/// repeated.
///
/// # Errors
/// If the file is inconsistent, no robot's folder exists or a file of one is missing, a seal is broken, a process cannot be
/// started, or the user interrupts.
pub fn run(args: &ProveArgs, path: &Path, recordings: &Path) -> anyhow::Result<()> {
    let file = File::load(path)?;
    let (robots, absent) = robots::there(&file, recordings)?;
    let vault = Vault::new(&args.out)?;
    let deferred = interrupt::Deferred::start();
    let places: Vec<CasePaths> =
        robots.iter().enumerate().map(|(number, robot)| robots::place(number, robot, &vault.out)).collect();
    let tasks: Vec<(&Robot, &CasePaths)> = robots.iter().zip(&places).collect();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = args.jobs.map_or(cores, usize::from);
    work::all("copying", &tasks, jobs, |(robot, place)| robots::stage(robot, &recordings.join(&robot.name), place))?;
    let names: Vec<&str> = robots.iter().map(|robot| robot.name.as_str()).collect();
    let source = format!("{} as published in a file with SHA-256 {}", names.join(", "), file.sha256);
    let seal = vault.seal(&places, source)?;
    let pairs: Vec<_> = places.iter().zip(&seal.cases).collect();
    work::all("diagnosing", &pairs, jobs, |(place, sealed)| {
        vault.diagnose(place, sealed, &format!("diagnoses/{}", place.name), Task::default())
    })?;
    let answers = vault.answers(&places)?;
    output::write_json(&vault.out.join("answers.json"), &answers)?;
    // The published values are opened only after all diagnoses are written.
    let truths: Mutex<BTreeMap<String, Published>> = Mutex::default();
    work::all("fitting the published effects", &pairs, jobs, |(place, sealed)| {
        let bytes = std::fs::read(&place.truth).with_context(|| place.truth.display().to_string())?;
        sealed.check_truth(&bytes)?;
        let truth: Published = serde_json::from_slice(&bytes).with_context(|| place.truth.display().to_string())?;
        let only = list(&truth.terms());
        let task = Task { only: Some(&only), ..Task::default() };
        vault.diagnose(place, sealed, &control(place), task)?;
        if let Ok(mut truths) = truths.lock() {
            truths.insert(place.name.clone(), truth);
        }
        Ok(())
    })?;
    let mut truths = truths.into_inner().unwrap_or_default();
    drop(deferred);
    let mut tried = Vec::new();
    for (robot, place) in robots.into_iter().zip(&places) {
        let truth = truths.remove(&place.name).context("its truth was opened")?;
        let (record, text) = vault.answer(&format!("diagnoses/{}", place.name))?;
        let (answer, said) = (parsed(text)?, parsed(vault.answer(&control(place))?.1)?);
        tried.push(Tried {
            score: truth.score(answer.as_ref(), said.as_ref()),
            error: record.and_then(|record| record.error),
            deniable: robot.deniable(),
            robot,
        });
    }
    let real = Real {
        schema: "testbed.published_proof/1",
        command: command(path, recordings),
        seal,
        answers,
        robots: tried,
        absent,
    };
    write(args, &vault.out, &real)
}

/// The command that repeats the proof, with an arbitrary output folder.
fn command(file: &Path, recordings: &Path) -> String {
    let (file, recordings) = (file.display(), recordings.display());
    format!("testbed prove --published {file} --recordings {recordings} --out proof-real/")
}

/// The name of the fit of the published effects.
fn control(place: &CasePaths) -> String {
    format!("controls/{}.said", place.name)
}

fn parsed(text: Option<String>) -> anyhow::Result<Option<Answer>> {
    Ok(text.map(|text| serde_json::from_str(&text)).transpose()?)
}

fn write(args: &ProveArgs, out: &Path, real: &Real) -> anyhow::Result<()> {
    let (html, score) = (out.join("report.html"), out.join("score.json"));
    let mut written = Written::default();
    let made = "Made by `testbed prove --published`; the same recordings, file and program give the same bytes.";
    let blocks = page::blocks(real);
    let eyebrow = format!("testbed proof · {} · sealed as `{}`", names(real), real.seal.whole);
    let text = report::block_page("Real robots: a blind proof", &eyebrow, &blocks, made);
    written.add(&html, || output::write_text(&html, &text));
    written.add(&score, || output::write_json(&score, real));
    if let Some(path) = &args.markdown {
        written.add(path, || output::write_text(path, &report::markdown(&blocks, made)));
    }
    output::print(&summary(real))?;
    output::print(&written.lines())?;
    written.finish()
}

fn names(real: &Real) -> String {
    let names: Vec<&str> = real.robots.iter().map(|tried| tried.robot.name.as_str()).collect();
    names.join(", ")
}

/// The robots as a table.
fn summary(real: &Real) -> String {
    let header = ["robot", "published, named", "not testable", "contradicted", "held-out error"].map(str::to_owned);
    let mut table = report::terminal::table(header);
    for Tried { robot, score, .. } in &real.robots {
        let count = |fates: &[PublishedFate]| score.said.iter().filter(|said| fates.contains(&said.fate)).count();
        let found = count(&[PublishedFate::Named, PublishedFate::SameTorque]);
        let contradicted = score.besides.iter().filter(|name| name.contradicted_by.is_some()).count();
        table.add_row([
            robot.name.clone(),
            format!("{found} of {}", score.said.len()),
            count(&[PublishedFate::NotObservable]).to_string(),
            contradicted.to_string(),
            fold::held_out(score),
        ]);
    }
    format!("{}; sealed as {}\n{table}\n", names(real), real.seal.whole)
}

/// Refuses an empty list of `what` under `place`.
fn ensure_some<T>(list: &[T], place: &str, what: &str) -> anyhow::Result<()> {
    ensure!(!list.is_empty(), "{place}: {what} is empty; name at least one");
    Ok(())
}
