//! `testbed inspect FILE…`: the quality of recordings, before anything is fitted to them.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use arm::{Arm, JointKind};
use effects::Quantity;
use recording::{ColumnMap, Quality, Recording, Warning};
use report::doubts::{self, Certainty};
use serde::Serialize;
use study::check::{MisfitKind, turns};
use study::notes::shortened;
use study::placeholders::{Replaced, replaced};
use study::robot::{self, RobotFile};
use study::{check, inputs, named};

use crate::cli::InspectArgs;
use crate::output::{self, OutputFile};
use crate::written::Written;

/// What `--json` holds.
#[derive(Serialize)]
struct Inspection<'a> {
    schema: &'static str,
    robot: Option<&'a str>,
    files: Vec<FileInspection<'a>>,
}

/// One recording.
#[derive(Serialize)]
struct FileInspection<'a> {
    file: &'a Path,
    #[serde(flatten)]
    quality: Quality,
    /// The contradictions with the robot's URDF.
    against_robot: Vec<check::Misfit>,
    /// The column map (TOML) that corrects them.
    column_map: Option<String>,
    warnings: Vec<Shown>,
}

/// A warning with its sentence.
#[derive(Serialize)]
struct Shown {
    text: String,
    #[serde(flatten)]
    warning: Warning,
}

/// Inspects the recordings that `args` name.
///
/// # Errors
/// If the robot or the map cannot be read, an output cannot be written, or a recording is unreadable; the other recordings
/// are inspected nevertheless.
pub fn run(args: &InspectArgs) -> anyhow::Result<()> {
    if let Some(path) = &args.json {
        output::check_writable(path)?;
        let inputs = args.files.iter().chain(&args.map).map(PathBuf::as_path);
        output::check_is_no_input(path, inputs.chain(args.robot.as_deref().map(Path::new)))?;
        OutputFile::json(path, "\"schema\": \"testbed.inspect/").check()?;
    }
    let robot = args.robot.as_deref().map(robot::named_robot).transpose()?;
    let map = args.map.as_deref().map(ColumnMap::load).transpose()?;
    let arm = robot.map(|robot| load_arm(args, &robot, map.as_ref())).transpose()?;
    let mut files = Vec::new();
    for file in &args.files {
        let inspection = match inspect(file, map.as_ref(), arm.as_ref()) {
            Ok(inspection) => inspection,
            Err(error) => {
                output::say(format_args!("error: {error:#}"));
                continue;
            }
        };
        output::print_beside(args.json.as_deref(), &shown(&inspection, arm.as_ref()))?;
        files.push(inspection);
    }
    if files.len() < args.files.len() {
        let unread = args.files.len() - files.len();
        bail!("{unread} of {} recordings cannot be used", args.files.len());
    }
    if let Some(path) = &args.json {
        let inspection = Inspection { schema: "testbed.inspect/1", robot: arm.as_ref().map(Arm::name), files };
        let mut written = Written::default();
        written.add(path, || output::write_json(path, &inspection));
        output::print_beside(Some(path), &written.lines())?;
        written.finish()?;
    }
    Ok(())
}

/// The arm among the robot's joints that the first readable recording holds.
fn load_arm(args: &InspectArgs, robot: &RobotFile, map: Option<&ColumnMap>) -> anyhow::Result<Arm> {
    let mut readable = args.files.iter().filter_map(|file| Recording::read_with(file, map).ok());
    let first = readable.next().unwrap_or_default();
    let mut arm = robot.arm(&args.chain.options(named::named_joints(&first))).context("--robot")?;
    for warning in arm.warnings() {
        output::say(format_args!("note: {}: {warning}", robot.path.display()));
    }
    if let Some(Replaced { arm: other, remark, .. }) = replaced(&arm, &[]) {
        output::say(format_args!("note: {}: {remark}", robot.path.display()));
        arm = other;
    }
    for doubt in arm.doubtful_units() {
        output::say(format_args!("warning: {}: {doubt}", robot.path.display()));
    }
    Ok(arm)
}

fn inspect<'a>(file: &'a Path, map: Option<&ColumnMap>, arm: Option<&Arm>) -> anyhow::Result<FileInspection<'a>> {
    let mut recording = named::read(file, map, arm)?;
    let moved = arm.map_or(Vec::new(), |arm| turns::into_limits(&mut recording, arm));
    let (regular, found) = recording.regular().with_context(|| file.display().to_string())?;
    let quality = Quality::of(&recording, &regular);
    let (mut against_robot, mut column_map) = (Vec::new(), None);
    if let Some(arm) = arm {
        let checked = check::check(arm, &regular, &quality);
        column_map = check::column_map(arm, &checked.misfits, &recording);
        let moved = moved
            .into_iter()
            .map(|(joint, text)| check::Misfit::new(MisfitKind::Turns, Some(&joint), text, Vec::new()));
        against_robot = moved.chain(checked.misfits).collect();
        let in_order = inputs::in_order_of(arm, regular);
        if checked.has_model_units
            && let Some(in_order) = in_order
            && let Some(proposed) = check::proposal(arm, &[], &[&in_order])
        {
            column_map = check::Layout::of(&recording).map(&proposed.changes).or(column_map);
            let misfit =
                check::Misfit::new(MisfitKind::Columns, proposed.joint.as_deref(), proposed.text, proposed.changes);
            against_robot.push(check::Misfit { prevents_diagnosis: proposed.is_certain, ..misfit });
        }
    }
    let warnings = recording.warnings.iter().cloned().chain(found);
    Ok(FileInspection {
        file,
        quality,
        against_robot,
        column_map,
        warnings: warnings.map(|warning| Shown { text: warning.to_string(), warning }).collect(),
    })
}

fn shown(inspection: &FileInspection<'_>, arm: Option<&Arm>) -> String {
    let mut text = String::new();
    let quality = &inspection.quality;
    let clock = if !quality.has_clock {
        "no regular clock".into()
    } else if quality.jitter_rms < 1e-3 / quality.rate {
        "regular clock".to_owned()
    } else {
        format!("time stamps deviate by {:.1} % of a period", 100.0 * quality.jitter_rms * quality.rate)
    };
    let _ = writeln!(
        text,
        "{}: {} joints, {} rows, {:.2} s at {} Hz, {clock}",
        inspection.file.display(),
        quality.joints.len(),
        quality.rows,
        quality.duration,
        rounded(quality.rate)
    );
    let [position, torque] = [Quantity::Position, Quantity::Torque].map(|of| unit(of, quality, arm));
    let header = [
        "joint".to_owned(),
        format!("position\n({position})"),
        format!("speed\n({}/s)", position.replace(", ", "/s, ")),
        "in\nmotion".to_owned(),
        "reversals".to_owned(),
        format!("torque\n({torque})"),
        "encoder\nstep".to_owned(),
        "velocity\ndelay".to_owned(),
    ];
    let mut table = report::terminal::table(header);
    for column in table.column_iter_mut() {
        column.set_padding((0, 1));
    }
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "–".to_owned());
    for joint in &quality.joints {
        table.add_row([
            joint.joint.clone(),
            span(joint.q_range),
            rounded(joint.speed_max),
            if joint.moves { format!("{:.0} %", 100.0 * joint.moving_share) } else { "no".into() },
            joint.reversals.to_string(),
            span(joint.tau_range),
            or_dash(joint.q_step.map(rounded)),
            or_dash(joint.velocity_lag.map(|lag| {
                // No minus before a zero.
                let tenths = (1e4 * lag).round() + 0.0;
                format!("{:.1} ms", tenths / 10.0)
            })),
        ]);
    }
    let _ = writeln!(text, "{}", report::terminal::fitted(table));
    let (shown, gaps) = shortened(inspection.warnings.iter(), |shown| &shown.warning);
    for shown in shown {
        let _ = writeln!(text, "- {}", shown.text);
    }
    if gaps > 0 {
        let _ = writeln!(text, "- further gaps: {gaps} (--json lists them)");
    }
    for finding in &quality.findings {
        let _ = writeln!(text, "- {}{}", about(finding.joint.as_deref()), finding.text);
    }
    for misfit in &inspection.against_robot {
        let _ = writeln!(text, "- {}{}", about(misfit.joint.as_deref()), misfit.text);
    }
    if let Some(map) = &inspection.column_map {
        let is_certain = |misfit: &check::Misfit| misfit.prevents_diagnosis && !misfit.changes.is_empty();
        let certainty = match inspection.against_robot.iter().any(is_certain) {
            true => Certainty::Certain,
            false => Certainty::Possible,
        };
        let _ = write!(text, "- a {} (--map):\n{map}", doubts::of_a_map(certainty));
    }
    if inspection.warnings.is_empty() && quality.findings.is_empty() && inspection.against_robot.is_empty() {
        let _ = writeln!(text, "- no remarks");
    }
    let _ = writeln!(text);
    text
}

/// The unit of a quantity of all joints in the table: that of their kind, or both units where they are of both kinds or not known.
fn unit(of: Quantity, quality: &Quality, arm: Option<&Arm>) -> String {
    let kind = |name: &String| {
        let moving = arm?.joints().iter().map(|joint| (&joint.name, joint.kind));
        let fixed = arm?.fixed_joints().iter().map(|joint| (&joint.name, joint.kind));
        moving.chain(fixed).find(|(known, _)| *known == name).map(|(_, kind)| kind)
    };
    let is_all = |wanted: JointKind| quality.joints.iter().all(|joint| kind(&joint.joint) == Some(wanted));
    let [turning, sliding] = [JointKind::Revolute, JointKind::Prismatic].map(|kind| (is_all(kind), of.unit(kind)));
    match (turning, sliding) {
        ((true, unit), _) | (_, (true, unit)) => unit.to_owned(),
        ((_, turning), (_, sliding)) => format!("{turning}, {sliding}"),
    }
}

fn about(joint: Option<&str>) -> String {
    joint.map_or_else(String::new, |joint| format!("{joint}: "))
}

fn span((low, high): (f64, f64)) -> String {
    let size = low.abs().max(high.abs());
    let short = |value: f64| rounded(if value.abs() < 2e-3 * size { 0.0 } else { value });
    if high - low < 2e-3 * size { short(high) } else { format!("{} … {}", short(low), short(high)) }
}

/// Three significant digits, for narrow tables.
fn rounded(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        "0".into()
    } else if (1e-3..1e5).contains(&magnitude) {
        let decimals = (2 - magnitude.log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases =
            [(250.0, "250"), (0.1234, "0.123"), (-1570.72, "-1571"), (5e-5, "5.0e-5"), (0.5, "0.5"), (1e3, "1000")];
        for (value, text) in cases {
            assert_eq!(rounded(value), text);
        }
    }
}
