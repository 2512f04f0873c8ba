//! Torque constants beyond their tolerance: the background corrects all of them a little, and one that deviates more is an effect with a name.

use effects::arm::INERTIAL_SCALE;
use effects::sensor::TORQUE_SCALE;

use crate::search::problem::{Problem, Selection};
use crate::search::study::Study;
use crate::selection::bootstrap::resample;
use crate::selection::constant_torques;
use crate::selection::judge::{self, Judged};
use crate::thresholds::{
    ALIKE_CONSTANTS, CONSTANT_TOLERANCE, LEAST_ALIKE, LEAST_TORQUE_ACCURACY, MOST_USUAL, SYSTEMATIC,
};

/// The relative standard deviation of the torque constants: the stated one, or the one that the recordings require beside the effects of
/// `set`.
pub fn accuracy(study: &Study, set: &[usize]) -> f64 {
    let strengths = &study.strengths;
    let all_are_exact = strengths.gain == 0.0 && strengths.links.iter().all(|&rho| rho == 0.0);
    // A common factor of all masses is one of all torque constants, too.
    let names_some = |&&c: &&usize| names(study, c).is_some() || study.candidates[c].hypothesis.is(&INERTIAL_SCALE);
    let is_one_named = set.iter().filter(names_some).count() <= 1;
    if study.stated.gain.is_none() && all_are_exact && is_one_named {
        // The inertials and all other torque constants are exact.
        return LEAST_TORQUE_ACCURACY;
    }
    study.stated.torque_accuracy()
}

/// The joint whose torque constant a candidate names, for all times.
fn names(study: &Study, candidate: usize) -> Option<usize> {
    let is_scale = study.candidates[candidate].hypothesis.is(&TORQUE_SCALE);
    let always = study.always_acts(candidate);
    study.candidates[candidate].joint.filter(|_| is_scale && always)
}

/// Removes the torque constants and the constant torques that `set` names from the background. Otherwise the named effect would explain
/// only the part that the background does not.
pub fn keep_named_ones(study: &mut Study, set: &[usize]) {
    study.strengths.named_offsets = set.iter().filter_map(|&c| constant_torques::names(study, c)).collect();
    study.strengths.named_constants = set.iter().filter_map(|&c| names(study, c)).collect();
}

/// Adds a torque scale on each joint, except those `tried`, whose torque constant deviates in the background by more than such
/// constants usually do, and clearly from one. They are added one by one, that with the largest deviation first, because the background
/// otherwise spreads this deviation over the other joints.
pub fn name_those_beyond_tolerance(study: &mut Study, judged: &mut Judged, tried: &mut Vec<usize>) {
    while let Some((joint, scale)) = farthest(study, judged, tried) {
        tried.push(joint);
        let set = [&judged.named.set[..], &[scale]].concat();
        keep_named_ones(study, &set);
        let products = study.training_products();
        let problem = study.problem(&products);
        let next = problem.choose(set, &judged.named.fit.weights);
        let is_explained_better = is_explained_better(&problem, &next, scale);
        // Wrong inertial parameters of all links resemble wrong torque constants of all drives.
        if !is_explained_better && is_clear(study, &next, scale) {
            study.note("its torque constant is beyond the usual tolerance", &judged.named, &next);
            judged.members = judge::describe(&study.problem(&products), &next);
            judged.named = next;
        } else {
            keep_named_ones(study, &judged.named.set);
        }
    }
}

/// A note on the torque constants that the background corrects by more than such constants usually deviate and that no finding names,
/// because other effects explain the same. Without it, the model would seem to explain these torques as it is.
pub fn note_on_unnamed(study: &Study, selected: &Selection) -> Option<String> {
    let least = MOST_USUAL * study.stated.torque_accuracy();
    let factor = |joint: usize| {
        let deviation = selected.fit.coefficient(study.torque_constant(joint)?);
        let name = &study.data.arm.joints()[joint].name;
        (deviation.abs() > least).then(|| format!("{name} × {:.2}", 1.0 + deviation))
    };
    let factors: Vec<String> = (0..study.data.motions.dof).filter_map(factor).collect();
    (!factors.is_empty()).then(|| {
        format!(
            "the errors contain corrections of the torques that no finding names: {}. Wrong torque constants, or wrong masses, \
             would explain them; these recordings do not distinguish the two. Record the arm with a known load on the tool to \
             distinguish them",
            factors.join(", ")
        )
    })
}

/// The members of `selected` that name torque constants, if they are alike and are those of half of the joints with a torque or more: the
/// constants of the other joints, wrong by the inverse factor, and masses smaller by it explain the same torques.
pub fn alike(study: &Study, selected: &Selection) -> Vec<usize> {
    let mut named = selected.set.clone();
    named.retain(|&c| names(study, c).is_some());
    let factor = |&c: &usize| 1.0 + selected.fit.coefficient(study.candidates[c].columns[0]);
    let factors: Vec<f64> = named.iter().map(factor).collect();
    let of_all = study.data.scales.torque.iter().filter(|&&torque| torque > 0.0).count();
    if are_of_others(&factors, of_all) { named } else { Vec::new() }
}

/// Whether these factors of the torque constants of some of `joints` joints may as well be the inverse ones of the others.
fn are_of_others(factors: &[f64], joints: usize) -> bool {
    let [least, most] = [f64::min, f64::max].map(|of| factors.iter().copied().reduce(of).unwrap_or(1.0));
    // A single one is the factor of its own joint.
    let is_half = factors.len() >= LEAST_ALIKE && 2 * factors.len() >= joints && factors.len() < joints;
    is_half && most <= ALIKE_CONSTANTS * least && (least > 1.0 || most < 1.0)
}

/// A note on torque constants of half of the joints that are alike.
pub fn note_on_alike(study: &Study, selected: &Selection) -> Option<String> {
    let alike = alike(study, selected);
    let joints = alike.iter().filter_map(|&c| names(study, c));
    let names: Vec<&str> = joints.map(|joint| &*study.data.arm.joints()[joint].name).collect();
    (!names.is_empty()).then(|| {
        format!(
            "the torque scales of {} agree. Those of the other joints, by the inverse factor, and other masses of all links would explain the \
             same torques: only the URDF's masses decide between the two. If the torques of some joints are in another unit, state it in a \
             column map; otherwise, record the arm with a known load on the tool",
            names.join(", ")
        )
    })
}

/// The joint whose torque constant deviates most beyond tolerance, with the candidate that names it; `None` also if most of the
/// constants deviate alike.
fn farthest(study: &Study, judged: &Judged, tried: &[usize]) -> Option<(usize, usize)> {
    // Without a background of torque constants, none deviates there.
    if study.strengths.gain == 0.0 {
        return None;
    }
    let least = CONSTANT_TOLERANCE * accuracy(study, &judged.named.set);
    let allowed = study.allowed();
    let deviation = |joint: usize| {
        if study.strengths.impossible_constants.contains(&joint) {
            return Some(f64::INFINITY);
        }
        let column = study.torque_constant(joint)?;
        Some(judged.named.fit.coefficient(column).abs()).filter(|deviation| *deviation >= least)
    };
    if are_alike(&deviations(study, &judged.named), least) {
        return None;
    }
    let scale = |joint: usize| allowed.iter().copied().find(|&c| names(study, c) == Some(joint));
    (0..study.data.motions.dof)
        .filter(|joint| !tried.contains(joint) && !study.strengths.named_constants.contains(joint))
        .filter_map(|joint| Some((deviation(joint)?, joint, scale(joint)?)))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, joint, scale)| (joint, scale))
}

/// The deviations from one of the torque constants of the joints that have one; that of a named one is zero here.
fn deviations(study: &Study, selected: &Selection) -> Vec<f64> {
    let deviation = |joint: usize| Some(selected.fit.coefficient(study.torque_constant(joint)?));
    (0..study.data.motions.dof).filter_map(deviation).collect()
}

/// Whether `candidate` of `selected` names a torque constant, and those of half of the joints deviate in the same direction, with it and in the
/// background: masses that are wrong by the inverse factor explain the same, as where one joint's torque is none and the masses follow it.
pub fn is_one_of_many(study: &Study, selected: &Selection, candidate: usize) -> bool {
    let Some(named) = names(study, candidate).filter(|_| study.strengths.gain > 0.0) else { return false };
    let own = selected.fit.coefficient(study.candidates[candidate].columns[0]);
    let joints = (0..study.data.motions.dof).filter(|&joint| joint == named || study.data.scales.torque[joint] > 0.0);
    is_of_many(own, &deviations(study, selected), joints.count(), MOST_USUAL * study.stated.torque_accuracy())
}

/// Whether those of half of the `joints` deviate by `least` or more in the direction of `own`, with it.
fn is_of_many(own: f64, others: &[f64], joints: usize, least: f64) -> bool {
    let alike = others.iter().filter(|&&deviation| own.signum() * deviation >= least).count();
    alike >= LEAST_ALIKE && 2 * (alike + 1) >= joints
}

/// Whether most of the torque constants deviate alike in the background, so that the sizes of masses depend on a common factor of all torques.
pub fn most_are_alike(study: &Study, selected: &Selection) -> bool {
    study.strengths.gain > 0.0 && are_alike(&deviations(study, selected), MOST_USUAL * study.stated.torque_accuracy())
}

/// Whether most of the torque constants deviate by `least` or more in the same direction: a common cause, and not an effect on each.
fn are_alike(deviations: &[f64], least: f64) -> bool {
    let count = |sign: f64| deviations.iter().filter(|&&deviation| sign * deviation >= least).count();
    let most = count(1.0).max(count(-1.0));
    most >= LEAST_ALIKE && 2 * most > deviations.len()
}

/// Whether an unmodelled form on the joint of the torque scale `scale`, such as a wrong scale of its position, explains more in its place.
fn is_explained_better(problem: &Problem<'_>, selected: &Selection, scale: usize) -> bool {
    let joint = problem.candidates[scale].joint;
    let is_form =
        |&c: &usize| problem.candidates[c].hypothesis.name().is_none() && problem.candidates[c].joint == joint;
    let others = selected.others(scale);
    let mut forms = (0..problem.candidates.len()).filter(is_form);
    forms.any(|form| problem.choose([&others[..], &[form]].concat(), &selected.fit.weights).score < selected.score)
}

/// Whether the interval of a torque scale of `selected` excludes one.
fn is_clear(study: &mut Study, selected: &Selection, scale: usize) -> bool {
    let column = study.candidates[scale].columns[0];
    let resampled = resample(study, selected);
    resampled.column(column).is_some_and(|at| {
        let (_, [low, high]) = resampled.interval_within(SYSTEMATIC, |draw| draw[at]);
        low > 0.0 || high < 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::{are_alike, are_of_others, is_of_many};

    /// A simulated arm of seven joints with an effect outside the catalogue on the sixth: five constants were off by the same factor.
    #[test]
    fn constants_that_deviate_alike_are_no_effects() {
        assert!(are_alike(&[0.22, 0.22, 0.23, 0.23, 0.23, 0.0, 0.01], 0.125));
        assert!(!are_alike(&[0.05, -0.16, -0.05], 0.125));
        assert!(!are_alike(&[0.2, -0.2, 0.2, -0.2], 0.125));
        assert!(!are_alike(&[0.3], 0.125));
    }

    /// A simulated UR10 whose first joint had a dead band in its torque: the second one's exact constant was named with 1.27.
    #[test]
    fn a_constant_beside_others_that_deviate_alike_is_no_effect() {
        assert!(is_of_many(0.27, &[0.0, 0.26, 0.17, 0.12, 0.02], 6, 0.1));
        assert!(!is_of_many(0.27, &[0.0, 0.26, 0.07, -0.12, 0.02], 6, 0.1));
        assert!(!is_of_many(-0.27, &[0.0, 0.26, 0.17, 0.12, 0.02], 6, 0.1), "in the other direction");
    }

    /// Torques of which those of the last three joints are in amperes: the first four seem to be 2.7 times as large as those of an arm
    /// with smaller masses.
    #[test]
    fn constants_of_half_of_the_joints_that_agree_may_be_those_of_the_others() {
        assert!(are_of_others(&[2.73, 2.72, 2.72, 2.73], 7));
        assert!(are_of_others(&[0.31, 0.33], 4));
        assert!(!are_of_others(&[0.31, 0.33], 7), "two of seven");
        assert!(!are_of_others(&[2.73, 2.1, 2.72, 2.73], 7), "different constants");
        assert!(!are_of_others(&[1.05, 0.97], 3), "on both sides of one");
        assert!(!are_of_others(&[2.7; 3], 3), "all joints: a factor of all masses");
    }
}
