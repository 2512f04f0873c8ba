//! Whether joints agree on one lag.

use nalgebra::{DMatrix, DVector};

use crate::thresholds::{LEAST_LAGGING, MOST_BY_CHANCE, MOST_OF_LAG};

/// The value that several estimates have in common, by generalised least squares.
pub struct Common {
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub deviation: f64,
    /// vᵀ C⁻¹ v of the estimates v with covariance C: the part that the common value explains,
    pub explained: f64,
    /// and the rest.
    misfit: f64,
    /// The number of estimates.
    count: usize,
}

impl Common {
    /// That of the estimates `chosen` among `values`; `None` if their covariance is singular.
    pub fn of(values: &DVector<f64>, covariance: &DMatrix<f64>, chosen: &[usize]) -> Option<Self> {
        let values = values.select_rows(chosen);
        let information = covariance.select_rows(chosen).select_columns(chosen).try_inverse()?;
        let weighted = &information * &values;
        let weight = information.sum();
        let value = weighted.sum() / weight;
        let explained = value * weighted.sum();
        Some(Self {
            value,
            deviation: weight.sqrt().recip(),
            explained,
            misfit: (values.dot(&weighted) - explained).max(0.0),
            count: chosen.len(),
        })
    }

    /// Whether hardly anything contradicts it, or no more than chance.
    fn is_shared(&self) -> bool {
        let by_chance = MOST_BY_CHANCE * self.count.saturating_sub(1) as f64;
        self.misfit <= by_chance.max(MOST_OF_LAG * (self.misfit + self.explained))
    }

    /// That of most of the `values`, with these: a joint may have a lag of its own. `None` if most do not agree.
    pub fn of_most(values: &DVector<f64>, covariance: &DMatrix<f64>) -> Option<(Self, Vec<usize>)> {
        let count = values.len();
        let mut agreeing: Vec<usize> = (0..count).collect();
        loop {
            let common = Self::of(values, covariance, &agreeing)?;
            if common.is_shared() {
                return Some((common, agreeing));
            }
            let without =
                |&joint: &usize| -> Vec<usize> { agreeing.iter().copied().filter(|&other| other != joint).collect() };
            let fewer = agreeing.iter().map(without);
            let fewer = fewer.filter_map(|fewer| Some((Self::of(values, covariance, &fewer)?.misfit, fewer)));
            agreeing = fewer.min_by(|a, b| a.0.total_cmp(&b.0))?.1;
            if agreeing.len() < LEAST_LAGGING || 2 * agreeing.len() <= count {
                return None;
            }
        }
    }

    /// Whether it is seen with the evidence `least` (nats) without each of the values that agree on it: one joint alone may have any delay.
    pub fn is_seen_without_each(
        &self,
        values: &DVector<f64>,
        covariance: &DMatrix<f64>,
        agreeing: &[usize],
        least: f64,
    ) -> bool {
        agreeing.iter().all(|joint| {
            let others: Vec<usize> = agreeing.iter().copied().filter(|other| other != joint).collect();
            Self::of(values, covariance, &others)
                .is_some_and(|rest| rest.is_shared() && rest.value * self.value > 0.0 && 0.5 * rest.explained >= least)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thresholds::LEAST_LAG_NATS;

    /// Whether estimates with a standard deviation of one have a common value that is seen without each of them.
    fn is_common(values: &[f64]) -> bool {
        let (values, covariance) = (DVector::from_column_slice(values), DMatrix::identity(values.len(), values.len()));
        Common::of_most(&values, &covariance).is_some_and(|(common, agreeing)| {
            common.is_seen_without_each(&values, &covariance, &agreeing, LEAST_LAG_NATS)
        })
    }

    #[test]
    fn a_value_is_common_though_none_of_the_estimates_is_clear_alone() {
        assert!(is_common(&[1.7, 2.5, 2.1, 2.8, 2.2, 3.0]));
        assert!(!is_common(&[0.7, -0.5, 1.1, 0.2, -1.2, 0.4]));
        // One joint has all the evidence.
        assert!(!is_common(&[0.4, 0.1, 30.0, 0.2, -0.3, 0.5]));
        // They differ by more than chance.
        assert!(!is_common(&[9.0, 1.0, -7.0, 5.0, 0.0, -3.0]));
    }
}
