//! The sums over all cases: ground truths against diagnoses.

use std::collections::{BTreeMap, BTreeSet};

use crate::calibration::calibration;
use crate::catalogue::brings;
use crate::controls::{HeldOut, held_out};
use crate::experiments::experiments;
use crate::intervals::Counted;
use crate::numbers::ScoredNumber;
use crate::outcome::{CaseOutcome, FalseName, Fate, Outcome, OutsideOutcome, outcomes};
use crate::plain::plain;
use crate::score::{Family, Score};
use crate::strict::{UrdfError, UrdfGroup, strict};
use crate::summary::{curves, errors, parameter_scores};
use crate::targets::targets;
use crate::tried::Tried;
use crate::truth::Injected;

/// Scores `cases`, which are in the order of their names.
pub fn score(cases: &[Tried]) -> Score {
    let all: Vec<_> = cases.iter().map(outcomes).collect();
    let injected: Vec<Outcome> = all.iter().flat_map(|case| case.injected.clone()).collect();
    let false_names: Vec<FalseName> = all.iter().flat_map(|case| case.false_names.clone()).collect();
    let outside: Vec<OutsideOutcome> = all.iter().filter_map(|case| case.outside.clone()).collect();
    let refusals: Vec<OutsideOutcome> = all.iter().filter_map(|case| case.refused_without_cause.clone()).collect();
    let families = families(&injected, &false_names);
    let sizes: Vec<ScoredNumber> = all.iter().flat_map(|case| case.sizes.clone()).collect();
    let special: Vec<&ScoredNumber> =
        all.iter().flat_map(|case| case.sizes.iter().filter(|s| !case.is_baseline(s))).collect();
    let held: Vec<HeldOut> = cases
        .iter()
        .filter_map(|case| {
            let answer = case.answer.as_ref()?;
            Some(held_out(&case.truth, answer, case.true_terms.as_ref(), case.wrong_term.as_ref()))
        })
        .collect();
    // A case without an answer names no effect, which must not count as correct.
    let answered = || all.iter().zip(cases).filter_map(|(outcome, case)| case.answer.is_some().then_some(outcome));
    let asked: Vec<&Outcome> = injected.iter().filter(|outcome| outcome.is_asked()).collect();
    let mut score = Score {
        cases: cases.len(),
        unanswered: cases.iter().filter(|c| c.answer.is_none()).map(|c| c.truth.case.clone()).collect(),
        empty: all.iter().filter(|case| case.is_empty).count(),
        targets: Vec::new(),
        strict: strict(all.iter().zip(cases).map(|(outcome, case)| (outcome, case.answer.is_some()))),
        by_urdf: by_urdf(cases, &all),
        experiments: experiments(cases),
        macro_f1: mean(&families, |family| family.f1),
        macro_f1_strict: mean(&families, |family| family.f1_strict),
        families,
        baseline: Counted::of(all.iter().flat_map(|case| case.baseline_found.iter().copied())),
        baseline_false: all.iter().map(|case| case.baseline_false).sum(),
        empty_with_a_false_name: Counted::of(
            answered().filter(|case| case.is_empty).map(|case| !case.false_names.is_empty()),
        ),
        outside_refused: Counted::of(outside.iter().map(|case| case.refused)),
        outside_with_a_wrong_name: Counted::of(
            answered().filter_map(|case| case.outside.as_ref()).map(|case| !case.named.is_empty()),
        ),
        refused_without_cause: Counted::of(
            answered().filter(|case| case.outside.is_none()).map(|case| case.refused_without_cause.is_some()),
        ),
        covered: Counted::of(asked.iter().map(|o| o.fate.is_covered())),
        covered_strict: Counted::of(injected.iter().filter(|o| o.counts).map(|o| o.fate.is_covered())),
        detection: curves(&injected),
        parameters: parameter_scores(&sizes),
        main_parameters: errors(special.iter().filter(|s| s.main).map(|s| s.error)),
        intervals: Counted::of(special.iter().map(|s| s.covered)),
        over_true_terms: errors(held.iter().filter(|case| case.has_all_terms()).filter_map(HeldOut::over_true_terms)),
        over_true_terms_by_joint: errors(cases.iter().flat_map(by_joint)),
        tracking_over_exact: errors(cases.iter().filter_map(|case| case.tracking_over_exact)),
        tracking_over_exact_without_lag: errors(cases.iter().filter_map(|case| case.tracking_over_exact_without_lag)),
        confusion: confusion(&injected, &false_names, &outside),
        calibration: calibration(&all.iter().flat_map(|case| case.said.clone()).collect::<Vec<_>>()),
        calibration_of_all: calibration(&all.iter().flat_map(|case| case.said_of_all.clone()).collect::<Vec<_>>()),
        plain: plain(cases),
        injected,
        false_names,
        outside,
        refusals_without_cause: refusals,
        sizes,
        held_out: held,
    };
    score.targets = targets(&score);
    score
}

/// The mean over the families that have a figure.
fn mean(families: &BTreeMap<String, Family>, pick: impl Fn(&Family) -> Option<f64>) -> Option<f64> {
    let values: Vec<f64> = families.values().filter_map(pick).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The cases in groups by the error of their URDFs.
fn by_urdf(cases: &[Tried], all: &[CaseOutcome]) -> Vec<UrdfGroup> {
    let group = |urdf: UrdfError| {
        let mine: Vec<(&CaseOutcome, bool)> = all
            .iter()
            .zip(cases)
            .filter(|(_, case)| UrdfError::of(case.truth.urdf_sigma) == urdf)
            .map(|(outcome, case)| (outcome, case.answer.is_some()))
            .collect();
        let injected: Vec<Outcome> = mine.iter().flat_map(|(case, _)| case.injected.clone()).collect();
        let false_names: Vec<FalseName> = mine.iter().flat_map(|(case, _)| case.false_names.clone()).collect();
        (!mine.is_empty()).then(|| UrdfGroup {
            urdf,
            cases: mine.len(),
            macro_f1: mean(&families(&injected, &false_names), |family| family.f1),
            strict: strict(mine.iter().copied()),
        })
    };
    UrdfError::ALL.into_iter().filter_map(group).collect()
}

fn families(injected: &[Outcome], false_names: &[FalseName]) -> BTreeMap<String, Family> {
    let mut families: BTreeMap<String, Family> = BTreeMap::new();
    for outcome in injected {
        let family = families.entry(outcome.effect.clone()).or_default();
        if !outcome.counts {
            family.too_small += 1;
            family.too_small_found += usize::from(outcome.fate.is_found());
            continue;
        }
        family.injected += 1;
        family.found += usize::from(outcome.fate.is_found());
        family.same_machine += usize::from(outcome.fate == Fate::SameMachine);
        family.covered += usize::from(outcome.fate.is_covered());
        family.not_observable += usize::from(outcome.fate == Fate::NotObservable);
        family.refused += usize::from(outcome.fate == Fate::Refused);
    }
    for false_name in false_names {
        families.entry(false_name.effect.clone()).or_default().false_names += 1;
    }
    // How often a family's name was given as an equivalent name, without accompanying the injected effect.
    let mut given: BTreeMap<&str, usize> = BTreeMap::new();
    for outcome in injected {
        let name = outcome.found_as.as_ref();
        if let Some((name, _)) = name.filter(|(name, _)| !brings(&outcome.effect).contains(&name.as_str())) {
            *given.entry(name).or_default() += 1;
        }
    }
    for (name, family) in &mut families {
        let f1 = |asked: usize, found: usize, false_names: usize| {
            (asked > 0).then(|| 2.0 * found as f64 / (asked + found + false_names) as f64)
        };
        family.f1 = f1(family.asked(), family.found, family.false_names);
        let strictly_false = family.false_names + given.get(name.as_str()).copied().unwrap_or(0);
        family.f1_strict = f1(family.injected, family.found - family.same_machine, strictly_false);
    }
    families
}

/// The held-out errors with the diagnosed effects over those with the true terms, joint by joint, of a case with no effect
/// outside the catalogue.
fn by_joint(case: &Tried) -> Vec<f64> {
    let (Some(answer), Some(oracle)) = (&case.answer, &case.true_terms) else {
        return Vec::new();
    };
    let is_beside = |injected: &Injected| injected.is_outside_the_catalogue() || injected.minor;
    if case.truth.has_a_wrong_urdf() || case.truth.injected.iter().any(is_beside) {
        return Vec::new();
    }
    let ratio = |(joint, fit): (&String, &crate::answer::JointErrors)| -> Option<f64> {
        let best = oracle.fit.get(joint)?.held_out_nrmse_augmented?;
        Some(fit.held_out_nrmse_augmented? / best.max(1e-12))
    };
    answer.fit.iter().filter_map(ratio).collect()
}

/// Rows: the injected and required effects, "outside the catalogue", "nothing there". Columns: names, "refused", "not
/// testable", "not named".
fn confusion(
    injected: &[Outcome],
    false_names: &[FalseName],
    outside: &[OutsideOutcome],
) -> BTreeMap<String, BTreeMap<String, usize>> {
    let mut matrix: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    let mut add = |row: &str, column: &str| {
        *matrix.entry(row.to_owned()).or_default().entry(column.to_owned()).or_default() += 1;
    };
    let mut explained: BTreeSet<(&str, &str, Option<&str>)> = BTreeSet::new();
    for outcome in injected.iter().filter(|outcome| outcome.counts) {
        let instead = outcome.instead.first();
        let column = match (outcome.fate, instead) {
            (Fate::Found | Fate::SameMachine, _) => outcome.effect.as_str(),
            (_, Some(name)) => name.0.as_str(),
            (Fate::NotObservable, None) => "not observable",
            (Fate::Refused, None) => "refused",
            (Fate::Covered | Fate::Missed, None) => "not named",
        };
        if let (false, Some(name)) = (outcome.fate.is_found(), instead) {
            explained.insert((&outcome.case, &name.0, name.1.as_deref()));
        }
        add(&outcome.effect, column);
    }
    for case in outside {
        match (case.named.first(), case.refused) {
            (Some(name), _) => add("outside the catalogue", &name.0),
            (None, true) => add("outside the catalogue", "refused"),
            (None, false) => add("outside the catalogue", "not named"),
        }
    }
    for name in false_names {
        let is_known = explained.contains(&(&name.case, &name.effect, name.joint.as_deref()));
        if !is_known && !outside.iter().any(|case| case.case == name.case) {
            add("nothing there", &name.effect);
        }
    }
    matrix
}
