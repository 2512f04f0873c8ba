//! The protocol of a proof: inject, seal, diagnose, open, controls, experiments, closed loop, score, report.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

use ::report::score::{figure, wanted};
use ::report::terminal::table;
use anyhow::{Context, ensure};
use arm::Arm;
use faults::{Seal, SealedCase};
use scoring::{Truth, true_terms, wrong_term};
use serde::Serialize;

use super::case_paths::{CasePaths, Files};
use super::cases::Cases;
use super::child::{Task, list};
use super::proof::Proof;
use super::rows::{self, Row};
use super::shards::{self, Label};
use super::vault::{Vault, make_folder};
use super::{disturbance, experiments, given, published, report, tracking_step, work};
use crate::cli::ProveArgs;
use crate::interrupt;
use crate::output::{self, OutputFile};
use crate::written::Written;

/// Runs the protocol of `args`; finished steps are not repeated.
///
/// # Errors
/// If cases cannot be made or read, a seal is broken, a process cannot be started, or the user interrupts.
pub fn run(args: &ProveArgs) -> anyhow::Result<()> {
    if let Some(path) = &args.markdown {
        output::check_writable(path)?;
        let mark =
            if args.published.is_some() { "Made by `testbed prove --published`" } else { "Made by `testbed prove`;" };
        OutputFile::markdown(path).marked(mark).check()?;
    }
    ensure!(
        !args.chain.is_given() || (args.cases_from.is_none() && args.published.is_none() && args.merge.is_none()),
        "{}: chooses the arm of the robot that cases are drawn on; leave it out here",
        args.chain.to_string().trim_start()
    );
    if let (Some(file), Some(recordings)) = (&args.published, &args.recordings) {
        return published::run(args, file, recordings);
    }
    if let Some(folder) = &args.merge {
        let (label, rows) = shards::merge(folder)?;
        let proof = Proof::new(label.program, label.source, label.command, &rows)?;
        make_folder(&args.out)?;
        return write(args, &args.out, &proof);
    }
    let out = match args.shard {
        Some(shard) => args.out.join(shard.name()),
        None => args.out.clone(),
    };
    let deferred = interrupt::Deferred::start();
    let source = Cases::new(args)?;
    let vault = Vault::new(&out)?;
    vault.begin(&source)?;
    let mut places = source.places(&vault.out)?;
    if let Some(shard) = args.shard {
        places.retain(|place| shard.has(place.number));
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = args.jobs.map_or(cores, usize::from);
    let mut times = Times::default();
    let (seal, rows) = protocol(&source, &vault, &places, jobs, &mut times)?;
    drop(deferred);
    times.write(&out.join("times.json"))?;
    if let Some(shard) = args.shard {
        let path = args.out.join(format!("{}.parquet", shard.name()));
        let words = [source.describe(), source.command()];
        let label = Label::new(shard, seal.program, words, seal.whole);
        let mut written = Written::default();
        written.add(&path, || shards::write(&path, &label, &rows));
        output::print(&written.lines())?;
        return written.finish();
    }
    let proof = Proof::new(seal.program, source.describe(), source.command(), &rows)?;
    write(args, &out, &proof)
}

/// Injects, seals, diagnoses, opens, fits the controls, and closes the loop.
fn protocol(
    source: &Cases,
    vault: &Vault,
    places: &[CasePaths],
    jobs: usize,
    times: &mut Times,
) -> anyhow::Result<(Seal, Vec<Row>)> {
    if let Cases::Given { .. } = source {
        // An unreadable or a wrong ground truth must be reported before hours of diagnoses, not after.
        places.iter().try_for_each(given::check)?;
    }
    times.of("conceal", || work::all("concealing", places, jobs, |place| source.make(place)))?;
    let seal = times.of("seal", || vault.seal(places, source.describe()))?;
    let pairs: Vec<_> = places.iter().zip(&seal.cases).collect();
    times.of("diagnose", || {
        work::all("diagnosing", &pairs, jobs, |(place, sealed)| {
            let task = Task { next: true, ..Task::default() };
            vault.diagnose(place, sealed, &format!("diagnoses/{}", place.name), task)
        })
    })?;
    output::write_json(&vault.out.join("answers.json"), &vault.answers(places)?)?;
    // From here on, the ground truths are read.
    let truths: Mutex<BTreeMap<String, String>> = Mutex::default();
    times.of("controls", || {
        work::all("fitting the controls", &pairs, jobs, |(place, sealed)| {
            let bytes = std::fs::read(&place.truth).with_context(|| place.truth.display().to_string())?;
            sealed.check_truth(&bytes)?;
            let text = String::from_utf8(bytes).with_context(|| place.truth.display().to_string())?;
            let truth: Truth = rows::truth(&place.name, &text)?;
            let name = |control: &str| format!("controls/{}.{control}", place.name);
            let fit = |control: &str, terms: &[scoring::Name]| {
                let only = list(terms);
                let task = Task { only: Some(&only), ..Task::default() };
                vault.diagnose(place, sealed, &name(control), task)
            };
            fit("true", &true_terms(&truth))?;
            if let Some(wrong) = wrong_term(&truth, place.number) {
                fit("wrong", &wrong.terms)?;
            }
            if let Ok(mut truths) = truths.lock() {
                truths.insert(place.name.clone(), text);
            }
            Ok(())
        })
    })?;
    let mut truths = truths.into_inner().unwrap_or_default();
    times.of("experiments", || {
        let examined = experiments::examined(source, vault, &pairs)?;
        work::all("recording the proposed experiments", &examined, jobs, |(place, sealed)| {
            experiments::make(source, vault, place, sealed, &truths[&place.name])
        })
    })?;
    let to_track = source.tracked()?;
    let tracked: Vec<_> = pairs.iter().filter(|(place, _)| to_track.contains(&place.number)).collect();
    times.of("track", || {
        work::all("tracking task D", &tracked, jobs, |(place, sealed)| {
            tracking_step::track(source, vault, place, sealed, &truths[&place.name])
        })
    })?;
    let rows: anyhow::Result<Vec<Row>> = pairs
        .iter()
        .map(|(place, sealed)| {
            let truth = truths.remove(&place.name).unwrap_or_default();
            let is_tracked = to_track.contains(&place.number);
            let tracking = is_tracked.then(|| tracking_step::text(vault, place)).transpose()?;
            Ok(Row { tracking, ..row(vault, place, sealed, truth)? })
        })
        .collect();
    Ok((seal, rows?))
}

fn row(vault: &Vault, place: &CasePaths, sealed: &SealedCase, truth: String) -> anyhow::Result<Row> {
    let (record, diagnosis) = vault.answer(&format!("diagnoses/{}", place.name))?;
    let control = |name: &str| -> anyhow::Result<Option<String>> {
        Ok(vault.answer(&format!("controls/{}.{name}", place.name))?.1)
    };
    let again = experiments::result(vault, place)?;
    let arm = Arm::from_urdf(place.folder.join(Files::of(&place.folder)?.robot))?;
    Ok(Row {
        case: place.name.clone(),
        joints: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
        files: sealed.files.clone(),
        truth,
        diagnosis,
        error: record.and_then(|record| record.error),
        true_terms: control("true")?,
        wrong_term: control("wrong")?,
        tracking: None,
        again: again.0,
        again_error: again.1,
    })
}

fn write(args: &ProveArgs, out: &Path, proof: &Proof) -> anyhow::Result<()> {
    let (page, score) = (out.join("report.html"), out.join("score.json"));
    let mut written = Written::default();
    written.add(&page, || output::write_text(&page, &report::page(proof)));
    written.add(&score, || output::write_json(&score, proof));
    if let Some(path) = &args.markdown {
        written.add(path, || output::write_text(path, &report::markdown(proof)));
    }
    output::print(&summary(proof))?;
    output::print(&written.lines())?;
    written.finish()
}

/// The targets as a table.
fn summary(proof: &Proof) -> String {
    let header = ["figure", "", "wanted", "of", ""].map(str::to_owned);
    let mut table = table(header);
    for target in &proof.score.targets {
        let reached = match target.reached {
            Some(true) => "reached",
            Some(false) => "missed",
            None if target.counted.is_some_and(|counted| counted.of > 0) && target.at_least.is_some() => "too few",
            None => "–",
        };
        table.add_row([target.what.clone(), figure(target), wanted(target), target.of.to_string(), reached.to_owned()]);
    }
    let paper = proof.paper.as_ref().map_or_else(String::new, disturbance::words::line);
    format!("{}; sealed as {}\n{table}\n{paper}", proof.seal.source, proof.seal.whole)
}

/// The duration of each phase. It is the only result that differs between two runs, and therefore has its own file.
#[derive(Default, Serialize)]
struct Times {
    /// The durations (s) by phase, without steps that were finished before an interruption.
    seconds: Vec<(&'static str, f64)>,
}

impl Times {
    fn of<T>(&mut self, phase: &'static str, work: impl FnOnce() -> anyhow::Result<T>) -> anyhow::Result<T> {
        let start = Instant::now();
        let result = work()?;
        self.seconds.push((phase, start.elapsed().as_secs_f64()));
        Ok(result)
    }

    fn write(&self, path: &Path) -> anyhow::Result<()> {
        let seconds: BTreeMap<_, _> = self.seconds.iter().copied().collect();
        output::write_json(path, &seconds)
    }
}
