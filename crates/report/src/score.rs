//! A proof's score as blocks, from which the page and the Markdown file are made.

mod experiments;
mod figures;
mod reasons;
mod results;
mod words;

use scoring::{Fate, Figure, LEAST_SHARE, SIZE_WITHIN, Score, Strict};

use crate::block::{Block, table, text};
use crate::numbers::percent_to_a_tenth as percent;

pub use experiments::experiments;
pub use results::{calibration, controls, found, numbers};
pub use words::{counted, figure, name, number, share, wanted};

/// The expressed share from which effects declared not testable are listed.
const LARGE: f64 = 0.06;

/// The title, the outcome of all cases, the targets, and why a target is not reached.
pub fn opening(score: &Score) -> Vec<Block> {
    let reached = score.targets.iter().filter(|target| target.reached == Some(true)).count();
    let asked = score.targets.iter().filter(|target| target.reached.is_some()).count();
    let rows = score.targets.iter().map(|target| {
        let interval = target.counted.map_or_else(String::new, |counted| {
            let [low, high] = counted.wilson.map(|bound| 100.0 * bound);
            format!("{low:.0} to {high:.0} %")
        });
        let reached = match target.reached {
            Some(true) => "yes",
            Some(false) => "**no**",
            None => "–",
        };
        vec![target.what.clone(), figure(target), interval, target.of.to_string(), wanted(target), reached.to_owned()]
    });
    let head = ["", "figure", "Wilson 95 % interval", "of", "target", "reached"];
    let mut list = vec![
        Block::Title("Injected faults: what is found, what is missed, and where the diagnosis fails".into()),
        text(format!(
            "{} effects were injected in {} cases. The diagnosis ran in processes that had access to the recordings and a rigid URDF only. {reached} of the \
             {asked} targets are reached. {}",
            score.injected.len(),
            score.cases,
            unanswered(score),
        )),
        text(headline(score)),
        by_urdf(score),
        table(&head, 1, rows.collect()),
        text(exempt(score)),
    ];
    for target in score.targets.iter().filter(|target| target.reached == Some(false)) {
        let reason = match target.id == Figure::Tracking {
            true => "see the section on the closed loop for each case.".to_owned(),
            false => reasons::reason(target, score),
        };
        list.push(text(format!("**{}**: {reason}", target.what)));
    }
    list
}

/// The strict figure in words, and the macro F1 with exceptions.
fn headline(score: &Score) -> String {
    let strict = &score.strict;
    format!(
        "**Strict macro F1 {}**: every injected effect with an expressed share of at least {} is required, every name that is not true is false, and an effect \
         counts as found only if its size is within {} of the true one, where the two can be compared. {} were found with their size, {} more with another size; \
         false names: {}, and {} of baseline friction and drive inertia. Macro F1 without sizes, without effects that were declared not testable at their size, \
         and with equivalent names counted as right: {}.",
        number(strict.macro_f1),
        percent(LEAST_SHARE),
        percent(SIZE_WITHIN),
        counted(&strict.right),
        strict.wrong_size,
        strict.false_names,
        strict.baseline_false,
        number(score.macro_f1),
    )
}

/// The results by the error of the URDF.
fn by_urdf(score: &Score) -> Block {
    let line = |what: &str, cases: usize, strict: &Strict, macro_f1: Option<f64>| {
        vec![
            what.to_owned(),
            cases.to_string(),
            number(strict.macro_f1),
            number(macro_f1),
            counted(&strict.right),
            strict.false_names.to_string(),
            counted(&strict.cases_with_a_false_name),
            counted(&strict.intervals),
        ]
    };
    let groups = score.by_urdf.iter();
    let mut rows: Vec<_> =
        groups.map(|group| line(group.urdf.words(), group.cases, &group.strict, group.macro_f1)).collect();
    rows.push(line("**all**", score.cases, &score.strict, score.macro_f1));
    let head = [
        "URDF",
        "cases",
        "macro F1, strict",
        "macro F1",
        "found with the size",
        "false names",
        "cases with one",
        "95 % intervals that contain the true value",
    ];
    table(&head, 1, rows)
}

/// How many cases have no answer, and how the figures count them.
fn unanswered(score: &Score) -> String {
    match score.unanswered.as_slice() {
        [] => "All cases have an answer.".to_owned(),
        list => format!(
            "Cases without an answer: {} ({}). Their effects count as not found, and they are excluded from the figures on named effects, errors and intervals.",
            list.len(),
            list.join(", ")
        ),
    }
}

/// The effects that F1 and coverage exclude, because the diagnosis declared them not testable.
fn exempt(score: &Score) -> String {
    let exempt = || {
        let counted = score.injected.iter().filter(|o| o.counts);
        counted.filter(|o| o.fate == Fate::NotObservable)
    };
    let mut large: Vec<_> = exempt().filter_map(|o| Some((o.share.filter(|&share| share > LARGE)?, o))).collect();
    large.sort_by(|(a, x), (b, y)| b.total_cmp(a).then(x.case.cmp(&y.case)));
    let largest = exempt().filter_map(|o| o.share).reduce(f64::max);
    let words = large.iter().map(|(share, o)| {
        let what = name(&(o.effect.clone(), o.joint.clone()));
        format!("{what} in {} ({})", o.case, percent(*share))
    });
    let list = match words.collect::<Vec<_>>().as_slice() {
        [] => String::new(),
        list => format!(": {}", list.join(", ")),
    };
    format!(
        "F1 and coverage exclude the effects that a diagnosis declares not testable at their size: {} effects, the largest with an expressed share of {}, {} above {}{list}. \
         If these count as missed and as not covered, macro F1 is {}, and the ground truth is in the finding or its alternatives in {}.",
        exempt().count(),
        share(largest),
        large.len(),
        percent(LARGE),
        number(score.macro_f1_strict),
        counted(&score.covered_strict),
    )
}

/// All failures: effects that are missed, false names, and refusals on joints that need none.
pub fn failures(score: &Score) -> Vec<Block> {
    let mut rows = Vec::new();
    for outcome in score.injected.iter().filter(|o| o.counts && !o.fate.is_found()) {
        let fate = match outcome.fate {
            Fate::Covered => "an alternative only",
            Fate::NotObservable => "declared not testable",
            Fate::Refused => "joint refused",
            Fate::Found | Fate::SameMachine | Fate::Missed => "missed",
        };
        let mut said: Vec<String> = outcome.instead.iter().map(name).collect();
        said.insert(0, fate.to_owned());
        let mut what = name(&(outcome.effect.clone(), outcome.joint.clone()));
        if let Some(form) = &outcome.form {
            what.push_str(&format!(" ({form})"));
        }
        rows.push(vec![outcome.case.clone(), what, said.join("; named "), share(outcome.share)]);
    }
    for wrong in &score.false_names {
        let what = name(&(wrong.effect.clone(), wrong.joint.clone()));
        let there = if wrong.injected_there.is_empty() {
            "nothing injected there".to_owned()
        } else {
            format!("injected there: {}", wrong.injected_there.join(", "))
        };
        let admits = if wrong.admits_the_truth { "; the ground truth is one of its alternatives" } else { "" };
        let said = format!("named falsely{admits}; {there}");
        rows.push(vec![wrong.case.clone(), what, said, percent(wrong.share)]);
    }
    for case in score.outside.iter().filter(|case| !case.refused) {
        let what = case.injected.iter().map(name).collect::<Vec<_>>().join(", ");
        rows.push(vec![case.case.clone(), what, "not refused".to_owned(), share(case.share)]);
    }
    for case in &score.refusals_without_cause {
        let what = format!("refused {}", case.unexplained.join(", "));
        rows.push(vec![case.case.clone(), what, "nothing outside the catalogue".to_owned(), String::new()]);
    }
    for case in &score.unanswered {
        rows.push(vec![case.clone(), "no answer".to_owned(), String::new(), String::new()]);
    }
    rows.sort();
    vec![
        Block::Heading("All failures"),
        text(format!(
            "There are {} failures. `diagnoses/CASE.json` and `truth/CASE.json` hold the details.",
            rows.len()
        )),
        table(&["case", "what", "how", "share"], 3, rows),
    ]
}
