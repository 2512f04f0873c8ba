//! The final fit: the named effects are linearised about the arm that contains them, and effects that fail the last tests are removed.

use effects::sensor::{TORQUE_OFFSET, TORQUE_SCALE};

use crate::regression::strengths::PriorStrengths;
use crate::report::JointFit;
use crate::search::problem::{IMPOSSIBLE, Problem, Selection};
use crate::search::study::Study;
use crate::selection::bootstrap::{Resampled, resample};
use crate::selection::breakaway;
use crate::selection::constant_torques;
use crate::selection::gain::useless;
use crate::selection::judge::{self, Judged};
use crate::selection::payload::{self, possible::make_moments_possible, without_moment::without_moment};
use crate::selection::predict::errors_with;
use crate::selection::resembling_links::{in_place_of_links, links_are_wrong, opposed};
use crate::selection::restored::{add_constants, restore, take_back};
use crate::selection::rivals::compared;
use crate::selection::torque_constants;
use crate::selection::unclear::{Unclear, unclear};

use crate::thresholds::{
    HOPELESS, LEAST_BESIDE_SOME_LINKS, LEAST_FINAL_SHARE, LEAST_UNDECIDED, MOST_FOR_A_CHANGE, MOST_SETTLING, PARTLY,
    UNDECIDED_NATS,
};

/// Fits the named effects about the arm that contains them, including the rows near reversals. Removes effects that increase the
/// held-out error of a joint, effects that do not reduce it, effects with little evidence whose size may be zero, and effects that the
/// background explains nearly as well.
pub fn confirmed(study: &mut Study, judged: &mut Judged) -> Resampled {
    let mut constants_tried = Vec::new();
    let (mut harmful_friction, mut restored): (Vec<usize>, Vec<usize>) = Default::default();
    let (mut had_constant, mut others_before): (Vec<usize>, usize) = Default::default();
    loop {
        relinearise(study, judged, false);
        if study.remember(&judged.named.fit) {
            relinearise(study, judged, false);
        }
        restore(study, judged, std::mem::take(&mut harmful_friction));
        had_constant.extend(judged.named.set.iter().filter_map(|&c| constant_torques::names(study, c)));
        let is_other = |&&c: &&usize| !study.candidates[c].hypothesis.spec().is_baseline;
        let others = judged.named.set.iter().filter(is_other).count();
        if others < others_before {
            add_constants(study, judged, &had_constant);
        }
        others_before = others;
        torque_constants::name_those_beyond_tolerance(study, judged, &mut constants_tried);
        make_possible(study, judged);
        breakaway::at_reversals(study, judged);
        let before = judged.named.set.len();
        let named = judged.named.set.clone();

        guard(study, judged);
        let is_friction = |&c: &usize| study.candidates[c].hypothesis.is_plain_friction() && study.always_acts(c);
        let dropped = named.into_iter().filter(|c| !judged.named.set.contains(c));
        // Each is restored once.
        harmful_friction.extend(dropped.filter(is_friction).filter(|c| !restored.contains(c)));
        restored.extend(&harmful_friction);
        prove(study, judged);

        give_up(study, judged);
        // The remaining effects are linearised about another arm, and may harm without the removed ones.
        if judged.named.set.len() < before {
            continue;
        }
        if let Some((undecided, rule, is_inertial)) = undecided(study, judged) {
            if is_inertial {
                study.give_up(undecided);
            }
            drop_and_take_back(study, judged, undecided, rule);
            continue;
        }
        let resampled = resample(study, &judged.named);
        match unclear(study, judged, &resampled) {
            Some((unclear, why)) => {
                if why == Unclear::Contradicted {
                    study.refuse(unclear);
                }
                if why == Unclear::Residual && study.candidates[unclear].hypothesis.is(&TORQUE_OFFSET) {
                    // A residual with a mean is predicted better with a constant, whatever causes it.
                    let joint = study.candidates[unclear].joint.filter(|_| study.always_acts(unclear));
                    study.strengths.nameless_offsets.extend(joint);
                }
                drop_name(study, judged, unclear, why.rule());
            }
            None => match without_moment(study, judged, &resampled) {
                Some(payload) => {
                    study.give_up(payload);
                    drop_name(study, judged, payload, "it may have no moment about the tool's origin");
                }
                None if make_moments_possible(study, judged) => {}
                None => match in_place_of_links(study, judged) {
                    Some(effect) => {
                        study.give_up(effect);
                        let rule =
                            "the background explains nearly as much in its place and that of others that resemble it";
                        drop_and_take_back(study, judged, effect, rule);
                    }
                    None => return resampled,
                },
            },
        }
    }
}

/// Fits the named effects about the arm that contains them, and removes none.
pub fn as_given(study: &mut Study, judged: &mut Judged) -> Resampled {
    relinearise(study, judged, true);
    if make_moments_possible(study, judged) {
        relinearise(study, judged, true);
    }
    resample(study, &judged.named)
}

/// Removes one name, or replaces it by the simpler effect that it generalises, and fits the others again.
fn drop_name(study: &mut Study, judged: &mut Judged, candidate: usize, rule: &'static str) {
    torque_constants::keep_named_ones(study, &judged.named.others(candidate));
    let products = study.training_products();
    let problem = study.problem(&products);
    let next = problem.without(&judged.named, candidate);
    study.note(rule, &judged.named, &next);
    judged.named = next;
    judged.members = judge::describe(&problem, &judged.named);
}

/// Removes one name, and takes back the effect that the search had exchanged for it.
fn drop_and_take_back(study: &mut Study, judged: &mut Judged, candidate: usize, rule: &'static str) {
    let claim = study.claim(candidate);
    drop_name(study, judged, candidate, rule);
    take_back(study, judged, claim);
}

fn refit(study: &Study, problem: &Problem<'_>, judged: &mut Judged, set: Vec<usize>) {
    let next = problem.choose(set, &judged.named.fit.weights);
    study.note("its joint is still predicted worse than by a constant", &judged.named, &next);
    judged.named = next;
    judged.members = judge::describe(problem, &judged.named);
}

/// Evaluates all columns about the arm that contains exactly the named effects, including the rows near reversals, and fits again. What
/// a changed torque constant multiplies must settle; names that it had brought along are removed.
fn relinearise(study: &mut Study, judged: &mut Judged, as_given: bool) {
    relinearise_once(study, judged, as_given);
    for _ in 0..MOST_SETTLING {
        if study.has_settled(&judged.named.fit, &judged.candidates()) {
            return;
        }
        relinearise_once(study, judged, as_given);
        if !as_given {
            let products = study.training_products();
            let pruned = study.pruned(&products, judged.named.clone());
            judged.named = named_alone(study, pruned);
            let products = study.training_products();
            judged.members = judge::describe(&study.problem(&products), &judged.named);
        }
    }
}

/// `selected` beside a background of the constants that it does not name, fitted again if it names others than before.
fn named_alone(study: &mut Study, selected: Selection) -> Selection {
    let before = study.strengths.clone();
    torque_constants::keep_named_ones(study, &selected.set);
    if study.strengths == before {
        return selected;
    }
    study.chosen(selected.set, &selected.fit.weights)
}

fn relinearise_once(study: &mut Study, judged: &mut Judged, as_given: bool) {
    let kept = study.linearise_for_final_fit(&judged.named.fit, &judged.candidates());
    let named = judged.named.set.len();
    torque_constants::keep_named_ones(study, &kept[..named]);
    let refitted = study.chosen(kept[..named].to_vec(), &judged.named.fit.weights);
    judged.named = if as_given {
        refitted
    } else {
        study.preferred = None;
        let best = study.with_best_strengths(refitted);
        let best = constant_torques::leave_to_background(study, best);
        study.about_own_bodies(best)
    };
    let products = study.training_products();
    judged.members = judge::describe(&study.problem(&products), &judged.named);
    for (member, &number) in judged.unmodelled.iter_mut().zip(&kept[named..]) {
        member.candidate = number;
    }
}

/// Removes effects that are physically impossible in this fit, one by one.
fn make_possible(study: &mut Study, judged: &mut Judged) {
    let impossible = |study: &Study, named: &Selection| {
        let products = study.training_products();
        let problem = study.problem(&products);
        named.set.iter().copied().find(|&c| !problem.is_possible(c, &named.fit))
    };
    while let Some(candidate) = impossible(study, &judged.named) {
        drop_name(study, judged, candidate, IMPOSSIBLE);
    }
}

/// Removes effects that do not improve the prediction of held-out recordings, one by one.
fn prove(study: &mut Study, judged: &mut Judged) {
    let Some(held) = study.held_products() else { return };
    while let Some(useless) = useless(&study.problem(&study.training_products()), &held, judged) {
        drop_name(study, judged, useless, "does not improve the prediction of held-out recordings");
    }
}

/// Removes the effects on joints whose torque is predicted worse than by a constant: such a channel measures something else.
fn give_up(study: &mut Study, judged: &mut Judged) {
    let fits = fits_of(study, &judged.named);
    let is_hopeless = |joint: usize| fits[joint].error() > HOPELESS;
    // Friction that explains a part of the training recordings is present in any case.
    let stays = |&candidate: &usize| {
        let candidate = &study.candidates[candidate];
        let explains =
            |joint: usize| candidate.hypothesis.spec().is_friction && fits[joint].train_nrmse_augmented < PARTLY;
        !candidate.joint.is_some_and(|joint| is_hopeless(joint) && !explains(joint))
    };
    let set: Vec<usize> = judged.named.set.iter().copied().filter(stays).collect();
    if set.len() < judged.named.set.len() {
        torque_constants::keep_named_ones(study, &set);
        let products = study.training_products();
        refit(study, &study.problem(&products), judged, set);
    }
}

/// The weakest effect whose name is as likely wrong as right, with the rule that removes it, and whether wrong inertial parameters
/// are the reason: it is too small in the final fit; or another effect explains nearly as much in its place; or wrong inertial
/// parameters resemble it, and its evidence against the background that fits best without it is small.
fn undecided(study: &mut Study, judged: &Judged) -> Option<(usize, &'static str, bool)> {
    let products = study.training_products();
    let members = judged.weakest_first();
    let mut rule = |member: &judge::Member| {
        let hypothesis = study.candidates[member.candidate].hypothesis;
        if !hypothesis.spec().is_baseline
            && !hypothesis.spec().may_be_in_one_recording
            && member.share() < LEAST_FINAL_SHARE
        {
            return Some(("too small in the final fit", false));
        }
        // A payload or a factor on the inertial parameters improves the fit whenever the inertial parameters are wrong in any way.
        let is_small = !hypothesis.spec().is_friction && member.share() < LEAST_UNDECIDED;
        let margin = || compared(study, &study.problem(&products), &judged.named, member.candidate).margin_over_single;
        if (is_small || hypothesis.spec().is_wrong_mass || hypothesis.is(&TORQUE_SCALE)) && margin() < UNDECIDED_NATS {
            return Some(("another effect explains nearly as much in its place", false));
        }
        let evidence = |study: &mut Study| study.evidence_beside_best_background(&judged.named, &[member.candidate]);
        let is_doubtful =
            study.is_payload(member.candidate) && payload::is_doubtful(study, &judged.named, member.candidate);
        if is_doubtful && evidence(study) < LEAST_BESIDE_SOME_LINKS {
            return Some(("links that are wrong explain nearly as much in its place", true));
        }
        let least = hypothesis.spec().least_beside_inertials.filter(|_| links_are_wrong(study))?;
        // Links that are wrong are as wrong before a change.
        let least = if study.changes(member.candidate) { least.min(MOST_FOR_A_CHANGE) } else { least };
        let size = judged.named.fit.coefficient(study.candidates[member.candidate].columns[0]).abs();
        let is_too_far = hypothesis.spec().most_beside_inertials.is_some_and(|most| size > most);
        let is_weak = is_too_far || evidence(study) < least;
        is_weak.then_some(("wrong inertials explain nearly as much in its place", true))
    };
    let undecided = members.iter().find_map(|member| {
        let (rule, is_inertial) = rule(member)?;
        Some((member.candidate, rule, is_inertial))
    });
    undecided.or_else(|| opposed(study, judged, &members))
}

/// Reduces the background, and removes findings, as long as that reduces the held-out error of a joint that is larger than the nominal
/// model's. For errors at rest, which friction changes, only the background is reduced.
fn guard(study: &mut Study, judged: &mut Judged) {
    loop {
        let (moving, resting) = harmed(&fits_of(study, &judged.named));
        if moving.is_empty() && resting.is_empty() {
            break;
        }
        if let Some((strengths, next)) = better_outside(study, &judged.named, &moving, &resting) {
            let before = std::mem::replace(&mut study.strengths, strengths);
            study.preferred.get_or_insert(before);
            study.note_strengths(judge::HARMS, &judged.named, &next);
            judged.named = next;
        } else {
            let products = study.training_products();
            let problem = study.problem(&products);
            // If no removal helps, something else harms the joint.
            let Some(next) = moving.iter().find_map(|&joint| without_what_harms(study, &problem, judged, joint)) else {
                break;
            };
            study.note(judge::HARMS, &judged.named, &next);
            judged.named = named_alone(study, next);
        }
        let products = study.training_products();
        judged.members = judge::describe(&study.problem(&products), &judged.named);
    }
}

/// The named effects without the one that acts on `joint` and whose removal reduces the joint's held-out error most; `None` if none reduces it
/// by more than an effect of another joint may cause.
fn without_what_harms(study: &Study, problem: &Problem<'_>, judged: &Judged, joint: usize) -> Option<Selection> {
    let error = |selected: &Selection| fit_of(study, selected, joint).held_out_nrmse_augmented.unwrap_or(f64::INFINITY);
    let acts =
        |member: &&judge::Member| study.candidates[member.candidate].joint.is_some() && member.shares[joint] > 0.0;
    let without = judged.members.iter().filter(acts).map(|member| {
        let next = problem.choose(judged.named.others(member.candidate), &judged.named.fit.weights);
        (error(&next), next)
    });
    let (least, next) = without.min_by(|a, b| a.0.total_cmp(&b.0))?;
    judge::harms(least, error(&judged.named)).then_some(next)
}

/// The fit of `joint` with `selected`.
fn fit_of(study: &Study, selected: &Selection, joint: usize) -> JointFit {
    errors_with(&study.data, &study.table, &selected.fit, joint)
}

/// The fits of all joints with `selected`.
fn fits_of(study: &Study, selected: &Selection) -> Vec<JointFit> {
    (0..study.data.motions.dof).map(|joint| fit_of(study, selected, joint)).collect()
}

/// The joints whose held-out error in motion is larger with these fits than with the nominal model, and those whose error at rest is.
fn harmed(fits: &[JointFit]) -> (Vec<usize>, Vec<usize>) {
    let is_worse = |nominal: Option<f64>, augmented: Option<f64>| {
        nominal.zip(augmented).is_some_and(|(nominal, augmented)| judge::harms(nominal, augmented))
    };
    let (mut moving, mut resting) = (Vec::new(), Vec::new());
    for (joint, fit) in fits.iter().enumerate() {
        if is_worse(fit.held_out_nrmse_nominal, fit.held_out_nrmse_augmented) {
            moving.push(joint);
        }
        if is_worse(fit.held_out_nrmse_resting_nominal, fit.held_out_nrmse_resting) {
            resting.push(joint);
        }
    }
    (moving, resting)
}

/// The smaller background with the smallest held-out errors of all joints together, if they are smaller than now and it harms no other
/// joint in motion. Errors at rest are included, because wrong links that explain the motion of some joints change the weight on joints at
/// rest. A smaller background corrects less of one part on all joints, or no friction on the joints that are harmed in motion (`moving`) or
/// at rest (`resting`).
fn better_outside(
    study: &Study,
    selected: &Selection,
    moving: &[usize],
    resting: &[usize],
) -> Option<(PriorStrengths, Selection)> {
    let loss = |fits: &[JointFit]| {
        let of = |fit: &JointFit| {
            let error = fit.held_out_nrmse_augmented?.hypot(fit.held_out_nrmse_resting.unwrap_or(0.0));
            Some(error.max(f64::MIN_POSITIVE).ln())
        };
        fits.iter().filter_map(of).sum::<f64>()
    };
    let is_corrected = |joint: &usize| study.strengths.friction_of(Some(*joint)) > 0.0;
    let [in_motion, at_rest] =
        [moving, resting].map(|joints| joints.iter().copied().filter(is_corrected).collect::<Vec<_>>());
    let mut uncorrected: Vec<Vec<usize>> = Vec::new();
    let both = [&in_motion[..], &at_rest].concat();
    for joints in [in_motion, both.clone()].into_iter().chain(both.iter().map(|&joint| vec![joint])) {
        if !joints.is_empty() && !uncorrected.contains(&joints) {
            uncorrected.push(joints);
        }
    }
    let on_joints = uncorrected.iter().map(|joints| study.strengths.without_friction_of(joints));
    let trials = on_joints.chain(study.stated.weaker(&study.strengths)).filter_map(|strengths| {
        let products = study.products_at(&strengths);
        let next = study.problem(&products).choose(selected.set.clone(), &selected.fit.weights);
        let fits = fits_of(study, &next);
        let harms_another = harmed(&fits).0.iter().any(|joint| !moving.contains(joint));
        (!harms_another).then(|| (loss(&fits), strengths, next))
    });
    let (best, strengths, next) = trials.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (best < loss(&fits_of(study, selected))).then_some((strengths, next))
}
