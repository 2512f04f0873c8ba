//! A diagnosis as Markdown: verdict, findings with their parameters, errors, open questions, and the next steps.

use std::collections::BTreeMap;

use arm::{Arm, JointKind};
use diagnosis::{Doubt, Finding, NotObservable, Report};
use effects::Quantity;

use crate::block::{Block, table, text};
use crate::doubts::Certainty;
use crate::{alternatives, differences, doubts, markdown, next_words, not_diagnosed, numbers, sizes, terminal, words};

/// The diagnosis of `arm` as Markdown; the same report gives the same bytes.
pub fn diagnosis_markdown(report: &Report, arm: &Arm) -> String {
    let made =
        format!("Made by testbed {} (`testbed diagnose`), schema `{}`.", env!("CARGO_PKG_VERSION"), report.schema);
    markdown(&blocks(report, arm), &made)
}

fn blocks(report: &Report, arm: &Arm) -> Vec<Block> {
    let mut blocks = vec![Block::Title(format!("Diagnosis of {}", report.robot))];
    if let Some(changed) = words::changed(report) {
        blocks.push(text(changed));
    }
    let all = [differences::different_load, differences::held_out_friction, differences::torque_lag];
    let sentences = all.into_iter().filter_map(|sentence| sentence(report));
    blocks.extend(sentences.map(text));
    blocks.push(text(format!("**{}**", words::verdict(report))));
    blocks.extend(doubted(&report.doubts, Certainty::Certain, report));
    blocks.push(text(recordings(report)));
    if !report.warnings.is_empty() {
        blocks.push(Block::Heading("Recordings that contradict the URDF"));
        blocks.extend(doubted(&report.warnings, Certainty::Possible, report));
    }
    blocks.extend(not_diagnosed::reasons(report, code).into_iter().map(text));
    for reason in &report.not_enough_data {
        blocks.push(text(format!("Not enough data: {reason}.")));
    }
    blocks.extend(findings(report));
    blocks.extend(unexplained(report, arm));
    blocks.extend(errors(report, arm));
    blocks.extend(rollout(report, arm));
    blocks.extend(not_testable(report, arm));
    blocks.extend(next_steps(report));
    blocks
}

/// Doubts or warnings, with the column maps that correct them.
fn doubted(doubts: &[Doubt], certainty: Certainty, report: &Report) -> Vec<Block> {
    let mut blocks = Vec::new();
    for group in doubts::groups(doubts, certainty, report) {
        blocks.extend(group.texts.into_iter().map(|sentence| text(format!("{sentence}."))));
        if let Some(map) = group.map {
            blocks.push(text(group.usage));
            let code = map.to_owned();
            blocks.push(Block::Code { language: "toml", code });
        }
    }
    blocks
}

/// A name as a code span, because Markdown would read underscores as emphasis. Backticks in the name are replaced, because
/// they would end the span.
fn code(name: &str) -> String {
    format!("`{}`", name.replace('`', "'").replace('\n', " "))
}

/// The joint, or the whole arm.
fn place(joint: Option<&str>) -> String {
    joint.map_or_else(|| "whole arm".to_owned(), code)
}

fn recordings(report: &Report) -> String {
    let names = |list: &[String]| words::list(&list.iter().map(|name| code(name)).collect::<Vec<_>>());
    let all = &report.recordings;
    let is_later = |name: &&String| !all.before.contains(name);
    let mut train = names(&all.train.iter().filter(is_later).cloned().collect::<Vec<_>>());
    if !all.before.is_empty() {
        train += &format!(". Recordings from before: {}", names(&all.before));
    }
    if report.recordings.held_out.is_empty() {
        return format!("Training recordings: {train}. No recording was held out, so that no finding is validated.");
    }
    let held_out = names(&report.recordings.held_out);
    format!("Training recordings: {train}. Held-out recordings: {held_out}.")
}

fn findings(report: &Report) -> Vec<Block> {
    if report.findings.is_empty() {
        return Vec::new();
    }
    let overview = |finding: &Finding| {
        vec![
            place(finding.joint.as_deref()),
            words::effect(finding),
            sizes::cell(finding, ", "),
            alternatives::text(finding),
            words::share(finding).map_or_else(|| "–".into(), numbers::share),
            numbers::probability(finding.probability),
            terminal::error(report, finding),
        ]
    };
    let head = [
        "joint",
        "effect",
        "size with its 95 % interval",
        "could also be",
        "share of the torque",
        "probability",
        terminal::error_title(report),
    ];
    let parameters = report.findings.iter().flat_map(|finding| {
        finding.parameters.iter().map(|(name, parameter)| {
            vec![
                place(finding.joint.as_deref()),
                code(finding.effect),
                code(name),
                parameter.unit.to_owned(),
                numbers::for_programs(parameter.value),
                numbers::for_programs(parameter.ci95[0]),
                numbers::for_programs(parameter.ci95[1]),
            ]
        })
    });
    vec![
        Block::Heading("What was found"),
        table(&head, 4, report.findings.iter().map(overview).collect()),
        text(
            "Share and error are relative to the standard deviation of the measured torque. Share: standard deviation of the \
             effect's torque. Error: RMS torque error, with the nominal model → with all effects found; it belongs to the joint \
             and is repeated for each of its findings.",
        ),
        Block::Heading("All parameters, in SI units at the joint"),
        table(&["joint", "effect", "parameter", "unit", "value", "from", "to (95 %)"], 4, parameters.collect()),
    ]
}

fn unexplained(report: &Report, arm: &Arm) -> Vec<Block> {
    if report.unexplained.is_empty() {
        return Vec::new();
    }
    let row = |open: &diagnosis::Unexplained| {
        let on: Vec<String> = open.depends_on.iter().map(words::dependence).collect();
        let on = if on.is_empty() && report.is_requested {
            "not searched".to_owned()
        } else if on.is_empty() {
            "nothing that was tried".to_owned()
        } else {
            words::list(&on)
        };
        let on = match terminal::largest(report, open, Some(arm)) {
            Some(place) => format!("{on}; {place}"),
            None => on,
        };
        vec![code(&open.joint), on, open.next.clone(), numbers::share(open.share)]
    };
    vec![
        Block::Heading("Unexplained residuals"),
        table(
            &["joint", "depends on", "next experiment", "share of the torque"],
            3,
            report.unexplained.iter().map(row).collect(),
        ),
    ]
}

fn errors(report: &Report, arm: &Arm) -> Vec<Block> {
    let optional = |value: Option<f64>| value.map_or("–".to_owned(), numbers::nrmse);
    let rows = arm.joints().iter().filter_map(|joint| {
        let fit = report.fit.get(&joint.name)?;
        let unit = Quantity::Torque.unit(joint.kind);
        Some(vec![
            code(&joint.name),
            numbers::quantity(fit.torque_std, unit),
            optional(fit.held_out_nrmse_nominal),
            optional(fit.held_out_nrmse_augmented),
            optional(fit.held_out_nrmse_learned),
            numbers::before_after(fit.held_out_nrmse_resting_nominal, fit.held_out_nrmse_resting),
            numbers::before_after(Some(fit.train_nrmse_nominal), Some(fit.train_nrmse_augmented)),
        ])
    });
    let head = [
        "joint",
        "torque, standard deviation",
        "nominal",
        "with effects",
        "learned",
        "at rest, nominal → with effects",
        "training, nominal → with effects",
    ];
    vec![
        Block::Heading("Torque error of each joint"),
        table(&head, 1, rows.collect()),
        text(
            "RMS torque error over the standard deviation of the measured torque. The columns nominal, with effects and learned \
             (Independent Joint Learning) are for the held-out recordings while the joint moves.",
        ),
    ]
}

fn rollout(report: &Report, arm: &Arm) -> Vec<Block> {
    if report.rollout.is_empty() {
        return Vec::new();
    }
    let rows = arm.joints().iter().filter_map(|joint| {
        let rollout = report.rollout.get(&joint.name)?;
        let unit = Quantity::Position.unit(joint.kind);
        let errors = [rollout.nominal_rms_rad, rollout.augmented_rms_rad];
        let [nominal, augmented] = errors.map(|error| numbers::quantity(error, unit));
        Some(vec![code(&joint.name), nominal, augmented])
    });
    vec![
        Block::Heading("Simulated motion compared with the recording"),
        table(&["joint", "nominal, RMS position error", "with effects"], 1, rows.collect()),
    ]
}

fn not_testable(report: &Report, arm: &Arm) -> Vec<Block> {
    let mut groups: BTreeMap<(&str, &str), Vec<&NotObservable>> = BTreeMap::new();
    for entry in &report.not_observable {
        groups.entry((entry.effect, &entry.because)).or_default().push(entry);
    }
    if groups.is_empty() {
        return Vec::new();
    }
    let rows = groups.values().map(|entries| {
        let sizes = entries.iter().map(|entry| {
            let joint = arm.joints().iter().find(|joint| Some(&joint.name) == entry.joint.as_ref());
            let kind = joint.map_or(JointKind::Revolute, |joint| joint.kind);
            let place = place(entry.joint.as_deref());
            match words::detectable_sizes(entry, kind).as_str() {
                "" => format!("{place} at no size"),
                sizes => format!("{place} {sizes}"),
            }
        });
        vec![
            words::wording(entries[0].effect).name.to_owned(),
            entries[0].because.clone(),
            sizes.collect::<Vec<_>>().join(", "),
        ]
    });
    vec![
        Block::Heading("Not testable with these recordings"),
        text("These effects may be present: the recordings only reveal them at the sizes given."),
        table(&["effect", "reason", "detectable size"], 3, rows.collect()),
    ]
}

fn next_steps(report: &Report) -> Vec<Block> {
    let steps = terminal::steps::experiments(report);
    if steps.is_empty() {
        return Vec::new();
    }
    let mut blocks = vec![Block::Heading("What to do next")];
    blocks.extend(steps.iter().map(|step| text(format!("- {step}."))));
    if let Some(next) = report.next_experiment.as_ref().filter(|next| !next.separates.is_empty()) {
        let row = |pair: &diagnosis::Separation| {
            let [before, after, needed] = [pair.before, pair.after, pair.needed].map(numbers::short);
            let [finding, rival] = [&pair.finding, &pair.rival].map(next_words::name);
            vec![finding, rival, before, after, needed]
        };
        blocks.push(table(
            &["finding", "alternative", "evidence now (nats)", "with the motion", "needed"],
            2,
            next.separates.iter().map(row).collect(),
        ));
    }
    blocks
}
