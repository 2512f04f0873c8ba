//! One robot in the report: the published effects with the findings, further findings, effects that are not testable, and
//! the errors by joint.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use report::block::{Block, table, text};
use report::numbers::{rounded, scaled, share, short};
use report::score::name;
use scoring::{Besides, Compared, Evidence, PublishedFate, PublishedOutcome};

use super::Tried;
use super::fold::{ERRORS, error};
use super::quantities::difference;

/// The robot's section.
pub fn blocks(tried: &Tried) -> Vec<Block> {
    let (robot, score) = (&tried.robot, &tried.score);
    let mut list = vec![Block::Section(format!("{}: {}", robot.name, robot.title))];
    if let Some(reason) = &tried.error {
        list.push(text(format!("There is no diagnosis: {reason}")));
    }
    let head = [
        "published effect",
        "evidence",
        "outcome",
        "published",
        "found, with its 95 % interval",
        "difference",
        "inside",
    ];
    list.push(table(&head, 3, score.said.iter().flat_map(said).collect()));
    let places: Vec<&String> = score.said.iter().map(|outcome| &outcome.said.place).collect();
    let mut seen: Vec<&String> = Vec::new();
    places.into_iter().for_each(|place| {
        if !seen.contains(&place) {
            seen.push(place);
        }
    });
    let seen: Vec<&str> = seen.into_iter().map(String::as_str).collect();
    list.push(text(format!("Sources: {}.", seen.join("; "))));
    if score.besides.is_empty() {
        list.push(text("No further effect is named."));
    } else {
        let head = ["also named", "published?", "description", "alternatives", "share", "probability"];
        list.push(table(&head, 4, score.besides.iter().map(besides).collect()));
    }
    list.push(text(not_found(tried)));
    list.push(errors(tried));
    for note in &robot.notes {
        list.push(text(format!("**Our note.** {note}")));
    }
    list
}

/// A row for each published value, or one row for an effect without a value.
fn said(outcome: &PublishedOutcome) -> Vec<Vec<String>> {
    let said = &outcome.said;
    let effects: Vec<String> = said.effects.iter().map(|effect| format!("`{effect}`")).collect();
    let joint = said.joint.as_ref().map_or_else(String::new, |joint| format!(" on {joint}"));
    let what = format!("{}{joint}", effects.join(" or "));
    let evidence = match said.evidence {
        Evidence::Number => "number",
        Evidence::Derived => "derived",
        Evidence::Constant => "constant",
        Evidence::Statement => "statement",
    };
    let came = came_of(outcome);
    let row = |what: String, came: String, cells: [String; 4]| {
        [vec![what, evidence.to_owned(), came], cells.to_vec()].concat()
    };
    if !outcome.numbers.is_empty() {
        let numbers = outcome.numbers.iter();
        return numbers
            .map(|number| row(format!("{what}, {}", number.parameter), came.clone(), compared(number)))
            .collect();
    }
    if said.parameters.is_empty() {
        let found: Vec<&str> = outcome.sentences.iter().map(|sentence| in_short(sentence)).collect();
        let cells = [String::new(), found.join("; "), String::new(), String::new()];
        return vec![row(what, came, cells)];
    }
    let numbers = said.parameters.iter();
    numbers
        .map(|(key, number)| {
            let published = quantity(number.value, number.value, &number.unit, true);
            let cells = [published, String::new(), String::new(), String::new()];
            row(format!("{what}, {key}"), came.clone(), cells)
        })
        .collect()
}

fn came_of(outcome: &PublishedOutcome) -> String {
    let other = outcome.named_as.as_ref().map(name).unwrap_or_default();
    match outcome.fate {
        PublishedFate::Named => "named".into(),
        PublishedFate::SameTorque => format!("same torque: {other}"),
        PublishedFate::Confusable => format!("alternative of {other}"),
        PublishedFate::NotObservable => "declared not testable".into(),
        PublishedFate::Unexplained => "**missed**; the joint is unexplained".into(),
        PublishedFate::Missed => "**missed**".into(),
    }
}

/// The cells: published value, estimate with interval, difference, whether the interval contains the published value.
fn compared(number: &Compared) -> [String; 4] {
    let scale = number.published;
    let published = quantity(number.published, scale, &number.unit, true);
    let Some(found) = number.found else {
        return [published, "not estimated".into(), String::new(), String::new()];
    };
    let bound =
        |bound: Option<f64>| bound.map_or_else(|| "–".to_owned(), |bound| quantity(bound, scale, &number.unit, false));
    let [low, high] = number.ci95.map(bound);
    let found = quantity(found, scale, &number.unit, true);
    [
        published,
        format!("{found} ({low} … {high})"),
        number.difference.map_or_else(String::new, difference),
        if number.covered { "yes" } else { "no" }.to_owned(),
    ]
}

/// `value` under the prefix that suits `scale`.
fn quantity(value: f64, scale: f64, unit: &str, with_unit: bool) -> String {
    let scaled = scaled(scale.abs(), if unit == "1" { "" } else { unit });
    let number = short(value / scaled.factor);
    if with_unit && !scaled.unit.is_empty() { format!("{number} {}", scaled.unit) } else { number }
}

fn besides(besides: &Besides) -> Vec<String> {
    let published = match (&besides.contradicted_by, besides.comes_with) {
        (Some(place), _) => format!("**contradicts** {place}"),
        (None, true) => "accompanies a published effect".to_owned(),
        (None, false) => "not published".to_owned(),
    };
    let others: Vec<String> = besides.confusable_with.iter().map(name).collect();
    vec![
        name(&besides.name),
        published,
        in_short(&besides.sentence).to_owned(),
        others.join(", "),
        share(besides.share),
        besides.probability.map_or_else(|| "–".to_owned(), |p| format!("{p:.2}")),
    ]
}

/// A finding's sentence without the joint and the error, which the tables have.
fn in_short(sentence: &str) -> &str {
    let end = ["; held-out error", ", with which"].into_iter().filter_map(|mark| sentence.find(mark)).min();
    let sentence = &sentence[..end.unwrap_or(sentence.len())];
    sentence.split_once(": ").map_or(sentence, |(_, rest)| rest)
}

fn not_found(tried: &Tried) -> String {
    let score = &tried.score;
    let unexplained = match score.unexplained.as_slice() {
        [] => "No joint has an unexplained residual.".to_owned(),
        joints => format!("Unexplained residual on: {}.", joints.join(", ")),
    };
    let mut by_joints: BTreeMap<(Reverse<usize>, &Vec<String>), Vec<String>> = BTreeMap::new();
    for (effect, joints) in &score.not_observable {
        let place = by_joints.entry((Reverse(joints.len()), joints)).or_default();
        place.push(format!("`{effect}`"));
    }
    if by_joints.is_empty() {
        return unexplained;
    }
    let groups = by_joints.iter().map(|((_, joints), effects)| {
        let is_all = joints.len() == score.held_out.len() && joints.len() > 1;
        let joints = if is_all { "all joints".to_owned() } else { joints.join(", ") };
        format!("on {joints} {}", effects.join(", "))
    });
    let groups: Vec<String> = groups.collect();
    format!("{unexplained} Not testable with these recordings, or only above a certain size: {}.", groups.join("; "))
}

fn errors(tried: &Tried) -> Block {
    let score = &tried.score;
    let rows = score.held_out.iter().map(|(joint, errors)| {
        let rollout = score.rollout.get(joint);
        let motion = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| rounded(1e3 * value, 3));
        vec![
            joint.clone(),
            error(errors.nominal),
            error(errors.diagnosed),
            error(errors.said),
            error(errors.learned),
            motion(rollout.map(|rollout| rollout.nominal)),
            motion(rollout.map(|rollout| rollout.diagnosed)),
        ]
    });
    let head = [&["joint"], &ERRORS[..]].concat();
    table(&head, 1, rows.collect())
}
