//! The figures that a proof must reach, and whether it does.

use serde::{Deserialize, Serialize};

use crate::intervals::Counted;
use crate::score::{Family, Score};

/// A figure that was asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// What it is.
    pub what: String,
    /// The figure; `None` if nothing was there to count.
    pub figure: Option<f64>,
    /// At least this …
    pub at_least: Option<f64>,
    /// … and at most that.
    pub at_most: Option<f64>,
    /// What it was counted from, where it is a share.
    pub counted: Option<Counted>,
    /// Over how many.
    pub of: usize,
    /// Whether it is reached; `None` if nothing was there to count, or nothing is wanted of it: it says more of the one above.
    pub reached: Option<bool>,
}

fn target(what: &str, figure: Option<f64>, [at_least, at_most]: [Option<f64>; 2], of: usize) -> Target {
    let is_within = |figure: f64| at_least.is_none_or(|low| figure >= low) && at_most.is_none_or(|high| figure <= high);
    Target {
        what: what.to_owned(),
        figure,
        at_least,
        at_most,
        counted: None,
        of,
        reached: figure
            .map(is_within)
            .filter(|_| at_least.is_some() || at_most.is_some()),
    }
}

fn share(what: &str, counted: Counted, bounds: [Option<f64>; 2]) -> Target {
    Target {
        counted: Some(counted),
        ..target(what, counted.share(), bounds, counted.of)
    }
}

/// What is asked of `score`.
pub fn targets(score: &Score) -> Vec<Target> {
    let at_least = |value: f64| [Some(value), None];
    let at_most = |value: f64| [None, Some(value)];
    let asked: usize = score.families.values().map(Family::asked).sum();
    let (main, over) = (score.main_parameters, score.over_true_terms);
    let (tracking, stricter) = (score.tracking_over_exact, score.tracking_over_exact_without_lag);
    let experiments = &score.experiments;
    let without = match &experiments.most_frequent {
        Some([a, b]) => format!("… of those proposed for, without `{a}` and `{b}`, the most frequent pair"),
        None => "… of those proposed for, without the most frequent pair".to_owned(),
    };
    let (wrong, refused) = (score.outside_with_a_wrong_name, score.outside_refused);
    vec![
        target("macro F1 over the families", score.macro_f1, at_least(0.95), asked),
        share(
            "empty cases with a false name",
            score.empty_with_a_false_name,
            at_most(0.02),
        ),
        share(
            "outside the catalogue, refused on the right joint",
            refused,
            at_least(0.90),
        ),
        share("outside the catalogue, given a wrong name", wrong, at_most(0.03)),
        target(
            "relative error of parameters, median",
            main.median,
            at_most(0.05),
            main.count,
        ),
        share(
            "95 % intervals that hold the truth",
            score.intervals,
            [Some(0.90), Some(0.99)],
        ),
        share(
            "truth in the finding or its confusable set",
            score.covered,
            at_least(0.98),
        ),
        target(
            "held-out error over the true terms’, median",
            over.median,
            at_most(1.1),
            over.count,
        ),
        target(
            "held-out error over the true terms’, 90th percentile",
            over.ninetieth,
            at_most(1.5),
            over.count,
        ),
        target(
            "tracking error with the diagnosed cause over the exact model’s, median",
            tracking.median,
            at_most(1.5),
            tracking.count,
        ),
        target(
            "tracking error likewise, without the velocity filter’s lag, median",
            stricter.median,
            at_most(1.5),
            stricter.count,
        ),
        share(
            "confusions resolved by the proposed experiment, of those it was proposed for",
            experiments.resolved,
            at_least(0.70),
        ),
        share("… of all in the cases tried", experiments.resolved_of_all, [None, None]),
        share(&without, experiments.resolved_of_rarer, [None, None]),
    ]
}
