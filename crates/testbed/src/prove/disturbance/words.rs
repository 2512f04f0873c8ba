//! The paper's disturbance in the report.

use report::block::{Block, table, text};
use report::numbers::rounded;
use report::score::name;

use super::{Disturbance, EFFECT, Factor, NamedEffect, Other, ROUNDING};
use crate::models::ModelKind;
use crate::tables::mean;

/// The section: heading, findings and table.
pub fn blocks(of: &Disturbance) -> Vec<Block> {
    let mut list = vec![
        Block::Heading("The paper's own disturbance"),
        text(format!(
            "A PUMA 560 performs task A with its exact model; all masses and inertia tensors of the URDF beside the recording are {} times the true ones, \
             which is the error studied by Um, Park and Park (2014). Task D is held out. The case is sealed and diagnosed like all others, \
             and is not included in the figures above.",
            of.inertia_scale
        )),
        text(found(of)),
    ];
    list.extend(of.diagnosed.as_ref().map(|errors| {
        let level = if of.is_rounding {
            format!("below {ROUNDING:e} (N m)², which is rounding error for torques of tens of N m")
        } else {
            format!("**not** below {ROUNDING:e} (N m)²")
        };
        text(format!(
            "On task D, the mean squared torque error of the corrected URDF is {} (N m)² in the mean over the joints, {level}. The remaining error is due to the zero-order hold \
             of the torque: the loop holds it for one millisecond, and the recording contains it at the start of the interval, half a millisecond before the motion that it corresponds to. \
             Filtering contributes far less, because positions and torques pass the same filter.",
            rounded(errors.mean, 3)
        ))
    }));
    list.push(text(
        "Mean squared torque error on task D, (N m)²; the models are trained on task A, as in the paper's table I. The paper's own means are given beside ours; \
         those of its table II are after training on tasks A, B and C. The comparison is not between equals: the models learn a function from 800 samples without \
         prior knowledge of effects; the diagnosis uses the complete run, and the true effect is one parameter of its catalogue.",
    ));
    list.push(errors(of));
    list
}

fn found(of: &Disturbance) -> String {
    let list = |effects: &[NamedEffect]| {
        let words = effects.iter().map(|effect| name(&(effect.effect.clone(), effect.joint.clone())));
        words.collect::<Vec<_>>().join(", ")
    };
    let mut sentences = vec![match (of.is_one_finding, of.findings.is_empty()) {
        (true, _) => format!("The diagnosis names `{EFFECT}` and no other effect."),
        (false, true) => "The diagnosis names **nothing**.".to_owned(),
        (false, false) => format!("The diagnosis names {}, **not `{EFFECT}` alone**.", list(&of.findings)),
    }];
    sentences.extend(of.factor.as_ref().map(size));
    if of.aliases_are_all_torque_scales {
        sentences.push(
            "The only alternative that it states is `torque_scale` on every joint: without a known load, an inertial scale and a common torque scale \
             give the same recordings."
                .to_owned(),
        );
    } else if !of.findings.is_empty() {
        let said = if of.aliases.is_empty() { "none".to_owned() } else { list(&of.aliases) };
        sentences.push(format!("The alternative that it states is {said}, **not `torque_scale` on every joint**."));
    }
    sentences.join(" ")
}

fn size(factor: &Factor) -> String {
    let bound = |bound: Option<f64>| bound.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"));
    let [low, high] = factor.ci95.map(bound);
    let holds = if factor.is_covered { "contains" } else { "**does not contain**" };
    format!(
        "The estimated factor of the inertias is {:.6}; the ground truth is {:.6}, and the error is {}. The 95 % interval, {low} to {high}, {holds} the ground truth; \
         its half-width includes two per cent of the value, which every interval allows for filtering and model form errors.",
        factor.value,
        factor.truth,
        rounded(factor.off.abs(), 2)
    )
}

/// The torque errors of the diagnosed model and of the learned models, joint by joint.
fn errors(of: &Disturbance) -> Block {
    let joints = of.others.first().map_or(0, |other| other.row.mse.len());
    let of_paper = |row: Option<[f64; 6]>| row.map_or_else(|| "–".to_owned(), |row| rounded(mean(&row), 3));
    let line = |title: &str, mse: &[f64], mean: f64, papers: [Option<[f64; 6]>; 2]| -> Vec<String> {
        let numbers = mse.iter().chain([&mean]).map(|value| rounded(*value, 3));
        let cells = [title.to_owned()].into_iter().chain(numbers);
        cells.chain(papers.map(of_paper)).collect()
    };
    let mut rows: Vec<Vec<String>> = of
        .others
        .iter()
        .map(|Other { row, paper_table_2 }| line(row.model.title(), &row.mse, row.mean, [row.paper, *paper_table_2]))
        .collect();
    if let Some(errors) = &of.diagnosed {
        rows.push(line("**diagnosed model**", &errors.mse, errors.mean, [None; 2]));
    }
    let numbers: Vec<String> = (1..=joints).map(|joint| format!("joint {joint}")).collect();
    let mut head = vec!["model"];
    head.extend(numbers.iter().map(String::as_str));
    head.extend(["mean", "the paper's, table I", "the paper's, table II"]);
    table(&head, 1, rows)
}

/// One line for the terminal.
pub fn line(of: &Disturbance) -> String {
    let learned = of
        .others
        .iter()
        .find(|other| other.row.model == ModelKind::IndependentJoint)
        .map_or_else(|| "–".to_owned(), |other| rounded(other.row.mean, 3));
    let diagnosed = of.diagnosed.as_ref().map_or_else(|| "–".to_owned(), |errors| rounded(errors.mean, 3));
    let named = match (&of.factor, of.is_one_finding) {
        (Some(factor), true) => format!("{EFFECT} × {:.6} alone (true {:.6})", factor.value, factor.truth),
        _ => format!("{} findings, not {EFFECT} alone", of.findings.len()),
    };
    format!("the paper's disturbance: {named}; torque error on task D {diagnosed} (N m)², IJL's {learned}\n")
}
