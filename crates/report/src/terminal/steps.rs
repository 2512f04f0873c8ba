//! The next steps after a diagnosis, the most important first.

use diagnosis::{Dependence, Report, Unexplained, Verdict};
use effects::Regressor;

use super::{largest, unexplained};
use crate::{alternatives, next_words, words};

/// The next steps, in sentences: missing data, unexplained residuals, the proposed motion, findings with alternatives.
pub fn of(report: &Report) -> Vec<String> {
    let mut steps: Vec<String> =
        report.not_enough_data.iter().map(|reason| format!("not enough data: {reason}")).collect();
    let is_searched = !matches!(report.verdict, Verdict::NotEnoughData | Verdict::UnitsFirst);
    if report.recordings.held_out.is_empty() && is_searched {
        steps.push("validate the fit with a recording of another motion (--held-out)".to_owned());
    }
    steps.extend(residuals(report));
    steps.extend(experiments(report));
    steps
}

/// What distinguishes the findings from their alternatives: the proposed motion, or an experiment for each finding.
pub fn experiments(report: &Report) -> Vec<String> {
    match &report.next_experiment {
        Some(next) => {
            let sentences = next_words::sentences(next);
            let said = sentences.iter().map(|sentence| format!("next experiment: {sentence}"));
            said.collect()
        }
        None => ambiguous(report),
    }
}

/// The unexplained residuals, the largest first.
pub fn by_size(report: &Report) -> Vec<&Unexplained> {
    let mut list: Vec<&Unexplained> = report.unexplained.iter().collect();
    list.sort_by(|a, b| b.share.total_cmp(&a.share));
    list
}

/// The joints with unexplained residuals, those with the same next experiment together; the largest residual first.
fn residuals(report: &Report) -> Vec<String> {
    let mut groups: Vec<Vec<&Unexplained>> = Vec::new();
    for open in by_size(report) {
        match groups.iter_mut().find(|group| group[0].next == open.next) {
            Some(group) => group.push(open),
            None => groups.push(vec![open]),
        }
    }
    let said = groups.iter().map(|group| {
        let what = match group.as_slice() {
            [one] => {
                let place = largest(report, one, None).filter(|_| report.findings.is_empty());
                let place = place.map_or_else(String::new, |place| format!("; {place}"));
                format!("{}: {}{place}", one.joint, unexplained(report, one))
            }
            several => {
                let joints: Vec<String> = several.iter().map(|open| open.joint.clone()).collect();
                let on = several[0].depends_on.first();
                // What has a common experiment for another reason is about each joint alone.
                let common = [Regressor::BaseMotion, Regressor::Time, Regressor::ToolPosition, Regressor::ToolVelocity];
                let is_common = |on: &&Dependence| common.contains(&on.on);
                let on = on.filter(is_common).filter(|_| several.iter().all(|open| open.depends_on.first() == on));
                let on = on.map_or_else(String::new, |on| format!(" that depend on {}", words::dependence(on)));
                format!("{}: unexplained residuals{on}", words::list(&joints))
            }
        };
        match group[0].next.as_str() {
            "" => what,
            next => format!("{what}; next experiment: {next}"),
        }
    });
    said.collect()
}

/// The findings with alternatives, with the experiment that distinguishes them; joints with the same one are together.
fn ambiguous(report: &Report) -> Vec<String> {
    let mut groups: Vec<(String, String, Vec<String>)> = Vec::new();
    for finding in report.findings.iter().filter(|finding| alternatives::has_any(finding)) {
        let (place, effect) = (words::joint(finding.joint.as_deref()).to_owned(), words::effect(finding));
        let could_be = alternatives::with_experiment(finding);
        match groups.iter_mut().find(|(other, others, _)| *other == effect && *others == could_be) {
            Some((.., places)) if places.contains(&place) => {}
            Some((.., places)) => places.push(place),
            None => groups.push((effect, could_be, vec![place])),
        }
    }
    let said = groups.iter().map(|(effect, could_be, places)| format!("{}, {effect}: {could_be}", words::list(places)));
    said.collect()
}
