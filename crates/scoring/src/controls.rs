//! The four controls of a case: their effects, and their held-out torque errors.

use serde::{Deserialize, Serialize};

use crate::answer::{Answer, JointErrors};
use crate::catalogue::{ON_A_JOINT, ON_THE_ARM, brings, parameters};
use crate::rules::{Key, Name, is_baseline};
use crate::truth::Truth;

/// The effects of the control "the true terms": all injected faults with a name, fitted by name, without a search.
pub fn true_terms(truth: &Truth) -> Vec<Name> {
    Key::new(truth).known.into_iter().collect()
}

/// The control "a wrong term".
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WrongTerm {
    /// The true effect.
    pub instead_of: Name,
    /// The effect that is fitted in its place.
    pub wrong: Name,
    /// All fitted effects.
    pub terms: Vec<Name>,
}

/// The true terms, with another effect on the same joint in place of the largest one that is not a baseline effect. The
/// case's `number` selects that other effect. `None` if only baseline effects are injected.
pub fn wrong_term(truth: &Truth, number: usize) -> Option<WrongTerm> {
    let named = truth.of_note().filter(|injected| {
        !injected.is_outside_the_catalogue()
            && !is_baseline(truth, injected.name())
            && !parameters(injected.name()).is_empty()
    });
    let largest = named.max_by(|a, b| {
        let share = |share: Option<f64>| share.unwrap_or(0.0);
        share(a.expressed_share).total_cmp(&share(b.expressed_share))
    })?;
    let (effect, joint) = (largest.name(), &largest.joint);
    let key = Key::new(truth);
    let fits = |name: &str| {
        let name = (name.to_owned(), joint.clone());
        // Neither a true effect, nor a part of one, nor a generalisation of one.
        !key.known.contains(&name) && !key.brought.contains(&name) && !brings(&name.0).contains(&effect)
    };
    let list: &[&str] = if joint.is_some() { &ON_A_JOINT } else { &ON_THE_ARM };
    let possible: Vec<&str> = list.iter().copied().filter(|name| fits(name)).collect();
    let wrong = *possible.get(number % possible.len().max(1))?;
    let instead_of = (effect.to_owned(), joint.clone());
    let wrong = (wrong.to_owned(), joint.clone());
    let mut terms: Vec<Name> = key.known.into_iter().filter(|name| *name != instead_of).collect();
    terms.push(wrong.clone());
    Some(WrongTerm { instead_of, wrong, terms })
}

/// Held-out errors of the models: the root mean square over the joints of the NRMSE.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// The case.
    pub case: String,
    /// Whether a fault outside the catalogue is injected, which the true terms do not contain.
    pub outside_the_catalogue: bool,
    /// Whether the URDF is wrong everywhere, or joints have small effects, which the true terms do not contain.
    pub beside_the_terms: bool,
    /// The nominal model.
    pub nominal: Option<f64>,
    /// The model with the findings.
    pub diagnosed: Option<f64>,
    /// The model with the true terms.
    pub true_terms: Option<f64>,
    /// The model with a wrong term in place of a true one.
    pub wrong_term: Option<f64>,
    /// The model with a learned correction and no names.
    pub learned: Option<f64>,
}

impl HeldOut {
    /// Whether the true terms are complete, so that they can serve as a reference.
    pub fn has_all_terms(&self) -> bool {
        !self.outside_the_catalogue && !self.beside_the_terms
    }

    /// The diagnosis' error over the true terms'.
    pub fn over_true_terms(&self) -> Option<f64> {
        Some(self.diagnosed? / self.true_terms?.max(1e-12))
    }
}

/// The errors of a case.
pub fn held_out(truth: &Truth, answer: &Answer, oracle: Option<&Answer>, wrong: Option<&Answer>) -> HeldOut {
    // Only joints for which the errors of all models are known.
    let knows = |joint: &str| {
        let all = [Some(answer), oracle, wrong];
        all.into_iter().flatten().all(|answer| {
            let fit = answer.fit.get(joint);
            fit.is_some_and(|fit| fit.held_out_nrmse_augmented.is_some())
        })
    };
    let over = |answer: Option<&Answer>, pick: &dyn Fn(&JointErrors) -> Option<f64>| -> Option<f64> {
        let fits = answer?.fit.iter().filter(|(joint, _)| knows(joint));
        let squares: Option<Vec<f64>> = fits.map(|(_, fit)| pick(fit).map(|error| error * error)).collect();
        let squares = squares.filter(|squares| !squares.is_empty())?;
        Some((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
    };
    HeldOut {
        case: truth.case.clone(),
        outside_the_catalogue: !Key::new(truth).unknown.is_empty(),
        beside_the_terms: truth.has_a_wrong_urdf() || truth.injected.iter().any(|injected| injected.minor),
        nominal: over(Some(answer), &|fit| fit.held_out_nrmse_nominal),
        diagnosed: over(Some(answer), &|fit| fit.held_out_nrmse_augmented),
        true_terms: over(oracle, &|fit| fit.held_out_nrmse_augmented),
        wrong_term: over(wrong, &|fit| fit.held_out_nrmse_augmented),
        learned: over(Some(answer), &|fit| fit.held_out_nrmse_learned),
    }
}
