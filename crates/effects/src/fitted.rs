//! A candidate in a fit, as its effect sees it.

use arm::Arm;

use crate::term::Term;

/// A candidate with the coefficients of a fit.
pub trait Fitted {
    /// The number of its columns.
    fn len(&self) -> usize;

    /// Whether it has no columns.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The term of its k-th column.
    fn term(&self, k: usize) -> Term;

    /// The coefficient of its k-th column.
    fn value(&self, k: usize) -> f64;

    /// The coefficient of a column of the background beside it; zero if the fit has no such column.
    fn background(&self, term: &Term) -> f64;

    /// Its k-th column on the rows of its joint; `None` if it has none there, or if it acts on the whole arm.
    fn column(&self, k: usize) -> Option<&[f64]>;

    /// The residual of the fit on the rows of its joint (N m or N); empty for the whole arm.
    fn residual(&self) -> Vec<f64>;

    /// Which rows of its joint are in motion.
    fn moving(&self) -> &[bool];

    /// Whether it is a trial size during refinement.
    fn is_trial(&self) -> bool;

    /// The arm.
    fn arm(&self) -> &Arm;
}

/// The accepted range of a coefficient that is one if the size of its effect is exact. The linearisation of the columns
/// causes a deviation. Source: a prototype in Python, on 70 simulated cases.
pub const UNIT: std::ops::RangeInclusive<f64> = 0.7..=1.4;
/// The range of a coefficient that should be one, before the size of its effect is refined. Source: a gap of a size
/// that is tried first may have a coefficient of one half, and still be most of the residual.
const COARSE_UNIT: std::ops::RangeInclusive<f64> = 0.4..=2.5;

/// Whether the coefficient of a simulated drive is near one. Near a resonance it quickly becomes small, so that it says little
/// before the size is refined.
pub fn is_near_one(fitted: &dyn Fitted) -> bool {
    if fitted.is_trial() { UNIT.contains(&fitted.value(0)) } else { COARSE_UNIT.contains(&fitted.value(0)) }
}

/// The mass of the moving links (kg).
pub fn moving_mass(arm: &Arm) -> f64 {
    arm.joints().iter().map(|joint| joint.inertia.mass).sum()
}
