//! Payloads and the last link: two names for the same ten columns.
//!
//! Any change of the last link's inertial parameters may be a body on the tool. The search takes the first three of these steps, the final fit
//! the others, in this order:
//!
//! 1. [`Study::with_payload_for_last_link`]: a payload in the place of a last link that differs more than the others.
//! 2. [`Study::without_payload_of_a_link`]: no payload that the last joints do not feel, if a heavier link explains as much.
//! 3. [`compact::with_drives`]: a small body, where drives have the moments of a large one.
//! 4. [`is_doubtful`]: a payload that is small beside the last link, or beside some wrong links, needs more evidence than another name.
//! 5. [`is_of_no_mass`]: a body of a few grams is the last link.
//! 6. [`without_moment::without_moment`]: a mass where the axes of the wrist meet may belong to a link before it.
//! 7. [`possible::make_moments_possible`]: a payload that remains has moments of inertia that a body can have.
//! 8. [`unmounted::unmounted`]: a change of the last link that is a body which is missing.
//! 9. [`beside_few_links`]: the probability of a payload on an arm of few joints.
//! 10. [`as_last_link`]: the last link is an alternative of a payload that is named beside wrong links.

use effects::arm::INERTIAL_PARAMETERS;

use crate::search::candidate::Hypothesis;
use crate::search::problem::Selection;
use crate::search::study::Study;
use crate::selection::bootstrap::Resampled;
use crate::selection::naming::{Named, name};
use crate::selection::rivals::Rival;
use crate::thresholds::{BESIDE_FEW_LINKS, FEW_JOINTS, LEAST_MOUNTED, LEAST_OF_THE_LINK, LEAST_PAYLOAD};

pub mod compact;
pub mod possible;
pub mod unmounted;
pub mod without_moment;

/// Whether `payload` may be a part of links that are wrong: of some of them, or of the last one, beside which it is small.
pub fn is_doubtful(study: &Study, selected: &Selection, payload: usize) -> bool {
    let may_differ = study.stated.links != Some(0.0);
    may_differ && is_small(study, selected, payload) || study.strengths.are_of_some_links()
}

/// Whether a payload, or a body that is missing, is small beside the last link, which may then differ from the URDF by as much: a centre of mass that lies some
/// millimetres elsewhere has the same torque.
fn is_small(study: &Study, selected: &Selection, payload: usize) -> bool {
    let candidate = &study.candidates[payload];
    let relative = selected.fit.coefficient(candidate.columns[0]) / study.mass_of_last_link();
    study.always_acts(payload) && relative < LEAST_MOUNTED && relative > -LEAST_OF_THE_LINK
}

/// Whether `payload` is a body of a few grams that was always there: no other than the last link with a mass of its usual accuracy.
pub fn is_of_no_mass(study: &Study, resampled: &Resampled, payload: usize) -> bool {
    let least = LEAST_PAYLOAD * study.mass_of_last_link();
    let is_tiny = |named: &Named| named.effect.number("mass").abs() < least;
    study.always_acts(payload) && name(study, resampled, payload).first().is_some_and(is_tiny)
}

/// The payload of `selected` that was always there, on an arm of few joints, and how much more it explains than the URDF's links could in
/// its place (nats). A body has nearly as many parameters as the links of such an arm together, so that it explains most of what
/// wrong links do.
pub fn beside_few_links(study: &mut Study, selected: &Selection) -> Option<(usize, f64)> {
    let are_few = study.data.arm.dof() <= FEW_JOINTS && study.stated.links != Some(0.0);
    let is_constant = |&c: &usize| study.is_payload(c) && study.always_acts(c);
    let payload = selected.set.iter().copied().filter(|_| are_few).find(is_constant)?;
    let evidence = study.evidence_beside_best_background(selected, &[payload]);
    Some((payload, evidence - BESIDE_FEW_LINKS))
}

/// The last link as an alternative of a payload that was always there, if a link is wrong in any case: the inertial parameters of
/// both have the same torque. Without wrong links, a body at the tool is the likelier of the two.
pub fn as_last_link(study: &Study, candidate: usize) -> Option<Rival> {
    let links = Hypothesis::of(&INERTIAL_PARAMETERS);
    let is_alike = study.is_payload(candidate) && study.always_acts(candidate) && study.strengths.strongest() > 0.0;
    is_alike.then(|| (links, study.data.arm.dof().checked_sub(1)))
}
