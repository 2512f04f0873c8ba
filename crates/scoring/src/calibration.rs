//! Whether stated probabilities agree with the relative frequencies of right findings.

use serde::{Deserialize, Serialize};

use crate::intervals::Counted;

/// The bounds between bins of probability.
const BOUNDS: [f64; 5] = [0.6, 0.75, 0.85, 0.92, 0.97];

/// Stated probabilities against outcomes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// The bins in ascending order; bins without findings are omitted.
    pub bins: Vec<Bin>,
    /// The mean square of probability minus outcome (Brier 1950); 0 is perfect.
    pub brier: Option<f64>,
    /// The mean distance between stated and observed frequency, weighted by the number of findings in each bin.
    pub error: Option<f64>,
}

/// Findings of similar probability.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bin {
    /// The lower end of the bin.
    pub from: f64,
    /// The upper end of the bin.
    pub to: f64,
    /// The mean of the stated probabilities.
    pub said: f64,
    /// The findings that were right.
    pub right: Counted,
}

/// The calibration of findings, each with its probability and whether it is right.
pub fn calibration(findings: &[(f64, bool)]) -> Calibration {
    if findings.is_empty() {
        return Calibration::default();
    }
    let n = findings.len() as f64;
    let outcome = |right: bool| if right { 1.0 } else { 0.0 };
    let brier = findings.iter().map(|&(p, right)| (p - outcome(right)).powi(2)).sum::<f64>() / n;
    let mut bins = Vec::new();
    for k in 0..=BOUNDS.len() {
        let from = if k == 0 { 0.0 } else { BOUNDS[k - 1] };
        let to = BOUNDS.get(k).copied().unwrap_or(1.0);
        let is_last = k == BOUNDS.len();
        let inside = |&&(p, _): &&(f64, bool)| p >= from && (p < to || is_last);
        let mine: Vec<(f64, bool)> = findings.iter().filter(inside).copied().collect();
        if mine.is_empty() {
            continue;
        }
        bins.push(Bin {
            from,
            to,
            said: mine.iter().map(|(p, _)| p).sum::<f64>() / mine.len() as f64,
            right: Counted::of(mine.iter().map(|&(_, right)| right)),
        });
    }
    let apart = |bin: &Bin| (bin.said - bin.right.share().unwrap_or(0.0)).abs() * bin.right.of as f64;
    Calibration { brier: Some(brier), error: Some(bins.iter().map(apart).sum::<f64>() / n), bins }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_that_equal_the_probabilities_have_no_error() {
        let mut findings = vec![(0.8, true); 4];
        findings.push((0.8, false));
        let found = calibration(&findings);
        assert_eq!(found.bins.len(), 1);
        assert_eq!((found.bins[0].right.hits, found.bins[0].right.of), (4, 5));
        assert!(found.error.is_some_and(|error| error < 1e-12));
        assert!(found.brier.is_some_and(|brier| (brier - 0.16).abs() < 1e-12));
    }

    #[test]
    fn a_probability_of_one_is_in_the_last_bin_and_no_findings_have_no_bin() {
        assert_eq!(calibration(&[(1.0, true)]).bins[0].from, 0.97);
        assert!(calibration(&[]).bins.is_empty());
    }
}
