//! The findings as a table.

use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Width};
use diagnosis::{Finding, Report};

use super::{WIDTH, error, error_of, recordings};
use crate::{numbers, words};

/// The title of a finding's effect, with the other joint of a coupling.
fn effect(finding: &Finding) -> String {
    let effect = words::effect(finding);
    match &finding.other {
        Some(other) => format!("{effect} with {other}"),
        None => effect,
    }
}

/// The explanation of the table's columns.
pub fn columns(report: &Report) -> String {
    let recordings = recordings(report);
    let undetermined = if report.findings.iter().any(diagnosis::is_undetermined) {
        "; where the interval of a size holds the value without effect (0, or × 1), these recordings do not determine the size"
    } else {
        ""
    };
    let without_share = if report.findings.iter().any(|finding| words::share(finding).is_none()) {
        "; an effect between two sensors of a joint has no share"
    } else {
        ""
    };
    format!(
        "share and error are relative to the standard deviation of the measured torque; share: standard deviation of the \
         effect's torque; error: RMS torque error on the {recordings} recordings, nominal model → with the effects found{undetermined}{without_share}"
    )
}

/// The findings by joint, the joint with the largest share first, and the joints of which only a residual is known.
pub fn table(report: &Report) -> String {
    let mut table = super::table(["joint", "effect", "size", "share", "error"].map(str::to_owned));
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(WIDTH as u16);
    let effects = report.findings.iter().map(effect);
    let words = effects.flat_map(|effect| effect.split(' ').map(|word| word.chars().count()).max());
    let longest = words.max().map_or(0, |length| length + 1) as u16;
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, if index == 4 { 0 } else { 1 }));
        if index < 3 {
            column.set_cell_alignment(CellAlignment::Left);
        }
        // Only the column of effects is wrapped. It is at least as wide as its longest word, because a narrower column
        // would break the word.
        column.set_constraint(if index == 1 {
            ColumnConstraint::LowerBoundary(Width::Fixed(longest))
        } else {
            ColumnConstraint::ContentWidth
        });
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
                effect(finding),
                size.map_or("–".into(), |(name, parameter)| {
                    numbers::with_interval(name, parameter)
                }),
                words::share(finding).map_or_else(|| "–".into(), numbers::share),
                if is_first || joint.is_none() {
                    error(report, finding)
                } else {
                    String::new()
                },
            ]);
        }
    }
    for open in &report.unexplained {
        if report
            .findings
            .iter()
            .any(|finding| finding.joint.as_ref() == Some(&open.joint))
        {
            continue;
        }
        table.add_row([
            open.joint.clone(),
            "unexplained".to_owned(),
            "–".to_owned(),
            numbers::share(open.share),
            error_of(report, &open.joint),
        ]);
    }
    table
        .to_string()
        .lines()
        .map(str::trim_end)
        .collect::<Vec<_>>()
        .join("\n")
}
