//! Tables on the terminal, and the diagnosis there: the verdict, a short table, a sentence a finding, and what is left.

use std::collections::BTreeMap;
use std::fmt::Write;

use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, Table, presets};
use diagnosis::{Finding, NotObservable, Report};

use crate::statistics::rms;
use crate::{next_words, numbers, words};

/// The widest that lines are where nothing forces them to be wider.
const WIDTH: usize = 80;

/// A table with its first column at the left and numbers at the right.
pub fn table(header: impl IntoIterator<Item = String>) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    table.set_header(header.into_iter().collect::<Vec<_>>());
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_cell_alignment(if index == 0 {
            CellAlignment::Left
        } else {
            CellAlignment::Right
        });
    }
    table
}

/// Everything that is printed at the end of a diagnosis; ends with a newline.
pub fn diagnosis(report: &Report) -> String {
    let mut text = wrapped(&words::verdict(report), "");
    if !report.findings.is_empty() {
        let _ = writeln!(text, "\n{}\n", findings(report));
        for finding in &report.findings {
            text += &wrapped(&finding.sentence, "- ");
            if !finding.confusable_with.is_empty() {
                text += &wrapped(&format!("could also be {}", alternatives(finding)), "    ");
            }
        }
    }
    for left in &report.unexplained {
        let on: Vec<String> = left.depends_on.iter().map(|code| words::dependence(code)).collect();
        let depends = if on.is_empty() {
            "nothing tried predicts it".to_owned()
        } else {
            format!("it depends on {}", words::list(&on))
        };
        let share = numbers::percent(left.share);
        text += &wrapped(
            &format!("{}: {share} of its torque has no name; {depends}", left.joint),
            "- ",
        );
        if !left.next.is_empty() {
            text += &wrapped(&format!("next: {}", left.next), "    ");
        }
    }
    for reason in &report.not_enough_data {
        text += &wrapped(&format!("not enough data: {reason}"), "- ");
    }
    if !report.not_observable.is_empty() {
        text += &wrapped(&format!("could not be seen: {}", unseen(&report.not_observable)), "- ");
    }
    for sentence in report.next_experiment.iter().flat_map(next_words::sentences) {
        text += &wrapped(&sentence, "- next: ");
    }
    let rollout = rollout(report);
    if !rollout.is_empty() {
        text += &wrapped(&rollout, "- ");
    }
    text
}

/// The diagnosis without the table, as Markdown.
pub fn prose(report: &Report) -> String {
    let mut text = format!("**{}**\n\n", words::verdict(report));
    for finding in &report.findings {
        let _ = writeln!(text, "- {}", finding.sentence);
    }
    for left in &report.unexplained {
        let share = numbers::percent(left.share);
        let _ = writeln!(
            text,
            "- {}: {share} of its torque has no name. {}",
            left.joint, left.next
        );
    }
    for reason in &report.not_enough_data {
        let _ = writeln!(text, "- not enough data: {reason}");
    }
    text
}

/// A finding's alternatives: `payload, or asymmetric friction on joint_2`.
pub fn alternatives(finding: &Finding) -> String {
    let alternatives = finding.confusable_with.iter().map(|other| {
        let name = words::wording(other.effect).name;
        match &other.joint {
            Some(joint) if Some(joint) != finding.joint.as_ref() => format!("{name} on {joint}"),
            _ => name.to_owned(),
        }
    });
    alternatives.collect::<Vec<_>>().join(", or ")
}

/// The findings by joint, the joint with the largest share first.
fn findings(report: &Report) -> String {
    let mut table = table(["joint", "cause", "size", "share", "held out"].map(str::to_owned));
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(WIDTH as u16);
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, if index == 4 { 0 } else { 2 }));
        if index < 3 {
            column.set_cell_alignment(CellAlignment::Left);
        }
        if index != 1 {
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
    }
    let mut by_joint: Vec<(Option<&str>, Vec<&Finding>)> = Vec::new();
    for finding in &report.findings {
        let joint = finding.joint.as_deref();
        match by_joint.iter_mut().find(|(known, _)| *known == joint) {
            Some((_, list)) => list.push(finding),
            None => by_joint.push((joint, vec![finding])),
        }
    }
    for (joint, list) in by_joint {
        for (index, finding) in list.into_iter().enumerate() {
            let is_first = index == 0;
            let size = words::main_parameter(finding);
            table.add_row([
                if is_first {
                    words::joint(joint).to_owned()
                } else {
                    String::new()
                },
                words::cause(finding),
                size.map_or("–".into(), |(name, parameter)| {
                    numbers::with_interval(name, parameter)
                }),
                numbers::percent(finding.share),
                if is_first || joint.is_none() {
                    held_out(report, finding)
                } else {
                    String::new()
                },
            ]);
        }
    }
    table
        .to_string()
        .lines()
        .map(str::trim_end)
        .collect::<Vec<_>>()
        .join("\n")
}

/// The error of the joint where the finding shows most, before and after.
pub fn held_out(report: &Report, finding: &Finding) -> String {
    let fit = words::shows_on(finding).and_then(|joint| report.fit.get(joint));
    fit.map_or("–".into(), |fit| {
        numbers::before_after(fit.held_out_nrmse_nominal, fit.held_out_nrmse_augmented)
    })
}

/// `backlash (3 joints, above .3 to .9 mrad); …`
fn unseen(list: &[NotObservable]) -> String {
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

/// How the simulated arm follows, where the named effects change most.
fn rollout(report: &Report) -> String {
    let over_joints =
        |pick: fn(&diagnosis::JointRollout) -> f64| rms(report.rollout.values().map(pick)).map(|rms| 1e3 * rms);
    let errors = over_joints(|joint| joint.nominal_rms_rad).zip(over_joints(|joint| joint.augmented_rms_rad));
    let Some((before, after)) = errors else {
        return String::new();
    };
    format!(
        "simulated against recorded motion, RMS over the joints: {} → {} mrad (or mm)",
        numbers::short(before),
        numbers::short(after)
    )
}

/// Breaks `text` between words; the first line begins with `start`, the others are indented as far.
fn wrapped(text: &str, start: &str) -> String {
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
