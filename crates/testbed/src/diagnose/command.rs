//! The command itself: files in, diagnosis, files out.

use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use arm::Arm;
use diagnosis::{Diagnosis, Step, Verdict};
use study::effect_file::EffectFile;
use study::notes::Notes;
use study::robot::RobotFile;
use study::{Diagnosed, Listener, mjcf_file, urdf_file};

use super::{next_file, outputs, residuals_file, trace_file};
use crate::cli::DiagnoseArgs;
use crate::output;
use crate::progress::Progress;

/// The exit status of `--fail-on-mismatch` where the model alone does not explain the recordings.
const MISMATCH: u8 = 3;

/// Diagnoses where and why the recordings that `args` name differ from the robot's model.
///
/// # Errors
/// If an input cannot be used or an output cannot be written; nothing is written then.
pub fn run(args: &DiagnoseArgs) -> anyhow::Result<ExitCode> {
    outputs::check(args)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.jobs.map_or(0, usize::from))
        .build()
        .context("starting threads")?;
    pool.install(|| diagnose(args))
}

fn diagnose(args: &DiagnoseArgs) -> anyhow::Result<ExitCode> {
    let progress = if args.quiet {
        Progress::hidden()
    } else {
        Progress::new("reading")
    };
    let study = args.request().run(&Terminal {
        args,
        progress: &progress,
    });
    progress.finish();
    let Diagnosed {
        robot,
        arm,
        diagnosis,
        effects,
    } = study?;
    let written = write(args, &arm, &robot, &diagnosis, effects)?;
    tell(args, &diagnosis, &written)?;
    let explains = diagnosis.report.verdict == Verdict::NoMismatch && diagnosis.report.findings.is_empty();
    Ok(if args.fail_on_mismatch && !explains {
        ExitCode::from(MISMATCH)
    } else {
        ExitCode::SUCCESS
    })
}

/// Tells what is done and noted on standard error.
struct Terminal<'a> {
    args: &'a DiagnoseArgs,
    progress: &'a Progress,
}

impl Listener for Terminal<'_> {
    fn doing(&self, step: Step<'_>) {
        self.progress.done(step.done, step.doing);
    }

    fn note(&self, text: &str) {
        if !self.args.quiet {
            self.progress.suspend(|| eprintln!("note: {text}"));
        }
    }

    fn recordings(&self, notes: &Notes, joints: &[&str]) {
        if self.args.quiet {
            return;
        }
        for line in notes.lines(joints, !self.args.verbose) {
            self.progress.suspend(|| eprintln!("{line}"));
        }
    }
}

/// Prints the result and the files written. JSON on standard output has it for itself.
fn tell(args: &DiagnoseArgs, diagnosis: &Diagnosis, written: &Written<'_>) -> anyhow::Result<()> {
    let report = &diagnosis.report;
    if args.prints_json() {
        output::print(&(serde_json::to_string_pretty(report)? + "\n"))?;
    } else if args.verbose {
        output::print(&report::terminal::complete(report))?;
    } else if !args.quiet {
        output::print(&report::terminal::diagnosis(report))?;
    }
    let say = |text: String| {
        if args.prints_json() {
            eprint!("{text}");
            return Ok(());
        }
        output::print(&text)
    };
    let is_written = |path: &&Path| args.next.as_deref() != Some(*path) || diagnosis.next.is_some();
    for path in args.outputs().into_iter().filter(is_written) {
        say(format!("written: {}\n", path.display()))?;
    }
    if args.quiet {
        return Ok(());
    }
    for (path, left) in &written.left {
        say(format!("not in {}:\n  {}\n", path.display(), left.join("\n  ")))?;
    }
    if let Some(path) = written.removed {
        say(format!(
            "removed: {} of an earlier diagnosis, because this one proposes no motion\n",
            path.display()
        ))?;
    }
    Ok(())
}

/// What there is to say of the files that were written.
#[derive(Default)]
struct Written<'a> {
    /// What a format cannot hold, by its file.
    left: Vec<(&'a Path, Vec<String>)>,
    /// An earlier proposal that was removed without a new one.
    removed: Option<&'a Path>,
}

/// Writes the requested files.
fn write<'a>(
    args: &'a DiagnoseArgs,
    arm: &Arm,
    robot: &RobotFile,
    diagnosis: &Diagnosis,
    effects: Vec<effects::Effect>,
) -> anyhow::Result<Written<'a>> {
    let mut written = Written::default();
    // Both are made before one of them is written.
    let urdf = |_| urdf_file::corrected_urdf(&robot.text, arm, &effects);
    let mjcf = |_| mjcf_file::mjcf(arm, &effects);
    let exports = [
        (&args.urdf, args.urdf.as_ref().map(urdf).transpose()?),
        (&args.mjcf, args.mjcf.as_ref().map(mjcf).transpose()?),
    ];
    for (path, export) in exports {
        if let (Some(path), Some(export)) = (path, export) {
            output::write_text(path, &export.text)?;
            if !export.left.is_empty() {
                written.left.push((path, export.left));
            }
        }
    }
    if let Some(path) = &args.model {
        let file = EffectFile {
            robot: Some(arm.name().to_owned()),
            effects,
        };
        file.write(path)?;
    }
    if let Some(path) = &args.next {
        match (&diagnosis.next, &diagnosis.report.next_experiment) {
            (Some(motion), Some(next)) => next_file::write(path, &args.robot, &robot.path, arm, next, motion)?,
            _ => written.removed = next_file::remove_earlier(path)?.then_some(path.as_path()),
        }
    }
    if let Some(path) = &args.trace {
        trace_file::write(path, &diagnosis.trace)?;
    }
    if let Some(path) = &args.residuals {
        residuals_file::write(path, arm, &diagnosis.traces)?;
    }
    if let Some(path) = &args.report {
        output::write_text(path, &report::page(&diagnosis.report, &diagnosis.traces, arm))?;
    }
    if let Some(path) = &args.markdown {
        output::write_text(path, &report::diagnosis_markdown(&diagnosis.report, arm))?;
    }
    if let Some(path) = args.json_file() {
        output::write_json(path, &diagnosis.report)?;
    }
    show(args, arm, &robot.path, diagnosis)?;
    Ok(written)
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
