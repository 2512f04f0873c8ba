//! The results of a proof, as blocks of its report.

use std::collections::{BTreeMap, BTreeSet};

use scoring::{Errors, Family, HeldOut, Measure, Score, quantile};

use super::figures;
use super::words::{counted, number, share};
use crate::block::{Block, table, text};
use crate::numbers::percent_to_a_tenth as percent;

/// Detection by family and by size, and the confusion matrix.
pub fn found(score: &Score) -> Vec<Block> {
    let line = |(name, f): (&String, &Family)| {
        vec![
            format!("`{name}`"),
            f.injected.to_string(),
            f.found.to_string(),
            f.same_machine.to_string(),
            (f.covered - f.found).to_string(),
            f.refused.to_string(),
            f.not_observable.to_string(),
            (f.injected - f.covered - f.refused - f.not_observable).to_string(),
            f.false_names.to_string(),
            number(f.f1),
            format!("{} of {}", f.too_small_found, f.too_small),
        ]
    };
    let head = [
        "effect",
        "injected",
        "found",
        "of these by an equivalent name",
        "alternative only",
        "joint refused",
        "declared not testable",
        "missed",
        "named falsely",
        "F1",
        "found of those below the required size",
    ];
    let mut list = vec![
        Block::Heading("Effects found"),
        text(format!(
            "An effect is found if its name and its joint are named. Effects that accompany it (Coulomb friction beside a friction curve, rotor inertia behind a \
             spring) count as neither right nor wrong. Baseline friction, and the rotor inertia of the PUMA, are counted separately: found {}, {} false. F1 \
             excludes effects that a diagnosis declares not testable at their size. It treats asymmetric friction, and a torque offset beside Coulomb friction, \
             as equivalent if the diagnosis lists each as an alternative of the other, because both give the same recording in simulation. If the former count \
             as missed and the latter as false, macro F1 is {} instead of {}.",
            counted(&score.baseline),
            score.baseline_false,
            number(score.macro_f1_strict),
            number(score.macro_f1),
        )),
        table(&head, 1, score.families.iter().map(line).collect()),
    ];
    for curve in &score.detection {
        let is_share = curve.measure == Measure::ExpressedShare;
        let caption = if is_share {
            "Detection rate against the effect's expressed share, with Wilson's 95 % interval. Hollow circles: found or an alternative of a finding."
        } else {
            "Detection rate against the effect's signal-to-noise ratio: the standard deviation of its torque over that of the noise on one sample of its joint's torque."
        };
        list.push(Block::Figure { svg: figures::detection(curve), caption: caption.into() });
        let rows = curve.bins.iter().map(|bin| {
            let show = |value: f64| if is_share { percent(value) } else { format!("{value}") };
            let to = bin.to.map_or_else(|| "more".to_owned(), show);
            let covered = format!("{} of {}", bin.covered.hits, bin.covered.of);
            vec![format!("{} to {to}", show(bin.from)), counted(&bin.found), covered, bin.not_observable.to_string()]
        });
        let size = if is_share { "expressed share" } else { "signal-to-noise ratio" };
        let head = [size, "found", "found or alternative", "declared not testable"];
        list.push(table(&head, 1, rows.collect()));
    }
    list.push(text(format!(
        "Cases without an injected fault in which an effect is named: {}. Effects outside the catalogue that are refused on the right joint: {}; that get a wrong name on any joint: {}. \
         Refusals in cases with nothing outside the catalogue: {}.",
        counted(&score.empty_with_a_false_name),
        counted(&score.outside_refused),
        counted(&score.outside_with_a_wrong_name),
        counted(&score.refused_without_cause),
    )));
    list.push(Block::Heading("Confusion matrix"));
    list.extend(confusion(&score.confusion));
    list
}

/// The matrix; columns have numbers, which the rows' names explain, so that it stays narrow.
fn confusion(matrix: &BTreeMap<String, BTreeMap<String, usize>>) -> Vec<Block> {
    const IN_WORDS: [&str; 5] = ["outside the catalogue", "nothing there", "refused", "not observable", "not named"];
    let label = |name: &str| name.replace('_', " ");
    let is_effect = |name: &&String| !IN_WORDS.contains(&name.as_str());
    let all = matrix.keys().chain(matrix.values().flat_map(BTreeMap::keys));
    let effects: BTreeSet<&String> = all.filter(is_effect).collect();
    let words = IN_WORDS.iter().map(|&word| word.to_owned());
    let rows: Vec<String> = effects.iter().map(|&name| name.clone()).chain(words.clone().take(2)).collect();
    let columns: Vec<String> = effects.iter().map(|&name| name.clone()).chain(words.skip(2)).collect();
    let mut head = vec!["injected ↓, named →".to_owned()];
    head.extend(columns.iter().enumerate().map(|(k, name)| match k < effects.len() {
        true => (k + 1).to_string(),
        false => label(name),
    }));
    let row = |(k, name): (usize, &String)| {
        let cells = matrix.get(name);
        let cell = |column: &String| match cells.and_then(|cells| cells.get(column)) {
            Some(count) if column == name => format!("**{count}**"),
            Some(count) => count.to_string(),
            None => String::new(),
        };
        let number = if k < effects.len() { format!("{} ", k + 1) } else { String::new() };
        let mut row = vec![format!("{number}{}", label(name))];
        row.extend(columns.iter().map(cell));
        row
    };
    vec![
        text(
            "An injected effect that is not found is counted under the largest false name on its joint, or under the answer given instead. A false name that replaces \
             no injected effect is in the row \"nothing there\".",
        ),
        Block::Table { rows: rows.iter().enumerate().map(row).collect(), head, words: 1 },
    ]
}

fn two(errors: &Errors) -> [String; 2] {
    [share(errors.median), share(errors.ninetieth)]
}

/// Errors and intervals of parameters.
pub fn numbers(score: &Score) -> Vec<Block> {
    let rows = score.parameters.iter().map(|p| {
        let [median, ninetieth] = two(&p.errors);
        let parameter = if p.main { format!("**{}**", p.parameter) } else { p.parameter.clone() };
        vec![format!("`{}`", p.effect), parameter, p.errors.count.to_string(), median, ninetieth, counted(&p.covered)]
    });
    let head = [
        "effect",
        "parameter",
        "found",
        "median error",
        "90th percentile",
        "95 % intervals that contain the ground truth",
    ];
    let [median, ninetieth] = two(&score.main_parameters);
    vec![
        Block::Heading("Parameter errors"),
        text(format!(
            "For the effects found, without baseline effects, the error of the main parameter (bold) is {median} in the median and \
             {ninetieth} at the 90th percentile; the 95 % intervals of all parameters contain the ground truth in {}. The error of a factor is relative to its distance \
             from one. Where two forms of Coulomb friction act on one joint, their levels are not compared, because the split between them is arbitrary.",
            counted(&score.intervals),
        )),
        table(&head, 2, rows.collect()),
    ]
}

/// Held-out errors.
pub fn controls(score: &Score) -> Vec<Block> {
    let cases: Vec<&HeldOut> = score.held_out.iter().filter(|case| case.has_all_terms()).collect();
    let of = |label: &str, pick: &dyn Fn(&HeldOut) -> Option<f64>| {
        let errors: Vec<f64> = cases.iter().filter_map(|case| pick(case)).collect();
        let ratios: Vec<f64> =
            cases.iter().filter_map(|case| Some(pick(case)? / case.true_terms?.max(1e-12))).collect();
        let show = |values: &[f64], at: f64| quantile(values, at).map_or_else(|| "–".into(), |v| format!("{v:.3}"));
        vec![
            label.to_owned(),
            errors.len().to_string(),
            show(&errors, 0.5),
            show(&errors, 0.9),
            show(&ratios, 0.5),
            show(&ratios, 0.9),
        ]
    };
    let head = ["model", "cases", "median", "90th percentile", "over the true terms, median", "90th percentile"];
    let rows = vec![
        of("nominal model", &|case| case.nominal),
        of("a wrong term in place of a true one", &|case| case.wrong_term),
        of("learned correction alone", &|case| case.learned),
        of("**diagnosed model**", &|case| case.diagnosed),
        of("the true terms", &|case| case.true_terms),
    ];
    vec![
        Block::Heading("Comparison with controls"),
        text(format!(
            "Errors on the held-out recording (NRMSE, root mean square over the joints), in cases with an exact URDF, with nothing outside the catalogue and without \
             minor effects. \"The true terms\" are fitted to the same recordings after the ground truth is opened, by name and without a search; \"a wrong term\" replaces \
             the largest effect by another one on the same joint. For single joints, the error of the diagnosed model over that of the true terms is {} in the median and {} \
             at the 90th percentile.",
            number(score.over_true_terms_by_joint.median),
            number(score.over_true_terms_by_joint.ninetieth),
        )),
        table(&head, 1, rows),
    ]
}

/// Probabilities.
pub fn calibration(score: &Score) -> Vec<Block> {
    let rows =
        score.calibration.bins.iter().map(|bin| {
            vec![format!("{:.2} to {:.2}", bin.from, bin.to), format!("{:.3}", bin.said), counted(&bin.right)]
        });
    vec![
        Block::Heading("Calibration of the probabilities"),
        text(format!(
            "Findings without the baseline effects, by their stated probability. The Brier score is {}, and the mean calibration error is {}; for all findings they are {} and {}.",
            number(score.calibration.brier),
            number(score.calibration.error),
            number(score.calibration_of_all.brier),
            number(score.calibration_of_all.error),
        )),
        Block::Figure {
            svg: figures::calibration(&score.calibration),
            caption: "Share of correct findings against the stated probability; on the line, both are equal.".into(),
        },
        table(&["probability", "mean stated probability", "correct"], 1, rows.collect()),
    ]
}
