//! The closed loop in the report.

use std::collections::BTreeSet;

use report::block::{Block, table, text};
use report::numbers::rounded;
use report::score::name;
use scoring::{Name, quantile};

use super::{CaseTracking, Model};

/// What is in every case of the robot and asked of nobody.
const ORDINARY: [&str; 3] = ["coulomb_friction", "viscous_friction", "rotor_inertia"];
/// A diagnosed model is to track no worse than so many times the exact one.
const WANTED: f64 = 1.5;

/// The heading, what was done, and the table; `cases` may be none.
pub fn blocks(cases: &[CaseTracking]) -> Vec<Block> {
    let mut list = vec![Block::Heading(
        "The loop closed: what a name is worth to the controller",
    )];
    if cases.is_empty() {
        list.push(text(
            "No case was tracked: task D is a motion of the PUMA 560, and cases are tracked that were drawn on it and conceal something.",
        ));
        return list;
    }
    list.push(text(
        "On the true machine of each of these cases, with all that is concealed in it, a computed-torque controller tracks task D of the paper (10 s at \
         1 kHz, the gains of its scenario, encoders and velocity filter those of the recordings) under five models: the URDF; the URDF with what was named, \
         as `diagnose --model` wrote it; the URDF with Independent Joint Learning on the training recordings; both, the learning on top of the names; and \
         the machine's own laws. Only the feed-forward differs. (A wrist's friction depends on the joint's own speed, which IJL's inputs do not tell.) Figures \
         are the links' distance from the reference, root mean square over joints and time, in mrad.",
    ));
    list.push(text(
        "Which cases: of those drawn on the PUMA 560 that conceal something, in their order, each that brings a family that none before it brought, two \
         with something outside the catalogue among them, up to a dozen; filled up with the first of the others. It is the campaign's plan that tells, not a \
         result. The task begins as long after the last recording as recordings are apart, on their clock: what set in halfway is there, what warms has \
         warmed; contacts were events in the recordings and do not act. A delay is made up for by commanding early, an encoder's offset and a spring's give \
         by where the encoder is sent; torque limits and gaps are made up for by no model, the exact one neither.",
    ));
    let mut rows: Vec<Vec<String>> = cases.iter().map(row).collect();
    let median = |pick: &dyn Fn(&CaseTracking) -> Option<f64>| {
        let values: Vec<f64> = cases.iter().filter_map(pick).collect();
        quantile(&values, 0.5)
    };
    let without = |model: Model| median(&|case| case.error_without_lag(model));
    let mut last = vec!["**median**".to_owned(), String::new(), String::new()];
    last.extend(Model::ALL.map(|model| figure(median(&|case| case.error(model)))));
    last.push(format!("**{}**", factor(median(&CaseTracking::over_exact))));
    last.extend([Model::Diagnosed, Model::Exact].map(|model| figure(without(model))));
    last.push(factor(median(&CaseTracking::over_exact_without_lag)));
    rows.push(last);
    let mut head = vec!["case", "concealed", "named"];
    head.extend(Model::ALL.map(Model::title));
    head.extend([
        "diagnosed over exact",
        "without the filter's lag: diagnosed",
        "exact",
        "diagnosed over exact",
    ]);
    list.push(table(&head, 3, rows));
    list.push(text(format!(
        "A yardstick that forgives less: the drives filter the velocity at 40 Hz, 4 ms late, and the loop, as the one that the recordings were made in, \
         compares it with the reference's as it is. That lag, like an error of 8 % of the inertia, is most of what the exact model leaves, and hides what \
         is small beside it. In the last three columns the reference's velocity goes through the same filter, and nothing but the model is left: the exact \
         one then errs by {} mrad in the median, about a count of the encoders, the diagnosed one by {}, and the median of their ratio is {}.",
        figure(without(Model::Exact)),
        figure(without(Model::Diagnosed)),
        factor(median(&CaseTracking::over_exact_without_lag)),
    )));
    let worse: Vec<&CaseTracking> = cases
        .iter()
        .filter(|case| case.over_exact().is_some_and(|over| over > WANTED))
        .collect();
    list.push(text(if worse.is_empty() {
        format!("With what was named no case is tracked worse than {WANTED} times as the exact model does.")
    } else {
        let words: Vec<String> = worse.iter().map(|case| why(case)).collect();
        format!(
            "Worse than {WANTED} times the exact model with what was named: {}",
            words.join("; ")
        )
    }));
    list
}

/// mrad.
fn figure(error: Option<f64>) -> String {
    error.map_or_else(|| "lost".to_owned(), |error| rounded(1e3 * error, 3))
}

fn factor(ratio: Option<f64>) -> String {
    ratio.map_or_else(|| "–".to_owned(), |ratio| format!("{ratio:.2}"))
}

fn row(case: &CaseTracking) -> Vec<String> {
    let concealed = case.concealed.iter().map(|cause| {
        let onset = cause
            .onset
            .map_or_else(String::new, |onset| format!(" from {onset:.0} s"));
        format!("{}{onset}", name(&(cause.effect.clone(), cause.joint.clone())))
    });
    let named = case.named.iter().filter(|named| !ORDINARY.contains(&named.0.as_str()));
    let or_nothing = |words: Vec<String>| {
        if words.is_empty() {
            "nothing but the ordinary".to_owned()
        } else {
            words.join(", ")
        }
    };
    let named: BTreeSet<String> = named.map(name).collect();
    let mut cells = vec![
        case.case.clone(),
        or_nothing(concealed.collect()),
        or_nothing(named.into_iter().collect()),
    ];
    cells.extend(Model::ALL.map(|model| figure(case.error(model))));
    cells.push(factor(case.over_exact()));
    cells.extend([Model::Diagnosed, Model::Exact].map(|model| figure(case.error_without_lag(model))));
    cells.push(factor(case.over_exact_without_lag()));
    cells
}

/// Where the diagnosed model is worse than the exact one, and which names are missing or too many.
fn why(case: &CaseTracking) -> String {
    let of = |model: Model| case.runs.iter().find(|run| run.model == model);
    let place = of(Model::Diagnosed)
        .zip(of(Model::Exact))
        .and_then(|(diagnosed, exact)| {
            let more = diagnosed
                .rms
                .iter()
                .zip(&exact.rms)
                .map(|(a, b)| a * a - b * b)
                .enumerate();
            let (joint, _) = more.max_by(|a, b| a.1.total_cmp(&b.1))?;
            let [a, b] = [diagnosed, exact].map(|run| rounded(1e3 * run.rms[joint], 3));
            Some(format!("most on {}, {a} instead of {b} mrad", case.joints.get(joint)?))
        });
    let place = place.unwrap_or_else(|| "the arm was lost".to_owned());
    let has = |cause: &&super::Cause| case.named.contains(&(cause.effect.clone(), cause.joint.clone()));
    let missing: Vec<String> = case
        .concealed
        .iter()
        .filter(|cause| !has(cause))
        .map(|cause| name(&(cause.effect.clone(), cause.joint.clone())))
        .collect();
    let is_there = |named: &&Name| {
        ORDINARY.contains(&named.0.as_str())
            || case
                .concealed
                .iter()
                .any(|cause| (&cause.effect, &cause.joint) == (&named.0, &named.1))
    };
    let too_many: BTreeSet<String> = case.named.iter().filter(|named| !is_there(named)).map(name).collect();
    let mut reasons = Vec::new();
    if !missing.is_empty() {
        reasons.push(format!("not named: {}", missing.join(", ")));
    }
    if !too_many.is_empty() {
        let all: Vec<String> = too_many.into_iter().collect();
        reasons.push(format!("named and not there: {}", all.join(", ")));
    }
    if reasons.is_empty() {
        reasons.push("all is named; sizes or forms are a little off".to_owned());
    }
    format!("{} ({place}; {})", case.case, reasons.join("; "))
}
