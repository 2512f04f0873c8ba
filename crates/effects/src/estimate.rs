//! A candidate's estimated coefficients, as an effect reads its parameters from them.

use arm::{Arm, Joint};

use crate::term::{Law, Size, Term};

/// What of a value no repetition shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Systematic {
    /// What filtering and a form that is not quite right leave.
    Usual,
    /// What hangs on a form that recordings hardly show: how a gap ends, how friction falls near standstill.
    OfForm,
    /// What is in proportion to the arm's links, too, of which the URDF may be wrong.
    OfArm,
}

/// A candidate with its estimate and resamplings. A draw holds the coefficients and relative corrections of sizes.
pub trait Estimate {
    /// The arm.
    fn arm(&self) -> &Arm;

    /// The candidate's joint; 0 for the whole arm.
    fn joint(&self) -> usize;

    /// The other joint of a coupling.
    fn other(&self) -> Option<usize>;

    /// The candidate's columns.
    fn terms(&self) -> Vec<Term>;

    /// Where the coefficient of the candidate's k-th column stands in a draw.
    fn place(&self, k: usize) -> Option<usize>;

    /// Where the relative correction of a size stands in a draw.
    fn size_place(&self, size: Size) -> Option<usize>;

    /// The lowest and the highest position of the candidate's joint in the recordings (rad or m).
    fn positions(&self) -> [f64; 2];

    /// The estimate, as a draw.
    fn best(&self) -> &[f64];

    /// Notes a parameter that is a function of a draw, with its interval; its value.
    fn note_within(&mut self, systematic: Systematic, key: &'static str, f: &dyn Fn(&[f64]) -> f64) -> f64;

    /// Notes when the candidate sets in (s), if it does not always act.
    fn onset(&mut self) -> Option<f64>;

    /// Notes when a push of a `duration` (s) begins.
    fn start(&mut self, start: f64, duration: f64);
}

impl dyn Estimate + '_ {
    /// The candidate's joint of the arm.
    pub fn arm_joint(&self) -> &Joint {
        &self.arm().joints()[self.joint()]
    }

    /// Its name.
    pub fn joint_name(&self) -> String {
        self.arm_joint().name.clone()
    }

    /// Where the coefficient of the first column of a law stands, whether it sets in or not.
    pub fn at(&self, law: &'static Law) -> Option<usize> {
        let k = self.terms().iter().position(|term| term.always().is(law))?;
        self.place(k)
    }

    /// Notes a parameter that is a function of a draw; its value.
    pub fn note(&mut self, key: &'static str, f: impl Fn(&[f64]) -> f64) -> f64 {
        self.note_within(Systematic::Usual, key, &f)
    }

    /// Notes a coefficient times a factor; zero where there is none.
    pub fn coefficient(&mut self, key: &'static str, at: Option<usize>, factor: f64) -> f64 {
        at.map_or(0.0, |at| self.note(key, |draw| factor * draw[at]))
    }

    /// Notes a size at its corrected value.
    pub fn size(&mut self, systematic: Systematic, key: &'static str, size: Size, value: f64) -> f64 {
        match self.size_place(size) {
            Some(at) => self.note_within(systematic, key, &|draw| value * (1.0 + draw[at].clamp(-0.5, 0.5))),
            None => self.note_within(systematic, key, &|_| value),
        }
    }

    /// What is simulated at its size: where its torque is in proportion to that, its coefficient and the size's correction
    /// mean the same, and only together are they determined. `value` takes both.
    pub fn simulated(&mut self, systematic: Systematic, key: &'static str, value: impl Fn(f64, f64) -> f64) -> f64 {
        let (first, size) = (self.place(0), self.size_place(Size::Main));
        self.note_within(systematic, key, &|draw| {
            let drawn = first.map_or(1.0, |at| draw[at]);
            let size = size.map_or(0.0, |at| draw[at]);
            value(drawn, size)
        })
    }
}
