//! What came of the proposed experiments, as blocks of the report.

use std::collections::BTreeMap;

use scoring::{After, Confusion, Experiments, InCase};

use super::words::{counted, name};
use crate::block::{Block, table, text};

/// The section; nothing where no diagnosis left anything open. `looked_at` cases were looked at for a proposal.
pub fn experiments(experiments: &Experiments, looked_at: usize) -> Vec<Block> {
    if experiments.confusions.is_empty() {
        return Vec::new();
    }
    let head = [
        "named",
        "could be instead",
        "confusions",
        "a motion proposed",
        "made",
        "resolved",
        "no motion tells",
        "out of reach",
        "joint unexplained",
        "not foretold",
    ];
    let mut list = vec![
        Block::Heading("The next experiment"),
        text(format!(
            "A confusion is a finding and one thing that it could be instead, one of the two concealed. The diagnosis proposes one motion for all of its \
             confusions (`--next`). Of {looked_at} cases spread evenly over the campaign (all, of fewer) those with a proposal for a confusion, {} cases, were \
             recorded once more along that motion, within the URDF's limits, by whoever concealed (made .7 or .5 as large about its middle where the position \
             loop could not hold the machine); a new process was given that recording beside the old ones. Resolved: what is concealed is named, and the other neither named nor among what it could be.",
            experiments.cases
        )),
        text(format!(
            "Resolved of those for which a motion was proposed: {}. In the same cases, of those for which none was: {}; of all of them: {}. The diagnosis \
             chooses what it proposes for{}. Named then of what was declared not observable: {}.",
            counted(&experiments.resolved),
            counted(&experiments.resolved_unasked),
            counted(&experiments.resolved_of_all),
            rarer(experiments),
            counted(&experiments.unseen_named),
        )),
        table(&head, 2, kinds(&experiments.confusions)),
        text(
            "No motion tells: predicted to be the same torque in every motion tried, as with masses all too large and torques all measured too large. The \
             diagnosis says which other experiment would tell. Out of reach: no motion tried within the limits sets them far enough apart. Joint unexplained: \
             something without a name is left there, and nothing is promised. Not foretold: the same prediction says that the recordings tell already what they \
             do not, and nothing is promised.",
        ),
    ];
    let failed: Vec<Vec<String>> = experiments.confusions.iter().filter_map(unresolved).collect();
    if !failed.is_empty() {
        let head = ["case", "named", "could be instead", "after the experiment"];
        list.push(table(&head, 4, failed));
    }
    let changes: Vec<Vec<String>> = [
        ("a true name gained", &experiments.gained),
        ("**a true name lost**", &experiments.lost),
        ("**a false name added**", &experiments.false_added),
        ("a false name dropped", &experiments.false_dropped),
    ]
    .into_iter()
    .filter(|(_, names)| !names.is_empty())
    .map(|(what, names)| {
        let names: Vec<String> = names.iter().map(in_case).collect();
        vec![what.to_owned(), names.join("; ")]
    })
    .collect();
    if !changes.is_empty() {
        list.push(text("What else changed from the first diagnosis to the second:"));
        list.push(table(&["", "cases"], 2, changes));
    }
    list
}

/// What is left without the most frequent pair.
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

/// A row for a confusion that a motion was made for in vain.
fn unresolved(confusion: &Confusion) -> Option<Vec<String>> {
    let after = match confusion.after? {
        After::Resolved => return None,
        After::StillConfused => "the truth is named, and could still be the other",
        After::WrongNamed => "the other is named",
        After::NeitherNamed => "neither is named",
        After::NoAnswer => "the motion could not be recorded or diagnosed",
    };
    confusion.proposed.then(|| {
        vec![
            confusion.case.clone(),
            name(&confusion.finding),
            name(&confusion.rival),
            after.to_owned(),
        ]
    })
}

/// Why fewer are resolved than were asked for.
pub fn reason(experiments: &Experiments) -> String {
    let failed = experiments.confusions.iter().filter_map(unresolved);
    let words: Vec<String> = failed
        .map(|row| format!("{} ({} or {}: {})", row[0], row[1], row[2], row[3]))
        .collect();
    format!("not resolved: {}.", words.join(", "))
}
