//! Detection against size, and errors of numbers, over all cases.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::intervals::{Counted, quantile};
use crate::numbers::ScoredNumber;
use crate::outcome::{Fate, Outcome};

/// The detection rate against one measure of size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// The measure.
    pub measure: Measure,
    /// The bins from small to large; empty bins are omitted.
    pub bins: Vec<SizeBin>,
}

/// A measure of an effect's size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// The expressed share.
    ExpressedShare,
    /// The torque over the noise ([`Outcome::over_noise`]).
    OverNoise,
}

/// Effects of similar size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SizeBin {
    /// The lower end of the bin.
    pub from: f64,
    /// The upper end of the bin; `None` for the last bin, which has no end.
    pub to: Option<f64>,
    /// The effects found.
    pub found: Counted,
    /// The effects that are found or are an alternative of a finding.
    pub covered: Counted,
    /// The number of effects that are not found and are declared not testable; `found` counts them as not found.
    pub not_observable: usize,
}

/// The distribution of absolute relative errors, or of ratios.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// The number of values.
    pub count: usize,
    /// The median.
    pub median: Option<f64>,
    /// The 90th percentile.
    pub ninetieth: Option<f64>,
}

/// The errors of one parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterScore {
    /// The effect.
    pub effect: String,
    /// The parameter.
    pub parameter: String,
    /// Whether it is the main parameter of the effect.
    pub main: bool,
    /// Relative errors.
    pub errors: Errors,
    /// Intervals that contain the true value.
    pub covered: Counted,
}

/// The distribution of `values`.
pub fn errors(values: impl IntoIterator<Item = f64>) -> Errors {
    let values: Vec<f64> = values.into_iter().collect();
    Errors { count: values.len(), median: quantile(&values, 0.5), ninetieth: quantile(&values, 0.9) }
}

/// The detection rate against both measures of size, over all injected effects, including small ones.
pub fn curves(injected: &[Outcome]) -> Vec<Curve> {
    let shares: &[f64] = &[0.0, 0.0075, 0.015, 0.03, 0.06, 0.12, 0.25];
    let noises: &[f64] = &[0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
    vec![
        curve(Measure::ExpressedShare, shares, injected, &|outcome| outcome.share),
        curve(Measure::OverNoise, noises, injected, &|outcome| outcome.over_noise),
    ]
}

fn curve(measure: Measure, bounds: &[f64], injected: &[Outcome], size: &dyn Fn(&Outcome) -> Option<f64>) -> Curve {
    let bin = |k: usize| {
        let (from, to) = (bounds[k], bounds.get(k + 1).copied());
        let inside = |outcome: &&Outcome| size(outcome).is_some_and(|s| s >= from && to.is_none_or(|to| s < to));
        let mine: Vec<&Outcome> = injected.iter().filter(inside).collect();
        (!mine.is_empty()).then(|| SizeBin {
            from,
            to,
            found: Counted::of(mine.iter().map(|o| o.fate.is_found())),
            covered: Counted::of(mine.iter().map(|o| o.fate.is_covered())),
            not_observable: mine.iter().filter(|o| o.fate == Fate::NotObservable).count(),
        })
    };
    Curve { measure, bins: (0..bounds.len()).filter_map(bin).collect() }
}

/// The errors and intervals by effect and parameter.
pub fn parameter_scores(sizes: &[ScoredNumber]) -> Vec<ParameterScore> {
    let mut groups: BTreeMap<(&str, bool, &str), Vec<&ScoredNumber>> = BTreeMap::new();
    for sized in sizes {
        groups.entry((&sized.effect, !sized.main, &sized.parameter)).or_default().push(sized);
    }
    let score = |((effect, minor, parameter), list): ((&str, bool, &str), Vec<&ScoredNumber>)| ParameterScore {
        effect: effect.to_owned(),
        parameter: parameter.to_owned(),
        main: !minor,
        errors: errors(list.iter().map(|sized| sized.error)),
        covered: Counted::of(list.iter().map(|sized| sized.covered)),
    };
    groups.into_iter().map(score).collect()
}
