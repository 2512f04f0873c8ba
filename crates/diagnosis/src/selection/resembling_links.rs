//! Effects that wrong inertial parameters resemble, judged beside links that may be wrong.

use crate::regression::strengths::PriorStrengths;
use crate::search::study::Study;
use crate::selection::judge::{self, Judged};
use crate::thresholds::LEAST_BESIDE_EXACT_LINKS;

/// The weakest one of the effects that wrong inertial parameters resemble, if the best background without them explains nearly as much, and
/// not all links differ from the URDF beside them. One to three such effects may take the place of many small errors of the links, each with a
/// size that seems certain. Only the group is tested: a strong effect in it also keeps a weak one. A payload alone is not tested, because the
/// last link always resembles it.
pub fn in_place_of_links(study: &mut Study, judged: &Judged) -> Option<usize> {
    let group = resembling_links(study, &judged.weakest_first());
    let weakest = *group.first()?;
    if links_are_wrong(study) || study.stated.links.is_some() || group.iter().all(|&c| study.is_payload(c)) {
        return None;
    }
    (study.evidence_beside_best_background(&judged.named, &group) < LEAST_BESIDE_EXACT_LINKS).then_some(weakest)
}

/// The effects that act in all recordings and that wrong inertial parameters resemble.
fn resembling_links(study: &Study, members: &[&judge::Member]) -> Vec<usize> {
    let of = members.iter().map(|member| member.candidate);
    of.filter(|&c| study.candidates[c].hypothesis.spec().may_be_inertial && study.always_acts(c)).collect()
}

/// Whether all links differ from the URDF. If most agree with it, one wrong link is an unlikely explanation. A URDF with placeholders is
/// wrong.
pub fn links_are_wrong(study: &Study) -> bool {
    let preferred = study.preferred.as_ref().map_or(0.0, PriorStrengths::common);
    study.strengths.common().max(preferred) > 0.0 || study.strengths.has_placeholders()
}

/// The weaker one of two effects that wrong inertial parameters resemble and that together have less evidence, against the background that
/// fits best without them, than the one that needs more. Where they oppose each other, each seems necessary beside the other.
pub fn opposed(study: &mut Study, judged: &Judged, members: &[&judge::Member]) -> Option<(usize, &'static str, bool)> {
    if !links_are_wrong(study) {
        return None;
    }
    let mut group = resembling_links(study, members);
    group.retain(|&c| study.candidates[c].joint.is_some());
    let mut pairs = group.iter().enumerate().flat_map(|(k, &a)| group[k + 1..].iter().map(move |&b| [a, b]));
    let least = |study: &Study, pair: &[usize; 2]| {
        let of = |&member: &usize| study.candidates[member].hypothesis.spec().least_beside_inertials;
        pair.iter().filter_map(of).reduce(f64::max)
    };
    let [weaker, _] = pairs.find(|pair| {
        least(study, pair).is_some_and(|least| study.evidence_beside_best_background(&judged.named, pair) < least)
    })?;
    Some((weaker, "wrong inertials explain nearly as much in the place of it and another effect", true))
}
