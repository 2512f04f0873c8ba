//! The outcome of the proposed experiments, as blocks of the report.

use std::collections::BTreeMap;

use scoring::{After, Confusion, Experiments, InCase};

use super::words::{counted, name};
use crate::block::{Block, table, text};

/// The section; empty if no finding has an alternative. `looked_at` is the number of cases that were examined.
pub fn experiments(experiments: &Experiments, looked_at: usize) -> Vec<Block> {
    if experiments.confusions.is_empty() {
        return Vec::new();
    }
    let head = [
        "named",
        "alternative",
        "confusions",
        "motion proposed",
        "recorded",
        "resolved",
        "same torque",
        "out of reach",
        "joint unexplained",
        "prediction fails",
    ];
    let mut list = vec![
        Block::Heading("The next experiment"),
        text(format!(
            "A confusion is a finding and one of its alternatives, where one of the two is injected. The diagnosis proposes one motion for all of its \
             confusions (`--next`). Of {looked_at} cases spread evenly over the campaign (or all, if there are fewer), the {} cases with a proposal for a confusion were \
             recorded again along that motion, within the URDF's limits, on the machine with the injected faults. The motion was scaled by 0.7 or 0.5 about its \
             middle where the position loop could not follow it. A new process then diagnosed that recording together with the earlier ones. A confusion is resolved if the \
             injected effect is named and the other is neither named nor an alternative.",
            experiments.cases
        )),
        text(format!(
            "Resolved, of the confusions with a proposed motion: {}. Resolved in the same cases, of those without a proposed motion: {}; of all confusions: {}. The diagnosis \
             selects the confusions that it proposes a motion for{}. Effects that were declared not testable and are named afterwards: {}.",
            counted(&experiments.resolved),
            counted(&experiments.resolved_unasked),
            counted(&experiments.resolved_of_all),
            rarer(experiments),
            counted(&experiments.unseen_named),
        )),
        table(&head, 2, kinds(&experiments.confusions)),
        text(
            "Same torque: both effects give the same torque in every motion that was tried, as an inertial scale and a torque scale on all joints do; the \
             diagnosis recommends another experiment. Out of reach: no motion within the limits gives enough evidence. Joint unexplained: the joint has an \
             unexplained residual, so that no outcome is predicted. Prediction fails: the prediction says that the present recordings already distinguish the two effects, \
             which they do not, so that no outcome is predicted.",
        ),
    ];
    let failed: Vec<Vec<String>> = experiments.confusions.iter().filter_map(unresolved).collect();
    if !failed.is_empty() {
        let head = ["case", "named", "alternative", "after the experiment"];
        list.push(table(&head, 4, failed));
    }
    let changes: Vec<Vec<String>> = [
        ("true name gained", &experiments.gained),
        ("**true name lost**", &experiments.lost),
        ("**false name added**", &experiments.false_added),
        ("false name removed", &experiments.false_dropped),
    ]
    .into_iter()
    .filter(|(_, names)| !names.is_empty())
    .map(|(what, names)| {
        let names: Vec<String> = names.iter().map(in_case).collect();
        vec![what.to_owned(), names.join("; ")]
    })
    .collect();
    if !changes.is_empty() {
        list.push(text("Other changes from the first diagnosis to the second:"));
        list.push(table(&["", "cases"], 2, changes));
    }
    list
}

/// The rate without the most frequent pair.
fn rarer(experiments: &Experiments) -> String {
    experiments.most_frequent.as_ref().map_or_else(String::new, |[a, b]| {
        let rarer = counted(&experiments.resolved_of_rarer);
        format!("; without the most frequent pair, `{a}` and `{b}`, it is {rarer}")
    })
}

fn in_case(named: &InCase) -> String {
    format!("{}: {}", named.case, name(&named.name))
}

/// A row for each pair of effects.
fn kinds(confusions: &[Confusion]) -> Vec<Vec<String>> {
    let mut kinds: BTreeMap<(&str, &str), Vec<&Confusion>> = BTreeMap::new();
    for confusion in confusions {
        let kind = (confusion.finding.0.as_str(), confusion.rival.0.as_str());
        kinds.entry(kind).or_default().push(confusion);
    }
    let mut kinds: Vec<_> = kinds.into_iter().collect();
    kinds.sort_by(|a, b| b.1.len().cmp(&a.1.len()).then(a.0.cmp(&b.0)));
    let row = |((finding, rival), list): ((&str, &str), Vec<&Confusion>)| {
        let count = |holds: &dyn Fn(&Confusion) -> bool| list.iter().filter(|c| holds(c)).count().to_string();
        let left = |c: &Confusion, kind: &str| c.because.as_deref() == Some(kind);
        vec![
            format!("`{finding}`"),
            format!("`{rival}`"),
            list.len().to_string(),
            count(&|c| c.proposed),
            count(&|c| c.proposed && c.after.is_some()),
            count(&|c| c.proposed && c.after == Some(After::Resolved)),
            count(&|c| left(c, "same_torque")),
            count(&|c| left(c, "out_of_reach")),
            count(&|c| left(c, "unexplained")),
            count(&|c| left(c, "not_foretold")),
        ]
    };
    kinds.into_iter().map(row).collect()
}

/// The row of a confusion that the proposed motion did not resolve.
fn unresolved(confusion: &Confusion) -> Option<Vec<String>> {
    let after = match confusion.after? {
        After::Resolved => return None,
        After::StillConfused => "the ground truth is named; the other is still an alternative",
        After::WrongNamed => "the other is named",
        After::NeitherNamed => "neither is named",
        After::NoAnswer => "the motion could not be recorded or diagnosed",
    };
    confusion
        .proposed
        .then(|| vec![confusion.case.clone(), name(&confusion.finding), name(&confusion.rival), after.to_owned()])
}

/// Why the target for resolved confusions is not reached.
pub fn reason(experiments: &Experiments) -> String {
    let failed = experiments.confusions.iter().filter_map(unresolved);
    let words: Vec<String> = failed.map(|row| format!("{} ({} or {}: {})", row[0], row[1], row[2], row[3])).collect();
    format!("not resolved: {}.", words.join(", "))
}
