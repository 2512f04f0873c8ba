//! The count of the open cases' own script: every injected fault counts, whatever its size, and faults declared not testable
//! count as missed.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::answer::Answer;
use crate::rules::{Key, Name, found, found_or_confusable, is_baseline, plainly_counted_findings};
use crate::tried::Tried;

/// The results of the script.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Plain {
    /// Found and injected, by family.
    pub families: BTreeMap<String, [usize; 2]>,
    /// False names that are not baseline, by family.
    pub false_names: BTreeMap<String, usize>,
    /// The numbers of baseline effects that are injected, found, and named falsely.
    #[serde(rename = "ordinary")]
    pub baseline: [usize; 3],
    /// Injected effects that are not baseline effects.
    #[serde(rename = "concealed")]
    pub injected: usize,
    /// Injected effects that are found.
    pub found: usize,
    /// Injected effects that are found, or are an alternative of a finding.
    pub covered: usize,
    /// Cases with only baseline effects.
    pub empty: usize,
    /// Cases with only baseline effects in which no other effect is named.
    pub clean: usize,
    /// Cases with an effect outside the catalogue.
    pub outside: usize,
    /// Cases with an effect outside the catalogue in which the right joint is refused.
    pub refused: usize,
    /// Cases with an unexplained joint and no effect outside the catalogue.
    pub refused_without_cause: usize,
    /// Cases without an answer.
    pub missing: usize,
    /// The median over joints of the held-out error with the findings over the nominal one.
    pub held_out: Option<f64>,
    /// F1 over all effects.
    pub micro_f1: f64,
    /// F1 averaged over the injected families.
    pub macro_f1: f64,
}

impl Plain {
    /// All false names.
    pub fn false_in_all(&self) -> usize {
        self.false_names.values().sum()
    }
}

/// Counts `cases`.
pub fn plain(cases: &[Tried]) -> Plain {
    let mut count = Plain::default();
    let mut ratios = Vec::new();
    for case in cases {
        let key = Key::new(&case.truth);
        let empty = Answer::default();
        let answer = &plainly_counted_findings(&case.truth, case.answer.as_ref().unwrap_or(&empty));
        count.missing += usize::from(case.answer.is_none());
        let (named, sets) = (found(answer), found_or_confusable(answer));
        let baseline = |name: &Name| is_baseline(&case.truth, &name.0);
        for name in &key.known {
            let is_found = usize::from(named.contains(name));
            if baseline(name) {
                count.baseline[0] += 1;
                count.baseline[1] += is_found;
                continue;
            }
            let family = count.families.entry(name.0.clone()).or_default();
            family[0] += is_found;
            family[1] += 1;
            count.injected += 1;
            count.found += is_found;
            count.covered += usize::from(sets.contains(name));
        }
        for name in named.iter().filter(|name| !key.allows(name)) {
            if baseline(name) {
                count.baseline[2] += 1;
            } else {
                *count.false_names.entry(name.0.clone()).or_default() += 1;
            }
        }
        if key.unknown.is_empty() && key.known.iter().all(baseline) {
            count.empty += 1;
            count.clean += usize::from(named.iter().all(baseline));
        }
        let left: Vec<&String> = answer.unexplained.iter().map(|left| &left.joint).collect();
        if key.unknown.is_empty() {
            count.refused_without_cause += usize::from(!left.is_empty());
        } else {
            count.outside += 1;
            let is_left = |(_, joint): &Name| joint.as_ref().is_some_and(|joint| left.contains(&joint));
            count.refused += usize::from(key.unknown.iter().any(is_left));
        }
        for fit in answer.fit.values() {
            if let (Some(nominal), Some(diagnosed)) = (fit.held_out_nrmse_nominal, fit.held_out_nrmse_augmented)
                && nominal > 0.0
            {
                ratios.push(diagnosed / nominal);
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    count.held_out = ratios.get(ratios.len() / 2).copied();
    let (tp, fp) = (count.found as f64, count.false_in_all() as f64);
    let (precision, recall) = (tp / f64::max(1.0, tp + fp), tp / (count.injected as f64).max(1.0));
    count.micro_f1 = 2.0 * precision * recall / (precision + recall).max(1e-9);
    let f1 = |(name, &[found, injected]): (&String, &[usize; 2])| {
        let wrong = count.false_names.get(name).copied().unwrap_or(0);
        2.0 * found as f64 / (injected + found + wrong) as f64
    };
    count.macro_f1 = count.families.iter().map(f1).sum::<f64>() / count.families.len().max(1) as f64;
    count
}
