//! The findings as a table.

use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Width};
use diagnosis::{Finding, Report, Unexplained};

use super::steps::by_size;
use super::{WIDTH, error, error_of, recordings};
use crate::{numbers, sizes, words};

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
    let is_past = |finding: &Finding| !finding.acts_today();
    let before = if report.findings.iter().any(is_past) {
        "; (before) and (decrease): in the recordings from before only"
    } else {
        ""
    };
    let unexplained = match (report.unexplained.is_empty(), report.recordings.before.is_empty()) {
        (true, _) => "",
        (false, true) => "; unexplained: the residual on the recordings, training or held-out, on which it is larger",
        (false, false) => {
            "; unexplained: the residual on the recordings, those from before with the training ones, or held-out, on which it is larger"
        }
    };
    format!(
        "share and error are relative to the standard deviation of the measured torque; share: standard deviation of the \
         effect's torque; error: RMS torque error on the {recordings} recordings, nominal model → with the effects found{undetermined}{without_share}{before}{unexplained}"
    )
}

/// What an unexplained residual is called.
const UNEXPLAINED: &str = "unexplained";

/// The row of an unexplained residual, with the cells of its joint and of the joint's error.
fn residual(open: &Unexplained, [joint, error]: [String; 2]) -> [String; 5] {
    let size = numbers::share(open.share);
    [joint, UNEXPLAINED.to_owned(), "–".to_owned(), size, error]
}

/// The findings by joint, the joint with the largest share first, each with the joint's unexplained residual; then the joints of which
/// only a residual is known.
pub fn table(report: &Report) -> String {
    let mut table = super::table(["joint", "effect", "size", "share", "error"].map(str::to_owned));
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(WIDTH as u16);
    let effects = report.findings.iter().map(effect).chain(report.unexplained.iter().map(|_| UNEXPLAINED.to_owned()));
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
            table.add_row([
                if is_first { words::joint(joint).to_owned() } else { String::new() },
                effect(finding),
                sizes::cell(finding, "\n"),
                words::share(finding).map_or_else(|| "–".into(), numbers::share),
                if is_first || joint.is_none() { error(report, finding) } else { String::new() },
            ]);
        }
        let open = report.unexplained.iter().find(|open| Some(open.joint.as_str()) == joint);
        if let Some(open) = open {
            table.add_row(residual(open, [String::new(), String::new()]));
        }
    }
    for open in by_size(report) {
        let has_finding = |finding: &Finding| finding.joint.as_ref() == Some(&open.joint);
        if !report.findings.iter().any(has_finding) {
            table.add_row(residual(open, [open.joint.clone(), error_of(report, &open.joint)]));
        }
    }
    table.to_string().lines().map(str::trim_end).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use diagnosis::{Diagnosis, Parameter, RecordingNames, Unexplained};
    use effects::Effect;
    use effects::drive::TRANSMISSION_COUPLING;
    use effects::friction::COULOMB_FRICTION;

    use super::*;

    #[test]
    fn a_size_that_may_be_zero_is_explained() {
        let mut report = Diagnosis::units_first("arm", RecordingNames::default(), Vec::new()).report;
        let mut finding = Finding::of(Effect::of(&COULOMB_FRICTION).on("a".to_owned()));
        let level = |low: f64| Parameter { value: 0.1, ci95: [low, 0.4], unit: "N m" };
        finding.parameters.insert("level", level(0.05));
        report.findings = vec![finding.clone()];
        assert!(!columns(&report).contains("do not determine the size"));
        finding.parameters.insert("level", level(-0.2));
        report.findings.push(finding);
        assert!(columns(&report).contains("do not determine the size"));
    }

    #[test]
    fn residuals_and_the_other_joint_of_a_coupling_are_shown() {
        let mut report = Diagnosis::units_first("arm", RecordingNames::default(), Vec::new()).report;
        let mut coupling = Finding::of(Effect::of(&TRANSMISSION_COUPLING).on("a".to_owned()));
        coupling.other = Some("b".to_owned());
        report.findings = vec![coupling];
        let residual = |joint: &str| Unexplained {
            joint: joint.to_owned(),
            share: 0.43,
            depends_on: Vec::new(),
            time: Vec::new(),
            next: String::new(),
        };
        report.unexplained = vec![residual("a"), residual("c")];
        let shown = table(&report);
        assert!(shown.contains("transmission coupling with b"), "{shown}");
        let rows: Vec<&str> = shown.lines().filter(|line| line.contains("unexplained")).collect();
        assert!(
            matches!(rows[..], [own, alone] if own.starts_with("  ") && alone.starts_with("c ") && alone.contains("43 %")),
            "{shown}"
        );
    }
}
