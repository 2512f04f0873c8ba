//! `testbed conceal`: recordings of a simulated robot with injected faults, and the ground truth in a separate file.

mod effects;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, ensure};
use faults::{Campaign, Concealment, FaultError, Robot, Settings, conceal_case, conceal_effects, write_case};
use rayon::prelude::*;
use study::{robot, urdf_file};

use crate::cli::{ChainArgs, ConcealArgs};
use crate::library;
use crate::output;
use crate::progress::Progress;

/// Makes the cases of `args`: injects the faults, records, and writes recordings and ground truth.
///
/// # Errors
/// If a robot or an effect cannot be used, a case exists already, or none could be made.
pub fn run(args: &ConcealArgs) -> anyhow::Result<()> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.jobs.map_or(0, usize::from))
        .build()
        .context("starting threads")?;
    pool.install(|| conceal(args))
}

fn conceal(args: &ConcealArgs) -> anyhow::Result<()> {
    ensure!(
        args.effects.is_some() || args.seed.is_some(),
        "there is nothing to inject; give --seed N to draw cases, or --effects FILE with the effects to inject"
    );
    let robots = robots(&args.robot, &args.chain)?;
    let truths = args.out.join("truth");
    match &args.effects {
        Some(file) => given(args, file, &robots, &truths),
        None => drawn(args, &robots, &truths),
    }
}

/// The robots of the names or files, with the arm that `chain` selects; without names, the robots that come with testbed.
///
/// # Errors
/// If one does not exist or cannot be simulated, or an arm is selected on several robots.
pub fn robots(names: &[String], chain: &ChainArgs) -> anyhow::Result<Vec<Robot>> {
    ensure!(
        !chain.is_given() || names.len() == 1,
        "{}: chooses the arm of one robot; name it, and no other, with --robot",
        chain.to_string().trim_start()
    );
    let all: Vec<String> = robot::built_in().map(str::to_owned).collect();
    let names = if names.is_empty() { &all } else { names };
    names.iter().map(|name| robot(name, chain)).collect()
}

fn robot(name: &str, chain: &ChainArgs) -> anyhow::Result<Robot> {
    let doing = || format!("--robot {name}");
    let file = robot::named_robot(name)?;
    let arm = file.arm(&chain.options(&[])).context("--robot")?;
    // The recordings contain the arm only, so that the cases must be diagnosed without flags of the chain.
    let text = library::serial_urdf(&file.text, &arm).with_context(doing)?;
    // A diagnosis of the case would take friction that a diagnosis wrote as known, and the simulated robot has none but what is injected.
    let text = urdf_file::with_unknown_friction(&text);
    let stated = urdf_file::stated_rotor_inertias(&text, &arm).with_context(doing)?;
    let robot = Robot::new(text, &file.path).with_context(doing)?.with_stated_rotor_inertias(&stated);
    match library::rotor_inertias(name) {
        Some(rotors) => robot.with_rotor_inertias(&rotors).with_context(doing),
        None => Ok(robot),
    }
}

/// One case with the effects of a file.
fn given(args: &ConcealArgs, file: &Path, robots: &[Robot], truths: &Path) -> anyhow::Result<()> {
    let [robot] = robots else {
        anyhow::bail!("--effects are those of one robot; name it with --robot");
    };
    let effects = effects::load(file, robot.arm())?;
    let settings = Settings {
        seed: args.seed.unwrap_or(0),
        rate: args.rate,
        jitter: args.jitter,
        lost: args.lost,
        training: usize::from(args.training),
        background_friction: args.friction,
        lifelike: args.lifelike,
        urdf_error: args.urdf_error.unwrap_or(0.0),
    };
    refuse_existing(&args.out.join("case_000"))?;
    let concealment = conceal_effects(robot, "case_000", &effects, &settings)
        .with_context(|| format!("{} on {}", file.display(), robot.name()))?;
    write(&concealment, args, truths)
}

/// Cases drawn from the seed.
fn drawn(args: &ConcealArgs, robots: &[Robot], truths: &Path) -> anyhow::Result<()> {
    let campaign = Campaign {
        seed: args.seed.unwrap_or(0),
        cases: args.cases as usize,
        lifelike: args.lifelike,
        urdf_error: args.urdf_error,
    };
    let plans = campaign.plans();
    for plan in &plans {
        refuse_existing(&args.out.join(&plan.name))?;
    }
    let progress = Progress::new("concealing");
    let count = AtomicUsize::new(0);
    let made: Vec<anyhow::Result<String>> = plans
        .par_iter()
        .map(|plan| {
            let concealment = conceal_case(plan.robot(robots), plan)?;
            let folder = write_case(&concealment, &args.out, truths)?;
            let done = 1 + count.fetch_add(1, Ordering::Relaxed);
            let share = done as f64 / plans.len() as f64;
            progress.done(share, format!("{done} of {} cases are made", plans.len()));
            Ok(format!("written: {}\n", folder.display()))
        })
        .collect();
    progress.finish();
    let mut failed = Vec::new();
    let some_made = made.iter().any(Result::is_ok);
    for made in made {
        match made {
            Ok(line) => output::print(&line)?,
            Err(error) => failed.push(error),
        }
    }
    if some_made {
        output::print(&format!("ground truth: {}\n", truths.display()))?;
    }
    let count = failed.len();
    match failed.into_iter().next() {
        None => Ok(()),
        Some(error) if count == 1 => Err(error),
        Some(error) => Err(error.context(format!("{count} cases are missing; the first"))),
    }
}

fn refuse_existing(folder: &Path) -> anyhow::Result<()> {
    let is_empty = std::fs::read_dir(folder).map_or(!folder.exists(), |mut inside| inside.next().is_none());
    let path = folder.to_owned();
    ensure!(is_empty, FaultError::Exists { path });
    Ok(())
}

fn write(concealment: &Concealment, args: &ConcealArgs, truths: &Path) -> anyhow::Result<()> {
    let folder = write_case(concealment, &args.out, truths)?;
    output::print(&format!("written: {}\n", folder.display()))?;
    let truth = truths.join(format!("{}.json", concealment.truth.case));
    output::print(&format!("ground truth: {}\n", truth.display()))
}
