//! How far a learned torque reaches: its weight, from the variance that its regression has left.

use gp::{Gp, Range};

/// The share of the prior variance up to which nothing fades.
const KNOWN: f64 = 0.05;

/// How soon after that the weight falls in proportion, as a share of the way to the prior.
const ROUNDING: f64 = 0.05;

/// Where the learned torque of one joint is worth something.
#[derive(Clone, Debug)]
pub(crate) struct Reach {
    range: Range,
    /// The share of the prior variance from which the torque fades.
    from: f64,
}

impl Reach {
    /// Of `gp`.
    pub(crate) fn of(gp: &Gp) -> Self {
        let range = gp.range();
        let from = range.left().clamp(KNOWN, 1.0 - KNOWN);
        Self { range, from }
    }

    /// The weight of the mean at `x`: with u the share of the prior variance left there and s = (u - from) / (1 - from),
    /// 1 for s ≤ 0, else 1 - (1 + c) s² / (s + c) with c = 0.05: in proportion to what is known, with a smooth beginning.
    pub(crate) fn weight(&self, x: &[f64]) -> f64 {
        let share = (self.range.unexplained(x) - self.from) / (1.0 - self.from);
        // A comparison rather than `max`, which would turn NaN into a number.
        if share <= 0.0 {
            return 1.0;
        }
        1.0 - (1.0 + ROUNDING) * share * share / (share + ROUNDING)
    }
}
