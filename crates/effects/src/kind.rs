//! The trait of an effect: one implementation in one file for each.

use std::fmt::Debug;

use ::arm::JointKind;

use crate::effect::Effect;
use crate::estimate::Estimate;
use crate::fitted::Fitted;
use crate::form::{Form, Grounds, SetsIn};
use crate::machine::{Machine, Place};
use crate::spec::Spec;
use crate::term::Term;

/// A kind of effect: everything that the program knows about it.
pub trait EffectKind: Debug + Sync {
    /// Its name, parameters, relations and texts.
    fn spec(&self) -> &'static Spec;

    /// Whether it depends on another joint's motion.
    fn has_other(&self) -> bool {
        false
    }

    /// The forms to try from the beginning. Other forms are suggested by residuals later.
    fn forms(&self, grounds: &Grounds<'_>) -> Vec<Form>;

    /// How its onset within the recordings is searched, if it may have one.
    fn sets_in(&self) -> Option<SetsIn> {
        None
    }

    /// Whether two candidates on one joint (and with the same other joint) are the same effect at different sizes, judged by
    /// their first columns.
    fn is_same(&self, _a: &Term, _b: &Term) -> bool {
        true
    }

    /// Whether its fitted coefficients are physically possible.
    fn is_possible(&self, _fitted: &dyn Fitted) -> bool {
        true
    }

    /// Whether the 95 % intervals of its parameters, by key, allow a physically possible effect; `_accuracy` is the relative
    /// standard deviation of the torque constants.
    fn is_certain(&self, _effect: &Effect, _interval: &dyn Fn(&str) -> Option<[f64; 2]>, _accuracy: f64) -> bool {
        true
    }

    /// Whether the effects found `beside` it exclude it.
    fn is_contradicted(&self, _effect: &Effect, _beside: &[Effect]) -> bool {
        false
    }

    /// The level of its dry friction (N m or N), if it is a dry friction.
    fn dry_friction(&self, _effect: &Effect) -> Option<f64> {
        None
    }

    /// The effect with the parameters of an estimate, each recorded with its interval; `None` if it cannot be read or has no
    /// name.
    fn read(&self, _estimate: &mut dyn Estimate) -> Option<Effect> {
        None
    }

    /// The term of an effect that is a function of the commanded torque, with the sizes of `effect`; its coefficient is one.
    fn of_torque(&self, _effect: &Effect, _joint: usize) -> Option<Term> {
        None
    }

    /// What is wrong with its parameters, apart from their ranges: the parameter, its value and the requirement.
    fn refuse(&self, _effect: &Effect) -> Option<(&'static str, f64, &'static str)> {
        None
    }

    /// The one effect that acts as two of them on one joint do together; `None` if they stay two.
    fn sum(&self, _a: &Effect, _b: &Effect) -> Option<Effect> {
        None
    }

    /// Whether two of them on one joint are the same effect, given twice.
    fn is_twin(&self, _a: &Effect, _b: &Effect) -> bool {
        true
    }

    /// Adds the effect to a machine.
    fn apply(&self, _effect: &Effect, _at: Place, _machine: &mut Machine) {}

    /// The power of the noise in the column of one of its terms, relative to that in the torque of a link of inertia `_mass` (kg m² or
    /// kg), if the noise of the recorded positions is white and passes a filter of half power at `_cutoff` (Hz).
    fn noise_gain(&self, _term: &Term, _mass: f64, _cutoff: f64) -> f64 {
        0.0
    }

    /// The title of an effect with these parameters.
    fn title(&self, _effect: &Effect) -> &'static str {
        self.spec().title
    }

    /// A finding as a short phrase with its parameters.
    fn sentence(&self, _effect: &Effect) -> &'static str {
        self.spec().sentence
    }

    /// What the recordings from before a change say of an effect that is new, as a phrase.
    fn before_it(&self, _effect: &Effect) -> &'static str {
        "absent in the recordings from before"
    }

    /// The region of state where it acts, in words, from its columns on a kind of joint.
    fn region(&self, _terms: &[Term], _joint: JointKind) -> Option<String> {
        None
    }
}

impl Effect {
    /// An effect of a kind, without a joint. A parameter that has no default and is not set is NaN, which
    /// [`check`](crate::check) refuses.
    pub fn of(kind: &'static dyn EffectKind) -> Self {
        Self::with_spec(kind.spec())
    }

    /// Whether it is of this kind.
    pub fn is(&self, kind: &'static dyn EffectKind) -> bool {
        std::ptr::eq(self.spec(), kind.spec())
    }
}
