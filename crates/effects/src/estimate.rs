//! A candidate's estimated coefficients, as an effect reads its parameters from them.

use arm::{Arm, Joint, Matrix3};

use crate::laws::SIGN;
use crate::term::{Law, Size, Term};

/// The systematic error of a parameter, which resampling of the recordings does not show and which widens its interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Systematic {
    /// The usual error, from filtering and from a form that is not exact.
    Usual,
    /// A larger error, for a parameter that depends on a form that recordings hardly show: the ends of a gap, friction near
    /// standstill.
    OfForm,
    /// The usual error and that of the links' inertias in the URDF, for a parameter that is proportional to them.
    OfArm,
    /// The usual error and that of the links' inertial parameters in the URDF, for a body beside them.
    OfLinks,
    /// As [`Self::OfArm`], for a parameter that the recordings only bound from above: the interval begins at zero.
    FromAbove,
}

/// A candidate with its estimate and resamplings. A draw contains the coefficients and the relative corrections of sizes.
pub trait Estimate {
    /// The arm.
    fn arm(&self) -> &Arm;

    /// The candidate's joint; 0 for the whole arm.
    fn joint(&self) -> usize;

    /// The other joint of a coupling.
    fn other(&self) -> Option<usize>;

    /// The candidate's columns.
    fn terms(&self) -> Vec<Term>;

    /// The index in a draw of the coefficient of the candidate's k-th column.
    fn place(&self, k: usize) -> Option<usize>;

    /// The index in a draw of the coefficient of a law's first column, with or without an onset, on the candidate's joint. The
    /// column may belong to another effect. `None` if the fit has no such column.
    fn on_joint(&self, law: &'static Law) -> Option<usize>;

    /// Whether an effect on the candidate's joint has a column of a law without an onset.
    fn is_always_on_joint(&self, law: &'static Law) -> bool;

    /// The index in a draw of the relative correction of a size.
    fn size_place(&self, size: Size) -> Option<usize>;

    /// The largest magnitude of the candidate's k-th column on the rows of its joint in motion; zero for an effect on the whole arm.
    fn shown(&self, k: usize) -> f64;

    /// The lowest and the highest position of the candidate's joint in the recordings (rad or m).
    fn positions(&self) -> [f64; 2];

    /// The estimate, as a draw.
    fn best(&self) -> &[f64];

    /// The tensor about its centre of mass of a payload whose moments are not fitted (kg m²): the one that the fit assumes.
    fn load_tensor(&self) -> Matrix3<f64>;

    /// Records a parameter that is a function of a draw, with its interval; returns its value.
    fn note_within(&mut self, systematic: Systematic, key: &'static str, f: &dyn Fn(&[f64]) -> f64) -> f64;

    /// Extends the interval of a recorded parameter to a value that the recordings do not exclude.
    fn extend(&mut self, key: &'static str, to: f64);

    /// Records and returns the onset of the candidate (s); `None` if it always acts.
    fn onset(&mut self) -> Option<f64>;

    /// Records the start of a contact of a `duration` (s).
    fn start(&mut self, start: f64, duration: f64);
}

impl dyn Estimate + '_ {
    /// The candidate's joint of the arm.
    pub fn arm_joint(&self) -> &Joint {
        &self.arm().joints()[self.joint()]
    }

    /// The name of the candidate's joint.
    pub fn joint_name(&self) -> String {
        self.arm_joint().name.clone()
    }

    /// The factor of the Coulomb level in the candidate's parameters: zero if an effect with one of `laws` on its joint
    /// states the level, one otherwise.
    ///
    /// Dry frictions that act together on a joint share the column of its Coulomb level, and their torques add up.
    /// Therefore only one of them states the level. The first of these that is present does: warming friction (which is
    /// relative to the level), asymmetric, load-dependent, Stribeck friction. Coulomb friction that sets in later has a column
    /// of its own. A friction that was there before its change states the level, and not once more since.
    pub fn level_beside(&self, laws: &[&'static Law]) -> f64 {
        let terms = self.terms();
        let was_there = terms.iter().any(|term| !term.is_always() && self.is_always_on_joint(term.law));
        let is_stated = was_there || laws.iter().any(|law| self.on_joint(law).is_some());
        let shares_level = terms.iter().any(|term| term.is(&SIGN));
        if shares_level && is_stated { 0.0 } else { 1.0 }
    }

    /// The index in a draw of the coefficient of the first column of a law, with or without an onset.
    pub fn at(&self, law: &'static Law) -> Option<usize> {
        let k = self.terms().iter().position(|term| term.always().is(law))?;
        self.place(k)
    }

    /// Records a parameter that is a function of a draw; returns its value.
    pub fn note(&mut self, key: &'static str, f: impl Fn(&[f64]) -> f64) -> f64 {
        self.note_within(Systematic::Usual, key, &f)
    }

    /// Records a coefficient times a factor; zero if there is no coefficient.
    pub fn coefficient(&mut self, key: &'static str, at: Option<usize>, factor: f64) -> f64 {
        at.map_or(0.0, |at| self.note(key, |draw| factor * draw[at]))
    }

    /// Records a size with its correction.
    pub fn size(&mut self, systematic: Systematic, key: &'static str, size: Size, value: f64) -> f64 {
        match self.size_place(size) {
            Some(at) => self.note_within(systematic, key, &|draw| value * (1.0 + draw[at].clamp(-0.5, 0.5))),
            None => self.note_within(systematic, key, &|_| value),
        }
    }

    /// Records a parameter of an effect that is simulated at its size. Where the torque is proportional to the size, the
    /// coefficient and the correction of the size have the same meaning, and only both together are determined. `value` takes
    /// both.
    pub fn simulated(&mut self, systematic: Systematic, key: &'static str, value: impl Fn(f64, f64) -> f64) -> f64 {
        let (first, size) = (self.place(0), self.size_place(Size::Main));
        self.note_within(systematic, key, &|draw| {
            let drawn = first.map_or(1.0, |at| draw[at]);
            let size = size.map_or(0.0, |at| draw[at]);
            value(drawn, size)
        })
    }
}
