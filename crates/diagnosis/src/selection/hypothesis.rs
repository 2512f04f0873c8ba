//! A hypothesis of the user (`--only`): the requested effects are fitted together, without search and selection.

use effects::arm::INERTIAL_PARAMETERS;
use effects::drive::FARTHEST_COUPLED;
use effects::{Acts, CATALOGUE, Scope};
use recording::nearest;

use crate::error::DiagnosisError;
use crate::options::Wanted;
use crate::search::problem::{Problem, Selection};
use crate::search::refine::resize;
use crate::search::study::Study;
use crate::selection::judge::{self, Judged};

/// The largest number of sweeps over the forms of all effects.
const SWEEPS: usize = 4;
/// The number of linearisations about the arm with the effects.
const ROUNDS: usize = 2;

/// The error that the request `one` is refused.
fn refused(one: &Wanted, reason: impl Into<String>) -> DiagnosisError {
    DiagnosisError::Wanted { effect: one.effect.clone(), joint: one.joint.clone(), reason: reason.into() }
}

/// A request, with indices of the study.
#[derive(Clone, Copy)]
struct Request<'a> {
    wanted: &'a Wanted,
    joint: Option<usize>,
    other: Option<usize>,
}

/// Fits the `wanted` effects, each in the form and at the size that explain the training recordings best.
///
/// # Errors
/// [`DiagnosisError::Wanted`], if an effect is given twice, is not in the catalogue, or not possible on such a joint.
pub fn fit(study: &mut Study, wanted: &[Wanted]) -> Result<Judged, DiagnosisError> {
    let is_body = |request: &Request<'_>| request.wanted.effect == INERTIAL_PARAMETERS.name;
    let (bodies, mut waiting): (Vec<Request<'_>>, Vec<Request<'_>>) =
        check(study, wanted)?.into_iter().partition(is_body);
    let mut fitted: Vec<Request<'_>> = Vec::new();
    let mut selected = {
        let products = study.training_products();
        study.problem(&products).choose(Vec::new(), &products.first_weights())
    };
    // The time of an onset or a contact and the period of a ripple follow from the residual of the other effects.
    for suggest in [false, true] {
        if suggest {
            study.suggest(&selected);
        }
        let products = study.training_products();
        let problem = study.problem(&products);
        waiting.retain(|&request| {
            if !suggest && request.wanted.sets_in == Some(true) {
                return true;
            }
            match best(&problem, &selected, None, request) {
                Some(next) => {
                    selected = next;
                    fitted.push(request);
                    false
                }
                None => true,
            }
        });
        selected = swept(&problem, selected, &fitted);
    }
    for Request { wanted: one, .. } in waiting {
        let place = one.joint.as_deref().unwrap_or("the whole arm");
        let remark = format!("{} on {place}: not testable with these recordings; it is not fitted", one.effect);
        study.data.motions.remarks.push(remark);
    }
    // Other bodies of links are a background of the fit, under a prior.
    let links: Vec<Option<usize>> = bodies.iter().map(|request| request.joint).collect();
    if !links.is_empty() {
        if let Some(next) = study.with_requested_bodies(&links, &selected) {
            selected = next;
        } else {
            let remark = if study.stated.links.is_some() {
                "inertial_parameters: --urdf-accuracy states how much the bodies may differ; no others are fitted"
            } else {
                "inertial_parameters: the recordings are as likely with the URDF's bodies; no others are fitted"
            };
            study.data.motions.remarks.push(remark.to_owned());
        }
    }
    for round in 0..ROUNDS {
        selected = resize(study, selected, round > 0);
        let formed_anew = study.relinearise(&selected.fit, &selected.set);
        let is_done = formed_anew.is_none();
        let set = formed_anew.unwrap_or_else(|| selected.set.clone());
        selected = study.chosen(set, &selected.fit.weights);
        if is_done {
            break;
        }
    }
    let products = study.training_products();
    let members = judge::describe(&study.problem(&products), &selected);
    Ok(Judged { named: selected, members, unmodelled: Vec::new() })
}

/// The indices of the joints.
fn check<'a>(study: &Study, wanted: &'a [Wanted]) -> Result<Vec<Request<'a>>, DiagnosisError> {
    let mut requests = Vec::new();
    for (k, one) in wanted.iter().enumerate() {
        let number = |name: &String| study.data.arm.joints().iter().position(|joint| joint.name == *name);
        let joint_of = |name: &Option<String>| match name {
            Some(name) => number(name).map(Some).ok_or_else(|| refused(one, no_joint(name, study))),
            None => Ok(None),
        };
        let (mut joint, mut other) = (joint_of(&one.joint)?, joint_of(&one.other)?);
        // The catalogue has the effect of a shared drive on the later of its two joints.
        if other > joint && joint.is_some() {
            (joint, other) = (other, joint);
        }
        if let (Some(joint), Some(other)) = (joint, other)
            && !(1..=FARTHEST_COUPLED).contains(&(joint - other))
        {
            return Err(refused(one, "acts on joints that are neighbours or have one joint between them"));
        }
        let Some(spec) = effects::spec(&one.effect) else {
            return Err(refused(one, no_effect(&one.effect)));
        };
        match (joint, spec.scope) {
            (Some(_), Scope::Arm) => return Err(refused(one, "acts on the whole arm; leave the joint out")),
            (None, Scope::Joint) => {
                return Err(refused(one, format!("acts on a joint; give {}:JOINT", one.effect)));
            }
            _ => {}
        }
        if !spec.may_repeat && wanted[..k].contains(one) {
            return Err(refused(one, "is given twice; give it once"));
        }
        let wanted = one;
        requests.push(Request { wanted, joint, other });
    }
    Ok(requests)
}

/// The reason why an effect is refused that is not in the catalogue, with the name that is probably meant (a title is also
/// understood), or with all names.
fn no_effect(name: &str) -> String {
    let names: Vec<String> = CATALOGUE.iter().map(|spec| spec.name.to_owned()).collect();
    let titled = CATALOGUE.iter().find(|spec| spec.title.eq_ignore_ascii_case(name));
    let part = name.to_lowercase();
    let mut with_it = names.iter().filter(|known| known.contains(&part));
    // A part of one name only.
    let only_one = with_it.next().filter(|_| !part.is_empty() && with_it.next().is_none());
    let meant = titled.map(|spec| spec.name).or(only_one.map(String::as_str)).or_else(|| nearest(name, &names));
    match meant {
        Some(meant) => format!("no such effect is in the catalogue; did you mean {meant}?"),
        None => format!("no such effect is in the catalogue, which has {}", names.join(", ")),
    }
}

/// The reason why a joint is refused that the robot does not have.
fn no_joint(name: &str, study: &Study) -> String {
    let names: Vec<String> = study.data.arm.joints().iter().map(|joint| joint.name.clone()).collect();
    let meant = nearest(name, &names).map_or_else(String::new, |meant| format!("did you mean \"{meant}\"? "));
    format!("the robot has no joint \"{name}\"; {meant}its joints are {}", names.join(", "))
}

/// `selected` with the best form of an effect in the place of the member at `instead`, or added.
fn best(
    problem: &Problem<'_>,
    selected: &Selection,
    instead: Option<usize>,
    Request { wanted, joint, other }: Request<'_>,
) -> Option<Selection> {
    let mut others = selected.set.clone();
    if let Some(at) = instead {
        others.remove(at);
    }
    let is_form = |&c: &usize| {
        let candidate = &problem.candidates[c];
        // An effect that is requested twice is present twice, not once in two sizes.
        let is_twin =
            |&other: &usize| problem.candidates[other].hypothesis == candidate.hypothesis && problem.exclude(c, other);
        let with = candidate.hypothesis.other;
        let is_pair = with.is_none() || other.is_none() || other == with;
        candidate.hypothesis.name() == Some(wanted.effect.as_str())
            && candidate.joint == joint
            && is_pair
            && !others.iter().any(is_twin)
    };
    // An effect without a form with onset is taken as always acting.
    let is_as_wanted = |&c: &usize| {
        let sets_in = problem.acts(&problem.candidates[c]) != Acts::Always;
        wanted.sets_in.is_none_or(|wanted| wanted == sets_in)
    };
    let mut forms: Vec<usize> = (0..problem.candidates.len()).filter(is_form).collect();
    if forms.iter().any(is_as_wanted) {
        forms.retain(is_as_wanted);
    }
    let with = |c: usize| {
        let mut set = others.clone();
        set.insert(instead.unwrap_or(set.len()), c);
        let next = problem.choose(set, &selected.fit.weights);
        (!problem.is_possible(c, &next.fit), next)
    };
    // Physically possible forms are preferred, if there are any.
    let best = forms.into_iter().map(with).min_by(|a, b| a.0.cmp(&b.0).then(a.1.score.total_cmp(&b.1.score)));
    best.map(|(_, next)| next)
}

/// `selected` with each effect in the form that is best with the others' forms.
fn swept(problem: &Problem<'_>, mut selected: Selection, fitted: &[Request<'_>]) -> Selection {
    for _ in 0..SWEEPS {
        let before = selected.set.clone();
        for (at, &request) in fitted.iter().enumerate() {
            if let Some(next) = best(problem, &selected, Some(at), request) {
                selected = next;
            }
        }
        if selected.set == before {
            break;
        }
    }
    selected
}
