//! `testbed excite`: the motion from which a robot's parameters are estimated best, before the first recording.

mod compare;
mod limits;
mod progress;

use std::fmt::Write;
use std::io::{BufRead, Read};
use std::path::Path;

use anyhow::{Context, ensure};
use arm::{Arm, JointKind};
use diagnosis::{Excitation, ExcitationError, ExcitationOptions, JointLimits, JointUse, Quality};
use effects::Quantity;
use recording::Recording;
use report::terminal::{fitted, table, wrapped};
use report::{numbers, words};
use torque::Motion;

use crate::cli::ExciteArgs;
use crate::output::{self, OutputFile};
use crate::scenario::writer;
use crate::written::Written;
use study::robot::{RobotFile, named_robot};

/// The deviations of one sine per joint, relative to the proposed motion, below which a note says so.
const CLEARLY_BETTER: f64 = 0.95;
/// A revolute joint that moves by less hardly moves (rad).
const LEAST_RANGE: f64 = 0.05;
/// The first line of a file with references is shorter (bytes).
const LONGEST_HEADER: u64 = 100_000;
/// A motion with a larger condition number of the base regressor determines its parameters badly.
const WORST_CONDITION: f64 = 1e4;

/// Proposes a motion for the robot that `args` name.
///
/// # Errors
/// If an input cannot be used or a limit is missing; nothing is written then. If an output cannot be written; the others are
/// written then.
pub fn run(args: &ExciteArgs) -> anyhow::Result<()> {
    let outputs = args.outputs();
    for output in &outputs {
        output::check_writable(output.path)?;
        let inputs = args.compare.iter().map(std::path::PathBuf::as_path);
        output::check_is_no_input(output.path, inputs.chain([Path::new(&args.robot)]))?;
    }
    output::check_distinct(&outputs)?;
    check_replaceable(args)?;
    outputs.iter().try_for_each(OutputFile::check)?;
    let robot = named_robot(&args.robot)?;
    let arm = robot.arm(&args.chain.options(&[])).context("--robot")?;
    for warning in arm.warnings() {
        output::say(format_args!("note: {}: {warning}", robot.path.display()));
    }
    let limits = limits::of(args, &arm)?;
    let recordings = compare::read(&args.compare, &arm)?;
    let options = ExcitationOptions { duration: args.duration, seed: args.seed };
    let progress = progress::Progress::new("searching");
    let found = diagnosis::excite(&arm, &limits, &options, &|part| progress.set(part));
    progress.finish();
    let found = found.map_err(|error| explained(error, &robot, &arm))?;
    let compared = compare::qualities(&recordings, &arm, &limits, &found)?;
    let mut files = Written::default();
    if let Some(path) = &args.scenario {
        let robot = writer::robot_from(path, &args.robot, &robot.path)?;
        files.add(path, || output::write_text(path, &scenario(&robot, &arm, &found)));
    }
    if let Some(path) = &args.csv {
        files.add(path, || Ok(references(&arm, &found, args.rate).write_csv(path)?));
    }
    output::print(&text(&arm, &found, &compared))?;
    for doubt in doubts(&arm, &found) {
        output::print(&wrapped(&doubt, ""))?;
    }
    for output in &outputs {
        output::print(&files.line(output.path).unwrap_or_default())?;
    }
    if outputs.is_empty() {
        output::print("No file was asked for: --csv writes the references, --scenario the motion.\n")?;
    }
    files.finish()
}

/// The first line of a scenario that this command writes.
const FIRST_LINE: &str = "# A motion for the first recording, proposed by testbed excite.";

/// Refuses outputs that would replace a file that is not an earlier output of this command, such as a recording.
///
/// # Errors
/// If there is one, or a file cannot be read.
fn check_replaceable(args: &ExciteArgs) -> anyhow::Result<()> {
    let first_line = |path: &Path| -> anyhow::Result<String> {
        let mut line = Vec::new();
        if path.is_file() {
            let file = std::fs::File::open(path).with_context(|| path.display().to_string())?;
            std::io::BufReader::new(file.take(LONGEST_HEADER)).read_until(b'\n', &mut line)?;
        }
        Ok(String::from_utf8_lossy(&line).trim_end().to_owned())
    };
    let has =
        |header: &str, kind: &str| header.contains(&format!(",{kind}_")) || header.contains(&format!(",\"{kind}_"));
    if let Some(path) = &args.csv {
        let line = first_line(path)?;
        ensure!(
            line.is_empty() || (line.starts_with("t,") && has(&line, "qdd") && !has(&line, "tau")),
            "--csv {}: exists and does not hold references of an earlier run of testbed excite; give another file",
            path.display()
        );
    }
    if let Some(path) = &args.scenario {
        let line = first_line(path)?;
        ensure!(
            line.is_empty() || line == FIRST_LINE,
            "--scenario {}: exists and is not a motion of an earlier run of testbed excite; give another file",
            path.display()
        );
    }
    Ok(())
}

/// An error with the flag that corrects it.
fn explained(error: ExcitationError, robot: &RobotFile, arm: &Arm) -> anyhow::Error {
    let kind = |name: &str| arm.joints().iter().find(|joint| joint.name == name).map(|joint| joint.kind);
    let remedy = match &error {
        ExcitationError::Unlimited { joint, what: "position" } => {
            format!("; give them: --position-limit {joint}=LOW:HIGH")
        }
        ExcitationError::Unlimited { joint, what } => {
            let unit = Quantity::Speed.unit(kind(joint).unwrap_or(JointKind::Revolute));
            format!("; give one: --{what}-limit {joint}=VALUE ({unit})")
        }
        ExcitationError::NoRoom { joint, what, .. } => format!("; give another: --{what}-limit {joint}=…"),
        ExcitationError::TooWeak { joint, .. } => {
            format!("; check masses and effort limit, or give the limit: --effort-limit {joint}=VALUE")
        }
        ExcitationError::Search(_) => String::new(),
    };
    anyhow::anyhow!("{}: {error}{remedy}", robot.path.display())
}

/// The reference trajectory at `rate` (Hz), from the start to the end of the motion.
fn references(arm: &Arm, found: &Excitation, rate: f64) -> Recording {
    let dof = arm.dof();
    let signal = || vec![Vec::new(); dof];
    let (mut time, mut q, mut qd, mut qdd) = (Vec::new(), signal(), signal(), signal());
    let mut motion = Motion::new(dof);
    for k in 0..=(found.duration * rate).round() as usize {
        time.push(k as f64 / rate);
        found.reference.at(k as f64 / rate, &mut motion);
        for j in 0..dof {
            q[j].push(motion.q[j]);
            qd[j].push(motion.qd[j]);
            qdd[j].push(motion.qdd[j]);
        }
    }
    Recording {
        joints: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
        time,
        q,
        qd: Some(qd),
        qdd: Some(qdd),
        ..Recording::default()
    }
}

/// The parameters that the motion determines, in a sentence or two.
fn determined(found: &Excitation) -> String {
    let of = &found.determined;
    let mut text = format!(
        "It determines {} base parameters: {} combinations of the {} inertial parameters of the links, {} friction parameters \
         (viscous and Coulomb) and {}.",
        of.total(),
        of.inertial,
        of.of_inertial,
        of.friction,
        if of.drive == 1 { "1 drive inertia".to_owned() } else { format!("{} drive inertias", of.drive) }
    );
    if !of.drive_with_link.is_empty() {
        let _ = write!(
            text,
            " No motion distinguishes the drive inertia of {} from the inertia of the links.",
            words::list(&of.drive_with_link)
        );
    }
    text
}

/// A row of the table of motions.
fn row(name: &str, quality: &Quality) -> Vec<String> {
    let number = |value: f64| {
        if value.is_finite() { numbers::short(value) } else { "∞".to_owned() }
    };
    vec![name.to_owned(), number(quality.condition), number(quality.scaled_condition), number(quality.deviation)]
}

fn text(arm: &Arm, found: &Excitation, compared: &[(String, Quality)]) -> String {
    let mut text = wrapped(
        &format!(
            "A motion of {} s for {}: {} harmonics with a period of {} s, at rest at its start and at its end. {}",
            numbers::trimmed(found.duration),
            arm.name(),
            found.harmonics,
            numbers::trimmed(found.period),
            determined(found)
        ),
        "",
    );
    let mut joints = table(["joint", "start", "position", "speed", "torque"].map(str::to_owned));
    let mut start = Motion::new(arm.dof());
    found.reference.at(0.0, &mut start);
    for ((joint, needed), start) in arm.joints().iter().zip(&found.needed).zip(&start.q) {
        joints.add_row(joint_row(joint.kind, &needed.limits, *start));
    }
    let mut motions = table(["motion", "condition number", "scaled", "deviations"].map(str::to_owned));
    motions.add_row(row("proposed", &found.quality));
    if let Some(naive) = &found.naive {
        motions.add_row(row("one sine per joint", naive));
    }
    for (name, quality) in compared {
        motions.add_row(row(name, quality));
    }
    let _ = write!(text, "\n{}\n\n{}\n\n", fitted(joints), fitted(motions));
    text += &wrapped(
        "speed, torque: the largest, and its part of what is allowed, which is 80 % of the limit; condition number: of the base \
         regressor with the columns of friction and drive inertia; scaled: with all columns scaled to one norm; deviations: the \
         standard deviations of the parameters for the same duration, geometric mean, relative to the proposed motion",
        "",
    );
    text += &wrapped(
        "Collisions of the arm with itself and with its surroundings are not checked: run the motion slowly first.",
        "",
    );
    text
}

/// What makes the motion useless for an identification, or another one better, in sentences.
fn doubts(arm: &Arm, found: &Excitation) -> Vec<String> {
    let mut list = Vec::new();
    let hardly = |(joint, needed): &(&arm::Joint, &JointUse)| {
        joint.kind == JointKind::Revolute && needed.limits.position[1] - needed.limits.position[0] < LEAST_RANGE
    };
    let joints = arm.joints().iter().zip(&found.needed).filter(hardly);
    let names: Vec<String> = joints.map(|(joint, _)| joint.name.clone()).collect();
    if !names.is_empty() {
        list.push(format!(
            "Warning: within these limits, {} less than {} rad. No parameters can be estimated from such a motion; check the \
             limits.",
            match names.len() {
                1 => format!("{} moves by", names[0]),
                _ => format!("{} move by", words::list(&names)),
            },
            numbers::trimmed(LEAST_RANGE)
        ));
    }
    if let Some(naive) = found.naive.as_ref().filter(|naive| naive.deviation < CLEARLY_BETTER) {
        list.push(format!(
            "Note: one sine per joint, as fast as the limits allow, has smaller deviations in the mean ({}), because the frequencies of \
             the proposed motion end at {} Hz.",
            numbers::fixed(naive.deviation, 2),
            numbers::fixed(found.harmonics as f64 / found.period, 2)
        ));
    }
    if found.quality.condition > WORST_CONDITION {
        list.push(format!(
            "Warning: with a condition number above {WORST_CONDITION}, small errors of the measurement become large errors of \
             the parameters; check the limits, or give a longer --duration."
        ));
    }
    list
}

fn joint_row(kind: JointKind, needed: &JointLimits, start: f64) -> Vec<String> {
    let (place, torque) = (Quantity::Position.unit(kind), Quantity::Torque.unit(kind));
    let part = |value: f64, allowed: f64, unit: &str| {
        let of = if allowed.is_finite() { numbers::percent(value / allowed) } else { "no limit".to_owned() };
        format!("{} {unit} ({of})", numbers::short(value))
    };
    let [low, high] = needed.position.map(|value| numbers::fixed(value, 2));
    vec![
        needed.joint.clone(),
        numbers::fixed(start, 3),
        format!("{low} … {high} {place}"),
        part(needed.velocity, needed.velocity_allowed, &format!("{place}/s")),
        part(needed.torque, needed.torque_allowed, torque),
    ]
}

/// The motion as a scenario, with its purpose in comments.
fn scenario(robot: &str, arm: &Arm, found: &Excitation) -> String {
    let mut text = format!("{FIRST_LINE}\n#\n");
    let _ = writeln!(text, "# {}", determined(found));
    let _ = writeln!(
        text,
        "# Condition number of the base regressor: {} ({} with all columns scaled to one norm).",
        numbers::short(found.quality.condition),
        numbers::short(found.quality.scaled_condition)
    );
    text += "# Position, velocity, acceleration and torque of each joint, and what is allowed (the limits with a margin):\n";
    for JointUse { limits: joint, acceleration, acceleration_allowed } in &found.needed {
        let [low, high] = joint.position.map(numbers::short);
        let [least, most] = joint.position_allowed.map(numbers::short);
        let of = |value: f64, allowed: f64| {
            let allowed = if allowed.is_finite() { numbers::short(allowed) } else { "any".to_owned() };
            format!("{} of {allowed}", numbers::short(value))
        };
        let _ = writeln!(
            text,
            "#   {}: {low} to {high} of {least} to {most} rad or m; {} rad/s or m/s; {} rad/s2 or m/s2; {} N m or N",
            joint.joint,
            of(joint.velocity, joint.velocity_allowed),
            of(*acceleration, *acceleration_allowed),
            of(joint.torque, joint.torque_allowed)
        );
    }
    text +=
        "# Collisions of the arm with itself and with its surroundings are not checked: run the motion slowly first.\n";
    text += "# On a robot, follow the references that --csv writes; the motion begins and ends at rest.\n";
    text + &writer::scenario("Excitation", robot, arm, found.duration, &found.reference)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The loaded scenario equals the motion bit for bit.
    #[test]
    fn the_scenario_is_loaded_as_written() {
        let robot = named_robot("puma560").expect("it comes with testbed");
        let arm = robot.arm(&arm::ChainOptions::default()).expect("an arm");
        let options = ExcitationOptions { duration: 10.0, seed: 1 };
        let limits = diagnosis::MotionLimits::of(&arm);
        let found = diagnosis::excite(&arm, &limits, &options, &|_| {}).expect("a motion");
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("excite.toml");
        std::fs::write(&path, scenario("puma560", &arm, &found)).expect("it writes");
        let loaded = crate::scenario::Scenario::load(&path.display().to_string()).expect("it loads");
        assert_eq!(loaded.reference, found.reference);
        assert_eq!(loaded.duration, 10.0);
        assert!(!loaded.model.learns(), "it runs without training");
        let rows = references(&arm, &found, 100.0);
        assert_eq!((rows.time.len(), rows.q.len()), (1001, 6));
        assert_eq!(rows.time[1000], 10.0);
    }
}
