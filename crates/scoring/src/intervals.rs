//! Intervals of counted shares, and quantiles.

use serde::{Deserialize, Serialize};

/// A share k of n, with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counted {
    /// k.
    pub hits: usize,
    /// n.
    pub of: usize,
    /// Wilson's interval of the share (Wilson 1927), z = 1.96; from 0 to 1 if n is 0.
    pub wilson: [f64; 2],
}

impl Counted {
    /// `hits` of `of`.
    pub fn new(hits: usize, of: usize) -> Self {
        let wilson = wilson(hits, of);
        Self { hits, of, wilson }
    }

    /// The number of values that are `true`, of all values.
    pub fn of(all: impl IntoIterator<Item = bool>) -> Self {
        let (mut hits, mut of) = (0, 0);
        for hit in all {
            hits += usize::from(hit);
            of += 1;
        }
        Self::new(hits, of)
    }

    /// The share; `None` if n is 0.
    pub fn share(&self) -> Option<f64> {
        (self.of > 0).then(|| self.hits as f64 / self.of as f64)
    }
}

/// Wilson's 95 % interval of a share `hits` of `of`.
pub fn wilson(hits: usize, of: usize) -> [f64; 2] {
    if of == 0 {
        return [0.0, 1.0];
    }
    const Z: f64 = 1.96;
    let n = of as f64;
    let p = hits as f64 / n;
    let scale = 1.0 + Z * Z / n;
    let middle = p + Z * Z / (2.0 * n);
    let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    // With no hits, or only hits, the interval ends at the bound up to rounding.
    let low = if hits == 0 { 0.0 } else { (middle - half) / scale };
    let high = if hits == of { 1.0 } else { (middle + half) / scale };
    [low, high]
}

/// The quantile of `share` of the values, linear between them; `None` for no values.
pub fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let at = share * last as f64;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    Some(sorted[low] + (at - low as f64) * (sorted[high] - sorted[low]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilsons_interval_is_that_of_statsmodels() {
        // statsmodels.stats.proportion.proportion_confint(15, 20, method="wilson") is (0.5313, 0.8881).
        let [low, high] = wilson(15, 20);
        assert!((low - 0.5313).abs() < 1e-4 && (high - 0.8881).abs() < 1e-4, "{low} {high}");
        assert_eq!(wilson(0, 0), [0.0, 1.0]);
        let [low, high] = wilson(0, 60);
        assert!(low == 0.0 && (high - 0.0602).abs() < 1e-4, "{high}");
        assert_eq!(wilson(60, 60)[1], 1.0);
    }

    #[test]
    fn quantiles_are_interpolated() {
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[3.0, 1.0, 2.0], 0.5), Some(2.0));
        assert_eq!(quantile(&[0.0, 1.0], 0.9), Some(0.9));
    }
}
