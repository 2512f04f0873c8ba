//! A hypothesis: the effects that were asked for, fitted together, with no search and no judgement.

use crate::candidate::Cause;
use crate::error::DiagnosisError;
use crate::judge::{self, Judged};
use crate::refine::resize;
use crate::search::{Chosen, Problem};
use crate::study::Study;

/// Sweeps over the forms of all effects, at most.
const SWEEPS: usize = 4;
/// Rounds about the arm that the effects make.
const ROUNDS: usize = 2;

/// An effect to be fitted, by its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The catalogue's name.
    pub effect: String,
    /// The joint, or `None` for the whole arm.
    pub joint: Option<String>,
}

impl Wanted {
    fn refused(&self, reason: &'static str) -> DiagnosisError {
        DiagnosisError::Wanted {
            effect: self.effect.clone(),
            joint: self.joint.clone(),
            reason,
        }
    }
}

/// Fits `wanted`, each in the form and at the size that explain the training recordings best.
///
/// # Errors
/// [`DiagnosisError::Wanted`], if one is given twice, is not in the catalogue, or not on such a joint.
pub fn fit(study: &mut Study, wanted: &[Wanted]) -> Result<Judged, DiagnosisError> {
    let joints = check(study, wanted)?;
    let mut waiting: Vec<(&Wanted, Option<usize>)> = wanted.iter().zip(joints).collect();
    let mut placed: Vec<(&Wanted, Option<usize>)> = Vec::new();
    let products = study.products(|r| study.fitted[r]);
    let mut chosen = study.problem(&products).choose(Vec::new(), &products.first_weights());
    // Where a contact was and which period a ripple has is told by what the others leave.
    for suggest in [false, true] {
        if suggest && !waiting.is_empty() {
            study.suggest(&chosen);
        }
        let products = study.products(|r| study.fitted[r]);
        let problem = study.problem(&products);
        waiting.retain(
            |&(one, joint)| match best(&problem, &chosen, None, &one.effect, joint) {
                Some(next) => {
                    chosen = next;
                    placed.push((one, joint));
                    false
                }
                None => true,
            },
        );
        chosen = swept(&problem, chosen, &placed);
    }
    for (one, _) in waiting {
        let place = one.joint.as_deref().unwrap_or("the whole arm");
        let remark = format!(
            "{} on {place}: these recordings do not try it; it is left out",
            one.effect
        );
        study.motions.remarks.push(remark);
    }
    for round in 0..ROUNDS {
        chosen = resize(study, chosen, round > 0);
        let formed_anew = study.relinearise(&chosen.fit, &chosen.set);
        let is_done = formed_anew.is_none();
        let set = formed_anew.unwrap_or_else(|| chosen.set.clone());
        let products = study.products(|r| study.fitted[r]);
        chosen = study.problem(&products).choose(set, &chosen.fit.weights);
        if is_done {
            break;
        }
    }
    let products = study.products(|r| study.fitted[r]);
    let members = judge::describe(study, &study.problem(&products), &chosen);
    Ok(Judged {
        named: chosen,
        members,
        nameless: Vec::new(),
    })
}

/// The joints' numbers.
fn check(study: &Study, wanted: &[Wanted]) -> Result<Vec<Option<usize>>, DiagnosisError> {
    let mut joints = Vec::new();
    for (k, one) in wanted.iter().enumerate() {
        let number = |name: &String| study.arm.joints().iter().position(|joint| joint.name == *name);
        let joint = match &one.joint {
            Some(name) => Some(number(name).ok_or_else(|| one.refused("the robot has no such joint"))?),
            None => None,
        };
        let on_arm = |effect: &str| Cause::ON_THE_ARM.iter().any(|cause| cause.name() == Some(effect));
        let on_joint = |effect: &str| Cause::ON_A_JOINT.iter().any(|cause| cause.name() == Some(effect));
        match (joint, on_arm(&one.effect), on_joint(&one.effect)) {
            (_, false, false) => return Err(one.refused("no such effect is in the catalogue")),
            (Some(_), true, _) => return Err(one.refused("is on the whole arm; leave the joint out")),
            (None, false, _) => return Err(one.refused("is on a joint; give it as effect:joint")),
            _ => {}
        }
        // Two pushes may be, and two ripples on a joint.
        let may_repeat = ["external_contact", "torque_ripple"].contains(&one.effect.as_str());
        if !may_repeat && wanted[..k].contains(one) {
            return Err(one.refused("is given twice"));
        }
        joints.push(joint);
    }
    Ok(joints)
}

/// `chosen` with the best form of an effect in the place of the member at `instead`, or added to it.
fn best(
    problem: &Problem<'_>,
    chosen: &Chosen,
    instead: Option<usize>,
    effect: &str,
    joint: Option<usize>,
) -> Option<Chosen> {
    let mut others = chosen.set.clone();
    if let Some(at) = instead {
        others.remove(at);
    }
    let is_form = |&c: &usize| {
        let candidate = &problem.candidates[c];
        // What was asked for twice is there twice, not once in two sizes.
        let is_twin = |&other: &usize| problem.candidates[other].cause == candidate.cause && problem.exclude(c, other);
        candidate.cause.name() == Some(effect) && candidate.joint == joint && !others.iter().any(is_twin)
    };
    let with = |c: usize| {
        let mut set = others.clone();
        set.insert(instead.unwrap_or(set.len()), c);
        let next = problem.choose(set, &chosen.fit.weights);
        (!problem.is_possible(c, &next.fit), next)
    };
    let forms = (0..problem.candidates.len()).filter(is_form).map(with);
    // What physics allows goes first, if any of the forms is.
    let best = forms.min_by(|a, b| a.0.cmp(&b.0).then(a.1.score.total_cmp(&b.1.score)));
    best.map(|(_, next)| next)
}

/// `chosen` with each effect in the form that is best beside the others' forms.
fn swept(problem: &Problem<'_>, mut chosen: Chosen, placed: &[(&Wanted, Option<usize>)]) -> Chosen {
    for _ in 0..SWEEPS {
        let before = chosen.set.clone();
        for (at, &(one, joint)) in placed.iter().enumerate() {
            if let Some(next) = best(problem, &chosen, Some(at), &one.effect, joint) {
                chosen = next;
            }
        }
        if chosen.set == before {
            break;
        }
    }
    chosen
}
