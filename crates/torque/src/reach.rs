//! The weight of a learned torque: how reliable it is, from the remaining variance of its regression.

use gp::{Gp, Range};

/// The share of the prior variance up to which the weight is 1.
const KNOWN: f64 = 0.05;

/// The width of the transition from 1 to a linear decrease, as a share of the way to the prior variance.
const ROUNDING: f64 = 0.05;

/// The weight of the learned torque of one joint.
#[derive(Clone, Debug)]
pub(crate) struct Reach {
    range: Range,
    /// The prior variance over the mean square of the torques that were learned, at least 1. A fit whose amplitude far exceeds its
    /// data knows nothing where its variance nears theirs, long before it nears the prior's.
    over_data: f64,
    /// The share of the smaller of prior variance and mean square from which the torque fades.
    from: f64,
}

impl Reach {
    /// The weight of the mean of `gp`, which was fitted to `targets` (N m or N).
    pub(crate) fn of(gp: &Gp, targets: &[f64]) -> Self {
        let range = gp.range();
        let square = targets.iter().map(|target| target * target).sum::<f64>() / targets.len() as f64;
        let prior = gp.hyperparameters().amplitude.powi(2);
        let over_data = if square > 0.0 { (prior / square).max(1.0) } else { 1.0 };
        let from = beginning(over_data * range.mean_variance_share());
        Self { range, over_data, from }
    }

    /// The weight of the mean at `x`.
    pub(crate) fn weight(&self, x: &[f64]) -> f64 {
        let share = self.over_data * self.range.variance_share(x);
        // A comparison instead of `min`, which would replace NaN by a number.
        weight(if share > 1.0 { 1.0 } else { share }, self.from)
    }
}

/// The share of the prior variance from which a torque fades, if `left` remains on average at the training data.
pub(crate) fn beginning(left: f64) -> f64 {
    left.clamp(KNOWN, 1.0 - KNOWN)
}

/// The weight of a torque of which the share u of the prior variance remains: with s = (u − from) / (1 − from), it is 1 for s ≤ 0,
/// and otherwise 1 − (1 + c) s² / (s + c) with c = 0.05, which decreases linearly after a smooth beginning.
pub(crate) fn weight(u: f64, from: f64) -> f64 {
    let share = (u - from) / (1.0 - from);
    // A comparison instead of `max`, which would replace NaN by a number.
    if share <= 0.0 {
        return 1.0;
    }
    1.0 - (1.0 + ROUNDING) * share * share / (share + ROUNDING)
}

#[cfg(test)]
mod tests {
    use gp::{FitOptions, TrainingSet};

    use super::*;

    /// Of a slow rise, a regression believes that it goes on far beyond the data: its amplitude is many times theirs. It is not trusted
    /// where its deviation is as large as the data, which is long before it is as large as the amplitude.
    #[test]
    fn a_deviation_as_large_as_the_data_leaves_no_weight() {
        let x: Vec<f64> = (0..40).map(|k| f64::from(k) / 40.0).collect();
        let y: Vec<f64> = x.iter().map(|x| x * (x - 0.5)).collect();
        let set = TrainingSet::new(1, &x, &y).expect("it is a set");
        let gp = Gp::fit(&set, &FitOptions::default()).expect("it can be fitted");
        let square = y.iter().map(|y| y * y).sum::<f64>() / y.len() as f64;
        let prior = gp.hyperparameters().amplitude.powi(2);
        assert!(prior > 4.0 * square, "{prior} {square}");
        let reach = Reach::of(&gp, &y);
        assert_eq!(reach.weight(&[0.5]), 1.0);
        let mut scratch = gp::Workspace::default();
        let deviates = |x: &f64| gp.clone().mean_and_variance(&[*x], &mut scratch).1 > square;
        let outside = (10..100).map(|k| f64::from(k) / 10.0).find(deviates).expect("it deviates far from the data");
        assert!(
            weight(reach.range.variance_share(&[outside]), KNOWN) > 0.02,
            "it is nearer than the amplitude: {outside}"
        );
        assert_eq!(reach.weight(&[outside]), 0.0);
    }
}
