//! The closed loop in the report.

use std::collections::BTreeSet;

use report::block::{Block, table, text};
use report::numbers::rounded;
use report::score::name;
use scoring::{BASELINE_WITH_DRIVES, Name, quantile};

use super::{CaseTracking, Model};

/// The target for the tracking error with a diagnosed model over that with the exact one.
const WANTED: f64 = 1.5;

/// The section: heading, description and table; `cases` may be empty.
pub fn blocks(cases: &[CaseTracking]) -> Vec<Block> {
    let mut list = vec![Block::Heading("Closed-loop tracking with the diagnosed model")];
    if cases.is_empty() {
        list.push(text(
            "No case was tracked: task D is a motion of the PUMA 560, and only cases with an injected fault on that robot are tracked.",
        ));
        return list;
    }
    list.push(text(
        "On the true machine of each of these cases, with all injected faults, a computed-torque controller tracks task D of the paper (10 s at \
         1 kHz, with the gains of its scenario and the encoders and velocity filter of the recordings) with five models: the URDF; the URDF with the named effects, \
         as written by `diagnose --model`; the URDF with Independent Joint Learning (IJL) on the training recordings; the URDF with the named effects and IJL; and \
         the machine's own laws. Only the feed-forward differs. (The friction of a wrist depends on the joint velocity, which is not an input of IJL.) The figures \
         are the RMS tracking errors of the links over joints and time, in mrad.",
    ));
    list.push(text(
        "Selection of the cases: of the cases with an injected fault on the PUMA 560, in their order, each case that adds an effect family to the preceding ones, \
         including two with an effect outside the catalogue, up to twelve; the first of the other cases complete the list. The selection depends on the campaign's plan \
         and not on results. The task begins after the last recording, with the same pause as between recordings: effects with an onset are present, and drives \
         are warm; contacts are events of the recordings and do not act. A delay is compensated by an earlier command, an encoder offset and the deflection of an elastic \
         drive by a corrected encoder reference; no model, including the exact one, compensates torque limits and backlash.",
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
    let mut head = vec!["case", "injected", "named"];
    head.extend(Model::ALL.map(Model::title));
    head.extend(["diagnosed over exact", "without the filter's lag: diagnosed", "exact", "diagnosed over exact"]);
    list.push(table(&head, 3, rows));
    list.push(text(format!(
        "A stricter measure: the drives filter the velocity at 40 Hz, which delays it by 4 ms, and the loop compares it with the unfiltered reference \
         velocity, as in the recordings. That lag acts like an inertia error of 8 %, accounts for most of the error with the exact model, and masks smaller errors. \
         In the last three columns, the reference velocity passes the same filter, so that only model errors remain: the median error is {} mrad with the exact \
         model, which is about one encoder count, and {} mrad with the diagnosed one, and the median of their ratio is {}.",
        figure(without(Model::Exact)),
        figure(without(Model::Diagnosed)),
        factor(median(&CaseTracking::over_exact_without_lag)),
    )));
    let worse: Vec<&CaseTracking> =
        cases.iter().filter(|case| case.over_exact().is_some_and(|over| over > WANTED)).collect();
    list.push(text(if worse.is_empty() {
        format!("With the named effects, the tracking error of no case exceeds {WANTED} times that of the exact model.")
    } else {
        let words: Vec<String> = worse.iter().map(|case| why(case)).collect();
        format!(
            "With the named effects, the tracking error exceeds {WANTED} times that of the exact model in: {}",
            words.join("; ")
        )
    }));
    list
}

/// An error in mrad.
fn figure(error: Option<f64>) -> String {
    error.map_or_else(|| "unstable".to_owned(), |error| rounded(1e3 * error, 3))
}

fn factor(ratio: Option<f64>) -> String {
    ratio.map_or_else(|| "–".to_owned(), |ratio| format!("{ratio:.2}"))
}

/// The names in words; an effect on more than two joints is one entry with their number.
fn grouped<'a>(names: impl IntoIterator<Item = &'a Name>) -> Vec<String> {
    let mut groups: Vec<Vec<&Name>> = Vec::new();
    for name in names {
        match groups.iter_mut().find(|group| group[0].0 == name.0) {
            Some(group) => group.push(name),
            None => groups.push(vec![name]),
        }
    }
    let words = groups.into_iter().flat_map(|group| match group.as_slice() {
        few @ ([_] | [_, _]) => few.iter().map(|of| name(of)).collect(),
        many => vec![format!("`{}` on {} joints", many[0].0, many.len())],
    });
    words.collect()
}

fn row(case: &CaseTracking) -> Vec<String> {
    let injected = case.injected.iter().map(|effect| {
        let onset = effect.onset.map_or_else(String::new, |onset| format!(" from {onset:.0} s"));
        format!("{}{onset}", name(&(effect.effect.clone(), effect.joint.clone())))
    });
    let named = case.named.iter().filter(|named| !BASELINE_WITH_DRIVES.contains(&named.0.as_str()));
    let or_nothing = |words: Vec<String>| {
        if words.is_empty() { "baseline effects only".to_owned() } else { words.join(", ") }
    };
    let named: BTreeSet<&Name> = named.collect();
    let mut cells = vec![case.case.clone(), or_nothing(injected.collect()), or_nothing(grouped(named))];
    cells.extend(Model::ALL.map(|model| figure(case.error(model))));
    cells.push(factor(case.over_exact()));
    cells.extend([Model::Diagnosed, Model::Exact].map(|model| figure(case.error_without_lag(model))));
    cells.push(factor(case.over_exact_without_lag()));
    cells
}

/// The joint on which the diagnosed model is worse than the exact one, and the names that are missing or false.
fn why(case: &CaseTracking) -> String {
    let of = |model: Model| case.runs.iter().find(|run| run.model == model);
    let place = of(Model::Diagnosed).zip(of(Model::Exact)).and_then(|(diagnosed, exact)| {
        let more = diagnosed.rms.iter().zip(&exact.rms).map(|(a, b)| a * a - b * b).enumerate();
        let (joint, _) = more.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let [a, b] = [diagnosed, exact].map(|run| rounded(1e3 * run.rms[joint], 3));
        Some(format!("largest on {}, {a} instead of {b} mrad", case.joints.get(joint)?))
    });
    let place = place.unwrap_or_else(|| "unstable".to_owned());
    let has = |effect: &&super::InjectedEffect| case.named.contains(&(effect.effect.clone(), effect.joint.clone()));
    let missing: Vec<Name> = case
        .injected
        .iter()
        .filter(|effect| !has(effect))
        .map(|effect| (effect.effect.clone(), effect.joint.clone()))
        .collect();
    let is_there = |named: &&Name| {
        BASELINE_WITH_DRIVES.contains(&named.0.as_str())
            || case.injected.iter().any(|effect| (&effect.effect, &effect.joint) == (&named.0, &named.1))
    };
    let too_many: BTreeSet<&Name> = case.named.iter().filter(|named| !is_there(named)).collect();
    let mut reasons = Vec::new();
    if !missing.is_empty() {
        reasons.push(format!("not named: {}", grouped(&missing).join(", ")));
    }
    if !too_many.is_empty() {
        reasons.push(format!("named but not injected: {}", grouped(too_many).join(", ")));
    }
    if reasons.is_empty() {
        reasons.push("all effects are named; their parameters or forms are slightly wrong".to_owned());
    }
    format!("{} ({place}; {})", case.case, reasons.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_on_many_joints_is_one_entry() {
        let on = |effect: &str, joint: &str| (effect.to_owned(), Some(joint.to_owned()));
        let mut names: Vec<Name> = ["a", "b", "c"].map(|joint| on("inertial_parameters", joint)).into();
        names.extend([on("spring", "a"), on("spring", "b"), ("payload".to_owned(), None)]);
        assert_eq!(
            grouped(&names),
            ["`inertial_parameters` on 3 joints", "`spring` on a", "`spring` on b", "`payload`"]
        );
    }
}
