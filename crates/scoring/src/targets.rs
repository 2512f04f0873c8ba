//! The figures that a proof must reach, and whether it does.

use crate::intervals::Counted;
use crate::score::{Family, Figure, Score, Target};
use crate::strict::{UrdfError, UrdfGroup};

fn target(id: Figure, what: &str, figure: Option<f64>, [at_least, at_most]: [Option<f64>; 2], of: usize) -> Target {
    let is_within = |figure: f64| at_least.is_none_or(|low| figure >= low) && at_most.is_none_or(|high| figure <= high);
    Target {
        id,
        group: None,
        what: what.to_owned(),
        figure,
        at_least,
        at_most,
        counted: None,
        of,
        reached: figure.map(is_within).filter(|_| at_least.is_some() || at_most.is_some()),
    }
}

fn share(id: Figure, what: &str, counted: Counted, bounds: [Option<f64>; 2]) -> Target {
    let of_share = target(id, what, counted.share(), bounds, counted.of);
    let reached = of_share.reached.filter(|is_reached| *is_reached || is_decided(counted, bounds));
    Target { counted: Some(counted), reached, ..of_share }
}

/// Whether a share outside `bounds` can be said to be there: where its interval contains the middle between them, too few were
/// counted. Four of four are above 99 %, and say nothing.
fn is_decided(counted: Counted, bounds: [Option<f64>; 2]) -> bool {
    let [Some(low), Some(high)] = bounds else { return true };
    !(counted.wilson[0]..=counted.wilson[1]).contains(&((low + high) / 2.0))
}

/// The figures of `score` with their targets.
pub fn targets(score: &Score) -> Vec<Target> {
    let at_least = |value: f64| [Some(value), None];
    let at_most = |value: f64| [None, Some(value)];
    let asked: usize = score.families.values().map(Family::asked).sum();
    let (main, over) = (score.main_parameters, score.over_true_terms);
    let (tracking, stricter) = (score.tracking_over_exact, score.tracking_over_exact_without_lag);
    let experiments = &score.experiments;
    let without = match &experiments.most_frequent {
        Some([a, b]) => format!(
            "resolved, of the confusions with a proposed experiment, without the most frequent pair, `{a}` and `{b}`"
        ),
        None => "resolved, of the confusions with a proposed experiment, without the most frequent pair".to_owned(),
    };
    let (wrong, refused) = (score.outside_with_a_wrong_name, score.outside_refused);
    let strict = &score.strict;
    let mut list = vec![target(
        Figure::Strict,
        "strict macro F1: all effects from 1.5 % on required, every untrue name false, sizes within 20 %",
        strict.macro_f1,
        [None, None],
        strict.right.of,
    )];
    list.extend(score.by_urdf.iter().flat_map(of_group));
    list.extend([
        target(Figure::MacroF1, "macro F1 over the families", score.macro_f1, at_least(0.95), asked),
        share(Figure::EmptyCases, "empty cases with a false name", score.empty_with_a_false_name, at_most(0.02)),
        share(
            Figure::OutsideRefused,
            "effects outside the catalogue: unexplained residual on the right joint",
            refused,
            at_least(0.90),
        ),
        share(Figure::OutsideNamed, "effects outside the catalogue: cases with a wrong name", wrong, at_most(0.03)),
        target(Figure::ParameterErrors, "relative error of parameters, median", main.median, at_most(0.05), main.count),
        share(
            Figure::Intervals,
            "95 % intervals that contain the true value",
            score.intervals,
            [Some(0.90), Some(0.99)],
        ),
        share(Figure::Covered, "ground truth in the finding or its alternatives", score.covered, at_least(0.98)),
        target(Figure::HeldOut, "held-out error over the true terms’, median", over.median, at_most(1.1), over.count),
        target(
            Figure::HeldOut,
            "held-out error over the true terms’, 90th percentile",
            over.ninetieth,
            at_most(1.5),
            over.count,
        ),
        target(
            Figure::Tracking,
            "tracking error with the diagnosed effects over the exact model’s, median",
            tracking.median,
            at_most(1.5),
            tracking.count,
        ),
        target(
            Figure::Tracking,
            "tracking error over the exact model’s, without the velocity filter’s lag, median",
            stricter.median,
            at_most(1.5),
            stricter.count,
        ),
        share(
            Figure::Confusions,
            "resolved, of the confusions with a proposed experiment",
            experiments.resolved,
            at_least(0.70),
        ),
        share(
            Figure::Confusions,
            "resolved, of all confusions in the same cases",
            experiments.resolved_of_all,
            [None, None],
        ),
        share(Figure::Confusions, &without, experiments.resolved_of_rarer, [None, None]),
    ]);
    list
}

/// The targets of cases whose URDFs are similarly wrong.
fn of_group(group: &UrdfGroup) -> [Target; 3] {
    let least = match group.urdf {
        UrdfError::Exact => 0.95,
        UrdfError::Some => 0.88,
        UrdfError::Much => 0.80,
    };
    let (urdf, strict) = (group.urdf.words(), &group.strict);
    let targets = [
        target(
            Figure::Strict,
            &format!("strict macro F1, URDF {urdf}"),
            strict.macro_f1,
            [Some(least), None],
            strict.right.of,
        ),
        share(
            Figure::FalseCases,
            &format!("cases with a false name, URDF {urdf}"),
            strict.cases_with_a_false_name,
            [None, Some(0.02)],
        ),
        share(
            Figure::Intervals,
            &format!("95 % intervals that contain the true value, URDF {urdf}"),
            strict.intervals,
            [Some(0.90), Some(0.99)],
        ),
    ];
    targets.map(|target| Target { group: Some(group.urdf), ..target })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_few_intervals_are_not_outside_a_target_with_two_ends() {
        let reached = |hits, of| {
            let bounds = [Some(0.90), Some(0.99)];
            share(Figure::Intervals, "", Counted::new(hits, of), bounds).reached
        };
        assert_eq!(reached(4, 4), None);
        assert_eq!(reached(3, 4), None);
        assert_eq!(reached(19, 20), Some(true));
        assert_eq!(reached(1000, 1000), Some(false));
        assert_eq!(reached(10, 20), Some(false));
        assert_eq!(reached(88, 100), Some(false));
        assert_eq!(reached(0, 0), None);
        // A target with one end is decided by the figure.
        let at_most = share(Figure::EmptyCases, "", Counted::new(1, 4), [None, Some(0.02)]);
        assert_eq!(at_most.reached, Some(false));
    }
}
