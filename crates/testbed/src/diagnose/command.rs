//! The command itself: files in, diagnosis, files out.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, bail};
use arm::Arm;
use diagnosis::{Diagnosis, Report, Step, Verdict};
use study::effect_file::EffectFile;
use study::notes::Notes;
use study::robot::RobotFile;
use study::{Diagnosed, Listener, mjcf_file, urdf_file};

use super::{next_file, outputs, residuals_file, trace_file};
use crate::cli::DiagnoseArgs;
use crate::progress::Progress;
use crate::written::Written;
use crate::{interrupt, output};

/// The exit status of `--fail-on-mismatch` where the model alone does not explain the recordings.
const MISMATCH: u8 = 3;

/// Diagnoses where and why the recordings that `args` name differ from the robot's model.
///
/// # Errors
/// If an input cannot be used, or an output cannot be written. In the second case, the result is printed and the other
/// outputs are written.
pub fn run(args: &DiagnoseArgs) -> anyhow::Result<ExitCode> {
    outputs::check(args)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.jobs.map_or(0, usize::from))
        .build()
        .context("starting threads")?;
    pool.install(|| diagnose(args))
}

fn diagnose(args: &DiagnoseArgs) -> anyhow::Result<ExitCode> {
    let progress = if args.quiet { Progress::hidden() } else { Progress::new("reading") };
    let study = args.request().run(&Terminal { args, progress: &progress });
    progress.finish();
    let Diagnosed { robot, arm, diagnosis, effects } = study?;
    // From here on, Ctrl-C is deferred, so that no file is left incomplete.
    let deferred = interrupt::Deferred::start();
    let written = write(args, &arm, &robot, &diagnosis, effects);
    drop(deferred);
    print(args, &arm, &diagnosis, &written)?;
    written.files.finish()?;
    let Report { verdict, findings, not_diagnosed, .. } = &diagnosis.report;
    let explains = *verdict == Verdict::NoMismatch && findings.is_empty() && not_diagnosed.is_empty();
    Ok(if args.fail_on_mismatch && !explains { ExitCode::from(MISMATCH) } else { ExitCode::SUCCESS })
}

/// Prints progress and notes on standard error.
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
            self.progress.suspend(|| output::say(format_args!("note: {text}")));
        }
    }

    fn recordings(&self, notes: &Notes) {
        if self.args.quiet {
            return;
        }
        for line in notes.lines(!self.args.verbose) {
            self.progress.suspend(|| output::say(&line));
        }
    }
}

/// Prints the result and the files written. If JSON is printed on standard output, nothing else is.
fn print(args: &DiagnoseArgs, arm: &Arm, diagnosis: &Diagnosis, written: &Files<'_>) -> anyhow::Result<()> {
    let report = &diagnosis.report;
    if args.prints_json() {
        output::print(&(serde_json::to_string_pretty(report)? + "\n"))?;
    } else if args.verbose {
        output::print(&report::terminal::complete(report, arm))?;
    } else if !args.quiet {
        output::print(&report::terminal::diagnosis(report))?;
    }
    let say = |text: String| output::print_beside(args.json.as_deref(), &text);
    for output in args.outputs() {
        written.files.line(output.path).map_or(Ok(()), say)?;
    }
    if args.quiet {
        return Ok(());
    }
    for (path, omitted) in &written.omitted {
        say(format!("not in {}:\n  {}\n", path.display(), omitted.join("\n  ")))?;
    }
    if [&args.model, &args.urdf, &args.mjcf].into_iter().any(Option::is_some) {
        for note in report::left_out::notes(report) {
            say(report::terminal::wrapped(&note, ""))?;
        }
    }
    if let Some(path) = written.removed {
        say(format!("removed: {} of an earlier diagnosis, because this one proposes no motion\n", path.display()))?;
    }
    Ok(())
}

/// The outcome of writing the files.
#[derive(Default)]
struct Files<'a> {
    /// The files written, and the errors of the others.
    files: Written,
    /// What a format cannot hold, by its file.
    omitted: Vec<(&'a Path, Vec<String>)>,
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
) -> Files<'a> {
    let mut written = Files::default();
    if diagnosis.report.verdict == Verdict::UnitsFirst {
        return write_doubts(args, arm, diagnosis);
    }
    let urdf = |_| urdf_file::corrected_urdf(&robot.text, arm, &effects);
    let mjcf = |_| mjcf_file::mjcf(arm, &effects);
    let exports = [(&args.urdf, args.urdf.as_ref().map(urdf)), (&args.mjcf, args.mjcf.as_ref().map(mjcf))];
    for (path, export) in exports {
        let (Some(path), Some(export)) = (path, export) else {
            continue;
        };
        let omitted = &mut written.omitted;
        written.files.add(path, || {
            let export = export?;
            output::write_text(path, &export.text)?;
            if !export.omitted.is_empty() {
                omitted.push((path, export.omitted));
            }
            Ok(())
        });
    }
    let files = &mut written.files;
    if let Some(path) = &args.model {
        let robot = Some(arm.name().to_owned());
        files.add(path, || EffectFile { robot, effects }.write(path));
    }
    if let Some(path) = &args.next {
        match (&diagnosis.next, &diagnosis.report.next_experiment) {
            (Some(motion), Some(next)) => {
                files.add(path, || next_file::write(path, &args.robot, &robot.path, arm, next, motion));
            }
            _ => match next_file::remove_earlier(path) {
                Ok(removed) => written.removed = removed.then_some(path.as_path()),
                Err(error) => files.add(path, || Err(error)),
            },
        }
    }
    if let Some(path) = &args.trace {
        files.add(path, || trace_file::write(path, &diagnosis.trace));
    }
    if let Some(path) = &args.residuals {
        files.add(path, || residuals_file::write(path, arm, &diagnosis.traces));
    }
    write_reports(args, arm, diagnosis, files);
    let shown = || show(args, arm, &robot.path, diagnosis);
    match args.rerun_file() {
        Some(path) => files.add(path, shown),
        None => files.attempt(shown),
    }
    written
}

/// Writes the report as page, Markdown and JSON, as far as they are requested.
fn write_reports(args: &DiagnoseArgs, arm: &Arm, diagnosis: &Diagnosis, files: &mut Written) {
    if let Some(path) = &args.report {
        let page = || report::page(&diagnosis.report, &diagnosis.traces, arm);
        files.add(path, || output::write_text(path, &page()));
    }
    if let Some(path) = &args.markdown {
        let text = || report::diagnosis_markdown(&diagnosis.report, arm);
        files.add(path, || output::write_text(path, &text()));
    }
    if let Some(path) = args.json_file() {
        files.add(path, || output::write_json(path, &diagnosis.report));
    }
}

/// Writes the report if units, signs, order or zeros must be corrected first. There is neither a model nor a residual then,
/// so that a request for one is an error.
fn write_doubts<'a>(args: &'a DiagnoseArgs, arm: &Arm, diagnosis: &Diagnosis) -> Files<'a> {
    let mut written = Files::default();
    write_reports(args, arm, diagnosis, &mut written.files);
    let of_a_search = [&args.model, &args.urdf, &args.mjcf, &args.next, &args.trace, &args.residuals];
    let asked = of_a_search.into_iter().flatten().map(PathBuf::as_path);
    for path in asked.chain(args.rerun_file()) {
        written.files.add(path, || {
            bail!(
                "{}: not written, because no effect was searched: correct the recordings' units, signs, order or zeros first",
                path.display()
            )
        });
    }
    written
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
