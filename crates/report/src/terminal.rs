//! Text for the terminal: tables, and the diagnosis with its verdict, findings, unexplained residuals and next experiment.

use std::collections::BTreeMap;
use std::fmt::Write;

use arm::{Arm, JointKind};
use comfy_table::{CellAlignment, LineStyle, Table, presets};
use diagnosis::statistics::rms;
use diagnosis::{Finding, Located, NotObservable, Report, Unexplained};

use crate::doubts::Certainty;
use crate::{alternatives, differences, doubts, next_words, not_diagnosed, numbers, regions, words};

mod findings;
pub(crate) mod steps;

/// The width of lines in characters; a single longer word exceeds it.
const WIDTH: usize = 80;

/// A table with a left-aligned first column and right-aligned numbers.
pub fn table(header: impl IntoIterator<Item = String>) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    table.set_header(header.into_iter().collect::<Vec<_>>());
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_cell_alignment(if index == 0 { CellAlignment::Left } else { CellAlignment::Right });
    }
    table
}

/// `table` with less space between its columns if its lines are too long otherwise.
pub fn fitted(mut table: Table) -> Table {
    for padding in [(0, 1), (0, 0)] {
        let width = table.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        if width <= WIDTH {
            break;
        }
        for column in table.column_iter_mut() {
            column.set_padding(padding);
        }
    }
    table
}

/// The largest number of next steps in the short text.
const STEPS: usize = 3;

/// The result of a diagnosis on one screen: verdict, table, next steps; it ends with a newline.
pub fn diagnosis(report: &Report) -> String {
    let mut text = opening(report);
    let steps = steps::of(report);
    for step in steps.iter().take(STEPS) {
        text += &wrapped(step, "- ");
    }
    if steps.len() > STEPS {
        text += &wrapped(&format!("{} more with --verbose", steps.len() - STEPS), "- ");
    }
    text
}

/// The complete text of a diagnosis: with the findings' further parameters and alternatives, effects that are not testable, and
/// the simulated motion; it ends with a newline.
pub fn complete(report: &Report, arm: &Arm) -> String {
    let mut text = opening(report);
    for finding in &report.findings {
        text += &details(finding);
    }
    for open in &report.unexplained {
        text += &wrapped(&format!("{}: {}", open.joint, unexplained(report, open)), "- ");
        if let Some(place) = largest(report, open, Some(arm)) {
            text += &wrapped(&place, "    ");
        }
        if !open.next.is_empty() {
            text += &wrapped(&format!("next experiment: {}", open.next), "    ");
        }
    }
    for reason in &report.not_enough_data {
        text += &wrapped(&format!("not enough data: {reason}"), "- ");
    }
    if !report.not_observable.is_empty() {
        let list = not_testable(&report.not_observable);
        text += &wrapped(&format!("not testable with these recordings: {list}"), "- ");
    }
    for sentence in report.next_experiment.iter().flat_map(next_words::sentences) {
        text += &wrapped(&sentence, "- next experiment: ");
    }
    let rollout = rollout(report, arm);
    if !rollout.is_empty() {
        text += &wrapped(&rollout, "- ");
    }
    text
}

/// The changes, the verdict, and the table.
fn opening(report: &Report) -> String {
    let changed = words::changed(report).map(|text| wrapped(&text, ""));
    let mut text = changed.unwrap_or_default();
    for sentence in [differences::different_load(report), differences::held_out_friction(report)].into_iter().flatten()
    {
        text += &wrapped(&sentence, "");
        text.push('\n');
    }
    text += &wrapped(&words::verdict(report), "");
    for reason in not_diagnosed::reasons(report, str::to_owned) {
        text += &wrapped(&reason, "- ");
    }
    for group in doubts::groups(&report.doubts, Certainty::Certain, report) {
        for sentence in &group.texts {
            text += &wrapped(sentence, "- ");
        }
        if let Some(map) = group.map {
            let _ = write!(text, "\n{}\n{map}\n", wrapped(&group.usage.replace('`', ""), ""));
        }
    }
    if !report.findings.is_empty() {
        let _ = writeln!(text, "\n{}\n", findings::table(report));
        text += &wrapped(&findings::columns(report), "");
        text.push('\n');
    }
    text
}

/// The diagnosis without the table, as Markdown.
pub fn prose(report: &Report) -> String {
    let mut text = format!("**{}**\n\n", words::verdict(report));
    for finding in &report.findings {
        let _ = writeln!(text, "- {}", finding.sentence);
    }
    for open in &report.unexplained {
        let _ = writeln!(text, "- {}: {}. Next experiment: {}.", open.joint, unexplained(report, open), open.next);
    }
    for reason in not_diagnosed::reasons(report, str::to_owned) {
        let _ = writeln!(text, "- {reason}");
    }
    for reason in &report.not_enough_data {
        let _ = writeln!(text, "- not enough data: {reason}");
    }
    text
}

/// The size of an unexplained residual and what it depends on.
fn unexplained(report: &Report, open: &Unexplained) -> String {
    let size = numbers::of_torque_spread(open.share);
    let on: Vec<String> = open.depends_on.iter().map(words::dependence).collect();
    if on.is_empty() && report.is_requested {
        format!("unexplained residual {size}; other effects were not searched")
    } else if on.is_empty() {
        format!("unexplained residual {size}; no regressor that was tried predicts it")
    } else {
        format!("unexplained residual {size}; it depends on {}", words::list(&on))
    }
}

/// Where an unexplained residual is largest: stretches of time, and regions of the joint's state, whose units need the
/// `arm`. Regions are those of the nominal residual. They are given only if there are no findings, because otherwise a part
/// of that residual is explained.
pub fn largest(report: &Report, open: &Unexplained, arm: Option<&Arm>) -> Option<String> {
    let is_this = |located: &&Located| located.joint == open.joint;
    let located = report.located.iter().filter(|_| report.findings.is_empty()).find(is_this);
    let joint = arm.and_then(|arm| arm.joints().iter().find(|joint| joint.name == open.joint));
    let mut places: Vec<String> = match (located, joint) {
        (Some(located), Some(joint)) => located.regions.iter().map(|region| regions::region(region, joint)).collect(),
        _ => Vec::new(),
    };
    if !open.time.is_empty() {
        places.push(regions::windows(&open.time));
    }
    (!places.is_empty()).then(|| format!("largest: {}", places.join("; ")))
}

/// The further parameters and the alternatives of a finding, which the table does not show; empty if there are neither.
fn details(finding: &Finding) -> String {
    let place = finding.joint.as_deref().unwrap_or("whole arm");
    let start = format!("{place}, {}", words::effect(finding));
    let could_be = alternatives::with_experiment(finding);
    let sizes = effects::spec(finding.effect).map_or(0, |spec| spec.sentence.matches('{').count());
    let has_more = sizes > 1 || finding.parameters.contains_key("onset") || !finding.corrects;
    match (has_more, !alternatives::has_any(finding)) {
        (false, true) => String::new(),
        (false, false) => wrapped(&format!("{start}: {could_be}"), "- "),
        (true, is_alone) => {
            let mut text = wrapped(&format!("{start}: {}", words::described(finding)), "- ");
            if !is_alone {
                text += &wrapped(&could_be, "    ");
            }
            text
        }
    }
}

/// The recordings that errors belong to: the held-out ones, if there are any.
pub fn recordings(report: &Report) -> &'static str {
    if report.recordings.held_out.is_empty() { "training" } else { "held-out" }
}

/// The title of errors, which belong to the held-out recordings if there are any, and to the training recordings otherwise.
pub fn error_title(report: &Report) -> &'static str {
    if report.recordings.held_out.is_empty() { "training error" } else { "held-out error" }
}

/// The error of the joint on which the finding has its largest share, nominal and with the effects found.
pub fn error(report: &Report, finding: &Finding) -> String {
    words::shows_on(finding).map_or("–".into(), |joint| error_of(report, joint))
}

/// The error of a joint, nominal and with the effects found.
pub fn error_of(report: &Report, joint: &str) -> String {
    report.fit.get(joint).map_or("–".into(), |fit| {
        if report.recordings.held_out.is_empty() {
            numbers::before_after(Some(fit.train_nrmse_nominal), Some(fit.train_nrmse_augmented))
        } else {
            numbers::before_after(fit.held_out_nrmse_nominal, fit.held_out_nrmse_augmented)
        }
    })
}

/// `backlash on 3 joints; torque scale on elbow`.
fn not_testable(list: &[NotObservable]) -> String {
    let mut by_effect: BTreeMap<&'static str, Vec<&NotObservable>> = BTreeMap::new();
    for entry in list {
        by_effect.entry(entry.effect).or_default().push(entry);
    }
    let parts = by_effect.into_iter().map(|(effect, entries)| {
        let name = words::wording(effect).name;
        match entries.as_slice() {
            [one] => match &one.joint {
                Some(joint) => format!("{name} on {joint}"),
                None => name.to_owned(),
            },
            several => format!("{name} on {} joints", several.len()),
        }
    });
    parts.collect::<Vec<_>>().join("; ")
}

/// How closely the simulated arm follows the recording, with the nominal model and with the effects found.
fn rollout(report: &Report, arm: &Arm) -> String {
    let of_kind = |kind: JointKind, unit: &str| {
        let joints = arm.joints().iter().filter(|joint| joint.kind == kind);
        let errors: Vec<_> = joints.filter_map(|joint| report.rollout.get(&joint.name)).collect();
        let before = rms(errors.iter().map(|joint| joint.nominal_rms_rad))?;
        let after = rms(errors.iter().map(|joint| joint.augmented_rms_rad))?;
        let [before, after] = [before, after].map(|error| numbers::short(1e3 * error));
        Some(format!("{before} → {after} {unit}"))
    };
    let kinds = [(JointKind::Revolute, "mrad"), (JointKind::Prismatic, "mm")];
    let errors: Vec<String> = kinds.into_iter().filter_map(|(kind, unit)| of_kind(kind, unit)).collect();
    match errors.as_slice() {
        [] => String::new(),
        errors => format!("simulated motion, RMS position error over the joints: {}", words::list(errors)),
    }
}

/// Breaks `text` between words; the first line begins with `start`, the others have the same indent. It ends with a newline.
pub fn wrapped(text: &str, start: &str) -> String {
    let indent = " ".repeat(start.chars().count());
    let mut lines = String::new();
    let mut line = start.to_owned();
    let mut is_fresh = true;
    for word in text.split_whitespace() {
        let width = line.chars().count() + usize::from(!is_fresh) + word.chars().count();
        if !is_fresh && width > WIDTH {
            lines += &line;
            lines.push('\n');
            line.clone_from(&indent);
            is_fresh = true;
        }
        if !is_fresh {
            line.push(' ');
        }
        line += word;
        is_fresh = false;
    }
    lines + &line + "\n"
}
