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
    /// The share of the prior variance from which the torque fades.
    from: f64,
}

impl Reach {
    /// The weight of the mean of `gp`.
    pub(crate) fn of(gp: &Gp) -> Self {
        let range = gp.range();
        let from = beginning(range.mean_variance_share());
        Self { range, from }
    }

    /// The weight of the mean at `x`.
    pub(crate) fn weight(&self, x: &[f64]) -> f64 {
        weight(self.range.variance_share(x), self.from)
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
