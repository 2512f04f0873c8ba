//! The strict figure: every effect of sufficient size is required, every name that is not true is false, and the size must
//! be right.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::catalogue::brings;
use crate::intervals::Counted;
use crate::numbers::ScoredNumber;
use crate::outcome::{CaseOutcome, Fate};

/// The largest relative error of a size that counts as right.
pub const SIZE_WITHIN: f64 = 0.2;

/// Cases, counted strictly: effects declared not testable are required, equivalent names are false, and a size that can be
/// compared must be within [`SIZE_WITHIN`] of the true one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Strict {
    /// F1 averaged over the families that are injected.
    pub macro_f1: Option<f64>,
    /// Effects found with their size, of those required.
    pub right: Counted,
    /// Required effects that are named with another size.
    pub wrong_size: usize,
    /// Names that are not true.
    pub false_names: usize,
    /// False names of baseline effects, which are not in [`Self::macro_f1`].
    #[serde(rename = "ordinary_false")]
    pub baseline_false: usize,
    /// Cases with a false name that is not a baseline effect, of those with an answer.
    pub cases_with_a_false_name: Counted,
    /// 95 % intervals that contain the true value, for effects that are not baseline effects.
    pub intervals: Counted,
    /// The figures by family.
    pub families: BTreeMap<String, StrictFamily>,
}

/// The effects of one name, counted strictly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StrictFamily {
    /// Injected with an expressed share from which an effect is required.
    pub asked: usize,
    /// Required effects that are found with the right size.
    pub right: usize,
    /// Required effects that are named with another size.
    pub wrong_size: usize,
    /// Named where they are not injected.
    pub false_names: usize,
    /// F1 = 2 right / (required + right + wrong size + false): twice the right names over the sum of all required and all
    /// given names.
    pub f1: Option<f64>,
}

/// Counts cases, each with whether it was answered.
pub fn strict<'a>(cases: impl Iterator<Item = (&'a CaseOutcome, bool)>) -> Strict {
    let mut families: BTreeMap<String, StrictFamily> = BTreeMap::new();
    let (mut baseline_false, mut clean, mut held) = (0, Vec::new(), Vec::new());
    for (case, answered) in cases {
        baseline_false += case.baseline_false;
        let mut false_names: Vec<&str> = case.false_names.iter().map(|name| name.effect.as_str()).collect();
        for outcome in &case.injected {
            if let Some((name, _)) = &outcome.found_as
                && !brings(&outcome.effect).contains(&name.as_str())
            {
                false_names.push(name);
            }
            if !outcome.counts {
                continue;
            }
            let family = families.entry(outcome.effect.clone()).or_default();
            family.asked += 1;
            if outcome.fate == Fate::Found {
                let is_its = |sized: &&ScoredNumber| {
                    (&sized.effect, &sized.joint, sized.main) == (&outcome.effect, &outcome.joint, true)
                };
                // If the size cannot be compared, the name alone counts.
                match case.sizes.iter().find(is_its).is_none_or(|sized| sized.error <= SIZE_WITHIN) {
                    true => family.right += 1,
                    false => family.wrong_size += 1,
                }
            }
        }
        if answered {
            clean.push(!false_names.is_empty());
        }
        for name in false_names {
            families.entry(name.to_owned()).or_default().false_names += 1;
        }
        held.extend(case.sizes.iter().filter(|sized| !case.is_baseline(sized)).map(|sized| sized.covered));
    }
    for family in families.values_mut() {
        let StrictFamily { asked, right, .. } = *family;
        let all = asked + right + family.wrong_size + family.false_names;
        family.f1 = (asked > 0).then(|| 2.0 * right as f64 / all as f64);
    }
    let scores: Vec<f64> = families.values().filter_map(|family| family.f1).collect();
    let sum = |of: fn(&StrictFamily) -> usize| families.values().map(of).sum::<usize>();
    Strict {
        macro_f1: (!scores.is_empty()).then(|| scores.iter().sum::<f64>() / scores.len() as f64),
        right: Counted::new(sum(|family| family.right), sum(|family| family.asked)),
        wrong_size: sum(|family| family.wrong_size),
        false_names: sum(|family| family.false_names),
        baseline_false,
        cases_with_a_false_name: Counted::of(clean),
        intervals: Counted::of(held),
        families,
    }
}

/// The error of the inertials in the URDF of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UrdfError {
    /// Exact, apart from the injected faults.
    Exact,
    /// Less than 20 %, as of a robot that was measured or modelled with care.
    Some,
    /// 20 % or more, as of masses from a CAD model without cables and covers.
    Much,
}

impl UrdfError {
    /// All groups, from exact to the largest error.
    pub const ALL: [Self; 3] = [Self::Exact, Self::Some, Self::Much];

    /// The group of a relative error `sigma`; `None` is an exact URDF.
    pub fn of(sigma: Option<f64>) -> Self {
        match sigma.unwrap_or(0.0) {
            0.0 => Self::Exact,
            sigma if sigma < 0.2 => Self::Some,
            _ => Self::Much,
        }
    }

    /// The group in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Some => "wrong by less than 20 %",
            Self::Much => "wrong by 20 % or more",
        }
    }
}

/// The figures of the cases in one group.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UrdfGroup {
    /// The error of the URDF.
    pub urdf: UrdfError,
    /// The number of cases.
    pub cases: usize,
    /// F1 averaged over the families, not counted strictly.
    pub macro_f1: Option<f64>,
    /// The strict figures of the cases.
    pub strict: Strict,
}
