//! Why a target is not reached, from the score itself.

use std::collections::BTreeMap;

use scoring::{Figure, Score, StrictFamily, Target, UrdfGroup};

use super::experiments;
use crate::numbers::percent_to_a_tenth as percent;

/// The reason in a sentence or two.
pub fn reason(target: &Target, score: &Score) -> String {
    match target.id {
        Figure::Strict => strict(target, score),
        Figure::FalseCases => "the section about failures lists every false name.".to_owned(),
        Figure::MacroF1 => families(score),
        Figure::EmptyCases => {
            let has_any = |case: &String| {
                let outside = score.outside.iter().filter(|outcome| !outcome.injected.is_empty());
                let inside = score.injected.iter().map(|outcome| &outcome.case);
                inside.chain(outside.map(|outcome| &outcome.case)).any(|other| other == case)
            };
            let empty = score.false_names.iter().filter(|name| !has_any(&name.case));
            format!("named in cases without an injected fault: {}.", tally(empty.map(|name| name.effect.as_str())))
        }
        Figure::OutsideRefused => {
            let missed = score.outside.iter().filter(|case| !case.refused);
            format!(
                "not refused: {}.",
                tally(missed.flat_map(|case| case.injected.iter().map(|(effect, _)| effect.as_str())))
            )
        }
        Figure::OutsideNamed => {
            let named = score.outside.iter().flat_map(|case| &case.named);
            format!("named there: {}.", tally(named.map(|(effect, _)| effect.as_str())))
        }
        Figure::ParameterErrors => parameters(score, false),
        Figure::Intervals => parameters(score, true),
        Figure::Covered => {
            let missed = score.injected.iter().filter(|o| o.is_asked());
            let missed = missed.filter(|o| !o.fate.is_covered());
            format!("neither a finding nor an alternative: {}.", tally(missed.map(|o| o.effect.as_str())))
        }
        Figure::HeldOut => held_out(score),
        Figure::Tracking => "see the section on the closed loop for each case.".to_owned(),
        Figure::Confusions => experiments::reason(&score.experiments),
    }
}

/// `name (count), …`, the most frequent first.
fn tally<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for name in names {
        *counts.entry(name).or_default() += 1;
    }
    let mut list: Vec<(&str, usize)> = counts.into_iter().collect();
    list.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
    let words: Vec<String> = list.iter().map(|(name, count)| format!("`{name}` ({count})")).collect();
    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
}

/// Effects that were not found with their size, and false names, in the group of cases of the figure.
fn strict(target: &Target, score: &Score) -> String {
    let is_meant = |group: &&UrdfGroup| target.group == Some(group.urdf);
    let strict = score.by_urdf.iter().find(is_meant).map_or(&score.strict, |group| &group.strict);
    let worst = strict.families.iter().filter(|(_, family)| family.f1.is_none_or(|f1| f1 < 0.95));
    let words: Vec<String> = worst
        .map(|(name, family)| {
            let StrictFamily { asked, right, wrong_size, false_names, .. } = family;
            format!("`{name}` ({right} of {asked} right, {wrong_size} of another size, {false_names} false)")
        })
        .collect();
    format!("{}.", words.join(", "))
}

fn families(score: &Score) -> String {
    let mut worst: Vec<_> = score
        .families
        .iter()
        .filter_map(|(name, family)| Some((family.f1?, name, family)))
        .filter(|(f1, ..)| *f1 < 0.95)
        .collect();
    worst.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(b.1)));
    let words: Vec<String> = worst
        .iter()
        .map(|(f1, name, family)| {
            let (found, asked, wrong) = (family.found, family.asked(), family.false_names);
            format!("`{name}` {f1:.2} ({found} of {asked} found, {wrong} false)")
        })
        .collect();
    let large = score.injected.iter().filter(|o| o.is_asked() && o.share.is_some_and(|share| share >= 0.06));
    let (found, all) = large.fold((0, 0), |(found, all), o| (found + usize::from(o.fate.is_found()), all + 1));
    let small = score.injected.iter().filter(|o| o.is_asked() && !o.fate.is_found());
    let small: Vec<_> = small.collect();
    let below = small.iter().filter(|o| o.share.is_some_and(|share| share < 0.06)).count();
    format!(
        "the lowest are {}. Of the {} effects that are not found, {below} have an expressed share below 6 %; of all effects above 6 %, {found} of {all} are found.",
        words.join(", "),
        small.len(),
    )
}

fn parameters(score: &Score, intervals: bool) -> String {
    let mut worst: Vec<(f64, String)> = score
        .parameters
        .iter()
        .filter(|p| intervals || p.main)
        .filter_map(|p| {
            let label = format!("`{}` {}", p.effect, p.parameter);
            if intervals {
                let share = p.covered.share()?;
                let text = format!("{label} ({} of {})", p.covered.hits, p.covered.of);
                (share < 0.9).then_some((share, text))
            } else {
                let median = p.errors.median?;
                (median > 0.05).then(|| (-median, format!("{label} ({})", percent(median))))
            }
        })
        .collect();
    worst.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let words: Vec<String> = worst.into_iter().take(6).map(|(_, text)| text).collect();
    let what = if intervals { "intervals that miss the ground truth most often" } else { "largest median errors" };
    if words.is_empty() {
        return "no parameter stands out.".to_owned();
    }
    format!("{what}: {}.", words.join(", "))
}

fn held_out(score: &Score) -> String {
    let mut worst: Vec<_> = score
        .held_out
        .iter()
        .filter(|case| !case.outside_the_catalogue)
        .filter_map(|case| Some((case.over_true_terms()?, &case.case)))
        .filter(|(ratio, _)| *ratio > 1.1)
        .collect();
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    let words: Vec<String> = worst.iter().take(8).map(|(ratio, case)| format!("{case} ({ratio:.2})")).collect();
    format!("{} cases have a ratio above 1.1; the largest are {}.", worst.len(), words.join(", "))
}
