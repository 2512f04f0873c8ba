//! The paper's disturbance in the report.

use report::block::{Block, table, text};
use report::numbers::rounded;
use report::score::name;

use super::{Cause, Disturbance, EFFECT, Factor, Other, ROUNDING};
use crate::models::ModelKind;
use crate::tables::mean;

/// The heading, what was found, and the table.
pub fn blocks(of: &Disturbance) -> Vec<Block> {
    let mut list = vec![
        Block::Heading("The paper's own disturbance"),
        text(format!(
            "A PUMA 560 does task A under its exact model; all masses and inertia tensors of the URDF beside the recording are {} times the true ones, \
             the error of the paper that testbed began with (Um, Park and Park 2014). Task D is held out. The case was sealed and diagnosed as all others, \
             and is in none of the figures above.",
            of.inertia_scale
        )),
        text(found(of)),
    ];
    list.extend(of.diagnosed.as_ref().map(|errors| {
        let level = if of.is_rounding {
            format!("below {ROUNDING:e} (N m)², which is rounding beside torques of tens of N m")
        } else {
            format!("**not** below {ROUNDING:e} (N m)²")
        };
        text(format!(
            "On task D the URDF with what was named put in errs by {} (N m)² in the mean over the joints, {level}. What is left of it is the hold of the \
             torque: the loop keeps it for a millisecond and the recording has it at the start, half a millisecond before the motion that it is right for. \
             Filtering leaves far less, as positions and torques go through the same filter.",
            rounded(errors.mean, 3)
        ))
    }));
    list.push(text(
        "Mean squared torque error on task D, (N m)²; the models learned from task A, as in the paper's table I. The paper's own means stand beside ours, \
         those of its table II after learning from tasks A, B and C. It is no contest of equals: the models learn a function from 800 samples and know no \
         names; the diagnosis has all of the run, and the true cause is one number of its catalogue.",
    ));
    list.push(errors(of));
    list
}

fn found(of: &Disturbance) -> String {
    let list = |causes: &[Cause]| {
        let words = causes
            .iter()
            .map(|cause| name(&(cause.effect.clone(), cause.joint.clone())));
        words.collect::<Vec<_>>().join(", ")
    };
    let mut sentences = vec![match (of.is_one_finding, of.findings.is_empty()) {
        (true, _) => format!("The diagnosis names `{EFFECT}` and nothing else."),
        (false, true) => "The diagnosis names **nothing**.".to_owned(),
        (false, false) => format!("The diagnosis names {}, **not `{EFFECT}` alone**.", list(&of.findings)),
    }];
    sentences.extend(of.factor.as_ref().map(size));
    if of.aliases_are_all_torque_scales {
        sentences.push(
            "It says that it could as well be `torque_scale` on every joint, and nothing besides: without a known load, inertias that are too large \
             and torques that are all measured too small are one and the same."
                .to_owned(),
        );
    } else if !of.findings.is_empty() {
        let said = if of.aliases.is_empty() {
            "nothing".to_owned()
        } else {
            list(&of.aliases)
        };
        sentences.push(format!(
            "It says that it could as well be {said}, **not `torque_scale` on every joint**."
        ));
    }
    sentences.join(" ")
}

fn size(factor: &Factor) -> String {
    let bound = |bound: Option<f64>| bound.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"));
    let [low, high] = factor.ci95.map(bound);
    let holds = if factor.is_covered {
        "holds"
    } else {
        "**does not hold**"
    };
    format!(
        "The true inertias are {:.6} times the URDF's, it says; the truth is {:.6}, which is {} off. Its 95 % interval, {low} to {high}, {holds} the truth; \
         it is as wide as it is because every interval allows for a hundredth of the value, for what filtering and a form that is not quite right leave.",
        factor.value,
        factor.truth,
        rounded(factor.off.abs(), 2)
    )
}

/// Models against the diagnosis, joint by joint.
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
        rows.push(line("**as it was diagnosed**", &errors.mse, errors.mean, [None; 2]));
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
    let diagnosed = of
        .diagnosed
        .as_ref()
        .map_or_else(|| "–".to_owned(), |errors| rounded(errors.mean, 3));
    let named = match (&of.factor, of.is_one_finding) {
        (Some(factor), true) => format!("{EFFECT} × {:.6} alone (true {:.6})", factor.value, factor.truth),
        _ => format!("{} findings, not {EFFECT} alone", of.findings.len()),
    };
    format!("the paper's disturbance: {named}; torque error on task D {diagnosed} (N m)², IJL's {learned}\n")
}
