//! The command itself: files in, diagnosis, files out.

use std::path::{Path, PathBuf};

use anyhow::Context;
use arm::Arm;
use diagnosis::{Diagnosis, Input, JointRollout, Options, Trace};
use recording::RegularRecording;

use super::effect_file::EffectFile;
use super::learned::{self, LearnedOptions, Motion};
use super::rollout::{RolloutOptions, rollout};
use super::{inputs, next_file, page, terminal, urdf_file};
use crate::cli::DiagnoseArgs;
use crate::library::{self, Source};
use crate::output;

/// Diagnoses where and why the recordings that `args` name differ from the robot's model.
///
/// # Errors
/// If an input cannot be used or an output cannot be written; nothing is written then.
pub fn run(args: &DiagnoseArgs) -> anyhow::Result<()> {
    inputs::check_outputs(args)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.jobs.map_or(0, usize::from))
        .build()
        .context("starting threads")?;
    pool.install(|| diagnose(args))
}

fn diagnose(args: &DiagnoseArgs) -> anyhow::Result<()> {
    let (arm, urdf_path) = load_robot(&args.robot)?;
    let known = inputs::known(args, &arm)?;
    let only = inputs::only(args, &arm)?;
    let spinner = output::spinner("reading");
    let recordings = inputs::read(args, &arm, &spinner)?;
    let list: Vec<Input<'_>> = recordings
        .iter()
        .map(|recording| Input {
            name: &recording.name,
            recording: &recording.regular,
            held_out: recording.held_out,
        })
        .collect();
    let options = Options {
        cutoff: args.cutoff.unwrap_or(Options::default().cutoff),
        known,
        only,
        next: args.next.is_some(),
    };
    let mut diagnosis = diagnosis::diagnose(&arm, &list, &options, &|doing| spinner.set_message(doing.to_owned()))?;
    for remark in &diagnosis.remarks {
        spinner.suspend(|| eprintln!("note: {remark}"));
    }
    // What is known is part of the model that the findings come on top of.
    let mut effects = options.known.clone();
    effects.extend(diagnosis.effects.iter().cloned());
    if !args.torques_only {
        spinner.set_message("learning a correction to compare with");
        learn(&arm, &mut diagnosis)?;
    }
    spinner.set_message("driving the simulated arm");
    let simulated = recordings
        .iter()
        .rfind(|recording| recording.held_out)
        .or(recordings.last())
        .filter(|_| !args.torques_only)
        .map(|recording| &recording.regular);
    let remarks = match simulated {
        Some(recording) => simulate(&arm, &options.known, &effects, recording, &mut diagnosis),
        None => Vec::new(),
    };
    spinner.finish_and_clear();
    for remark in remarks {
        eprintln!("note: simulation: {remark}");
    }
    let removed = write(args, &arm, &urdf_path, &diagnosis, effects)?;
    output::print(&terminal::table(&diagnosis.report))?;
    let is_written = |path: &&Path| args.next.as_deref() != Some(*path) || diagnosis.next.is_some();
    for path in args.outputs().into_iter().filter(is_written) {
        output::print(&format!("written: {}\n", path.display()))?;
    }
    if let Some(path) = removed {
        let path = path.display();
        output::print(&format!(
            "removed: {path}, of an earlier diagnosis: this one proposes no motion\n"
        ))?;
    }
    Ok(())
}

fn load_robot(robot: &str) -> anyhow::Result<(Arm, PathBuf)> {
    let here = Source {
        name: String::new(),
        path: "".into(),
        text: String::new(),
    };
    let (arm, path) = library::load_arm(robot, &here).with_context(|| format!("--robot {robot}"))?;
    for warning in arm.warnings() {
        eprintln!("note: {}: {warning}", path.display());
    }
    Ok((arm, path))
}

fn motion(trace: &Trace) -> Motion<'_> {
    Motion {
        q: &trace.q,
        qd: &trace.qd,
        qdd: &trace.qdd,
        tau: &trace.tau,
        moving: &trace.moving,
    }
}

/// Fills in what a correction learned from the same recordings leaves.
fn learn(arm: &Arm, diagnosis: &mut Diagnosis) -> anyhow::Result<()> {
    let of = |held_out: bool| -> Vec<&Trace> {
        let traces = diagnosis.traces.recordings.iter();
        traces.filter(|trace| trace.held_out == held_out).collect()
    };
    let (train, held) = (of(false), of(true));
    let moves = |traces: &[&Trace]| {
        traces
            .iter()
            .any(|trace| trace.moving.iter().flatten().any(|&moving| moving))
    };
    if held.is_empty() || !moves(&train) {
        return Ok(());
    }
    let training: Vec<Motion<'_>> = train.iter().map(|trace| motion(trace)).collect();
    let tried: Vec<Motion<'_>> = held.iter().map(|trace| motion(trace)).collect();
    let predicted =
        learned::predict(arm, &training, &tried, &LearnedOptions::default()).context("learning a correction")?;
    for (joint, described) in arm.joints().iter().enumerate() {
        // Where the joint moves, as the other errors are; over all where it hardly does.
        let moving: usize = held
            .iter()
            .map(|trace| trace.moving[joint].iter().filter(|&&m| m).count())
            .sum();
        let (mut error, mut count, mut values) = (0.0, 0.0, Vec::new());
        for (trace, prediction) in held.iter().zip(&predicted) {
            for (row, tau) in trace.tau[joint].iter().enumerate() {
                if moving < diagnosis::LEAST_ROWS || trace.moving[joint][row] {
                    error += (tau - prediction[joint][row]).powi(2);
                    count += 1.0;
                    values.push(*tau);
                }
            }
        }
        let error: f64 = error / f64::max(count, 1.0);
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let power = values.iter().map(|tau| (tau - mean).powi(2)).sum::<f64>() / values.len().max(1) as f64;
        if let Some(fit) = diagnosis.report.fit.get_mut(&described.name) {
            fit.held_out_nrmse_learned = (power > 0.0).then(|| (error / power).sqrt());
        }
    }
    Ok(())
}

/// Drives the simulated arm with the recorded torques, with and without what was found; remarks to pass on.
fn simulate(
    arm: &Arm,
    known: &[effects::Effect],
    effects: &[effects::Effect],
    recording: &RegularRecording,
    diagnosis: &mut Diagnosis,
) -> Vec<String> {
    if effects.len() == known.len() {
        return Vec::new();
    }
    match rollout(arm, known, effects, recording, &RolloutOptions::default()) {
        Ok(result) => {
            diagnosis.report.rollout = arm
                .joints()
                .iter()
                .zip(&result.joints)
                .map(|(joint, rollout)| (joint.name.clone(), JointRollout { ..*rollout }))
                .collect();
            let mut remarks = result.remarks;
            let windows = result.windows.len();
            for (name, count) in [
                ("nominal", result.runaway_nominal),
                ("corrected", result.runaway_augmented),
            ] {
                if count > 0 {
                    remarks.push(format!(
                        "the {name} arm left the recorded motion by more than a turn or a metre in {count} of {windows} windows; its distance is a lower bound"
                    ));
                }
            }
            remarks
        }
        // A diagnosis in torque is of use without: some arms cannot be simulated (a link without mass).
        Err(error) => vec![format!("not done: {error:#}")],
    }
}

/// Writes what `args` ask for; the earlier proposal that was removed, if none took its place.
fn write<'a>(
    args: &'a DiagnoseArgs,
    arm: &Arm,
    urdf_path: &Path,
    diagnosis: &Diagnosis,
    effects: Vec<effects::Effect>,
) -> anyhow::Result<Option<&'a Path>> {
    if let Some(path) = &args.urdf {
        let text = library::urdf_text(&args.robot, urdf_path)?;
        let corrected = urdf_file::corrected_urdf(&text, arm, &effects)?;
        recording::write_whole(path, |file| std::io::Write::write_all(file, corrected.as_bytes()))?;
    }
    if let Some(path) = &args.model {
        let file = EffectFile {
            robot: Some(arm.name().to_owned()),
            effects,
        };
        file.write(path)?;
    }
    let mut removed = None;
    if let Some(path) = &args.next {
        match (&diagnosis.next, &diagnosis.report.next_experiment) {
            (Some(motion), Some(next)) => next_file::write(path, &args.robot, urdf_path, next, motion)?,
            _ => removed = next_file::remove_earlier(path)?.then_some(path.as_path()),
        }
    }
    if let Some(path) = &args.report {
        page::write(path, &diagnosis.report, &diagnosis.traces, arm)?;
    }
    if let Some(path) = &args.json {
        output::write_json(path, &diagnosis.report)?;
    }
    show(args, arm, urdf_path, diagnosis)?;
    Ok(removed)
}

#[cfg(feature = "viewer")]
fn show(args: &DiagnoseArgs, arm: &Arm, urdf_path: &Path, diagnosis: &Diagnosis) -> anyhow::Result<()> {
    use crate::cli::Rerun;
    use crate::viewer::Sink;
    let sink = match &args.rerun {
        None | Some(Rerun::Off) => return Ok(()),
        Some(Rerun::Save(Some(path))) => Sink::Save(path.clone()),
        Some(Rerun::Save(None)) => Sink::Save("diagnosis.rrd".into()),
        Some(Rerun::Spawn) => Sink::Spawn,
        Some(Rerun::Connect(url)) => Sink::Connect(url.clone()),
    };
    super::rerun::write(&sink, &diagnosis.report, &diagnosis.traces, arm, urdf_path)
}

#[cfg(not(feature = "viewer"))]
fn show(args: &DiagnoseArgs, _: &Arm, _: &Path, _: &Diagnosis) -> anyhow::Result<()> {
    if matches!(args.rerun, None | Some(crate::cli::Rerun::Off)) {
        return Ok(());
    }
    anyhow::bail!("this testbed was built without the viewer; build it with `--features viewer`, or leave --rerun out")
}
