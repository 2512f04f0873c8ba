//! The rules of the score: right names, accompanying effects, baseline effects, effects that are not testable.

use std::collections::BTreeSet;

use crate::answer::{Answer, DeclaredUnseen};
use crate::catalogue::{ALL_INERTIALS, INERTIALS, LINK_INERTIAL, brings, is_dry_friction, neutral};
use crate::numbers::truth_value;
use crate::truth::{Injected, Truth};

/// An effect's name and its joint; `None` is the whole arm.
pub type Name = (String, Option<String>);

/// The expressed share below which an effect is not required.
pub const LEAST_SHARE: f64 = 0.015;

/// A common factor of all inertials within so many standard deviations of a URDF's error is a part of that error.
const WITHIN_THE_URDF: f64 = 3.0;

/// Whether it is a baseline effect of the machine, which is scored separately.
pub fn is_baseline(truth: &Truth, effect: &str) -> bool {
    truth.baseline().contains(&effect)
}

/// The equivalent name of the machine with `concealed`: no recording distinguishes the two. Dry friction that depends on the
/// direction is a level and a constant, ½ (F₊ + F₋) sgn q̇ + ½ (F₊ − F₋), in motion and, as its two limits, at rest.
pub fn same_machine(truth: &Truth, concealed: &Injected) -> Option<Name> {
    let other = match concealed.name() {
        "torque_offset" => "friction_asymmetry",
        "friction_asymmetry" => "torque_offset",
        _ => return None,
    };
    let number = |of: &Injected, key: &str| of.parameters.get(key).and_then(serde_json::Value::as_f64);
    // Friction of another kind beside it tells. That the constant sets in later does not, if the level is there by then.
    let beside: Vec<&Injected> = truth
        .of_note()
        .filter(|c| c.joint == concealed.joint && is_dry_friction(c.name()) && c.name() != concealed.name())
        .collect();
    let is_plain = concealed.form.is_none();
    let same = match (concealed.name(), beside.as_slice()) {
        ("friction_asymmetry", []) => is_plain,
        // // A constant larger than the level would move the joint by itself.
        ("torque_offset", [friction]) => {
            let (offset, level) = (number(concealed, "offset")?, number(friction, "level")?);
            let start = |of: &Injected| of.onset.unwrap_or(f64::NEG_INFINITY);
            is_plain
                && friction.name() == "coulomb_friction"
                && friction.form.is_none()
                && offset.abs() < level
                && start(friction) <= start(concealed)
        }
        _ => false,
    };
    same.then(|| (other.to_owned(), concealed.joint.clone()))
}

/// What is true in a case.
#[derive(Clone, Debug, Default)]
pub struct Key {
    /// Injected, and in the catalogue.
    pub known: BTreeSet<Name>,
    /// Injected, and outside the catalogue.
    pub unknown: BTreeSet<Name>,
    /// Accompanying an injected fault, or one of the small effects of real joints.
    pub brought: BTreeSet<Name>,
}

impl Key {
    /// The key to a case.
    pub fn new(truth: &Truth) -> Self {
        let (mut known, mut unknown) = (BTreeSet::new(), BTreeSet::new());
        for concealed in truth.of_note() {
            let set = if concealed.is_outside_the_catalogue() {
                &mut unknown
            } else {
                &mut known
            };
            set.insert((concealed.name().to_owned(), concealed.joint.clone()));
        }
        let small: BTreeSet<Name> = truth
            .concealed
            .iter()
            .filter(|concealed| concealed.minor)
            .flat_map(|concealed| {
                // The same torque in motion.
                let also = (concealed.name() == "torque_offset").then_some("friction_asymmetry");
                let names = also.into_iter().chain([concealed.name()]);
                names.map(|name| (name.to_owned(), concealed.joint.clone()))
            })
            .collect();
        let mut brought: BTreeSet<Name> = known
            .iter()
            .chain(&small)
            .flat_map(|(effect, joint)| brings(effect).iter().map(|with| ((*with).to_owned(), joint.clone())))
            .collect();
        brought.extend(small);
        let brought = brought.difference(&known).cloned().collect();
        Self {
            known,
            unknown,
            brought,
        }
    }

    /// Whether a finding is right or accompanies a right one; otherwise it is false.
    pub fn allows(&self, name: &Name) -> bool {
        self.known.contains(name) || self.brought.contains(name)
    }
}

/// The names that a diagnosis gives.
pub fn found(answer: &Answer) -> BTreeSet<Name> {
    answer
        .findings
        .iter()
        .map(|f| (f.effect.clone(), f.joint.clone()))
        .collect()
}

/// The names and the alternatives that a diagnosis gives.
pub fn found_or_confusable(answer: &Answer) -> BTreeSet<Name> {
    let rivals = answer.findings.iter().flat_map(|f| &f.confusable_with);
    let mut set = found(answer);
    set.extend(rivals.map(|rival| (rival.effect.clone(), rival.joint.clone())));
    set
}

/// The findings of `answer` as they are counted: `inertial_parameters` stands for each wrong link of its joint (of any, on the whole arm)
/// that is not named beside it. Where the URDF is wrong everywhere such a link is moved in other ways, too, and inertials that differ are
/// as baseline as friction; where it is exact, the name is right for a link that was moved in other ways, and false otherwise. On the
/// whole arm it stands for a common factor of all inertials, too, that is no larger than what the URDF is wrong by.
pub fn counted_findings(truth: &Truth, answer: &Answer) -> Answer {
    counted(truth, answer, true)
}

/// The findings as [`counted_findings`] gives them, but for the common factor, which is asked for by its own name.
pub fn plainly_counted_findings(truth: &Truth, answer: &Answer) -> Answer {
    counted(truth, answer, false)
}

fn counted(truth: &Truth, answer: &Answer, factor_too: bool) -> Answer {
    let mut counted = answer.clone();
    let names = found(answer);
    let (general, mut findings): (Vec<_>, Vec<_>) = counted
        .findings
        .into_iter()
        .partition(|finding| finding.effect == INERTIALS);
    let wrong_everywhere = truth.has_a_wrong_urdf();
    let mut taken: BTreeSet<Name> = BTreeSet::new();
    for finding in general {
        let is_meant = |concealed: &&Injected| match concealed.name() {
            LINK_INERTIAL => {
                (wrong_everywhere || concealed.form.is_some())
                    && (finding.joint.is_none() || finding.joint == concealed.joint)
            }
            ALL_INERTIALS => factor_too && finding.joint.is_none() && is_of_the_urdf(truth, concealed),
            _ => false,
        };
        let mut stands = false;
        for concealed in truth.of_note().filter(is_meant) {
            stands = true;
            let name = (concealed.name().to_owned(), concealed.joint.clone());
            if !names.contains(&name) && taken.insert(name.clone()) {
                let mut finding = finding.clone();
                (finding.effect, finding.joint) = name;
                // Its numbers are others.
                finding.parameters.clear();
                findings.push(finding);
            }
        }
        if !stands && !wrong_everywhere {
            findings.push(finding);
        }
    }
    counted.findings = findings;
    counted
}

/// Whether a common factor of all inertials is within what each of them is wrong by in the URDF, so that nothing tells it from that.
fn is_of_the_urdf(truth: &Truth, scale: &Injected) -> bool {
    let factor = truth_value(scale, "factor").unwrap_or(1.0);
    truth
        .urdf_sigma
        .is_some_and(|sigma| factor.ln().abs() <= WITHIN_THE_URDF * sigma)
}

/// Whether a diagnosis declares an effect of this size not testable with these recordings.
pub fn is_declared_unseen(answer: &Answer, concealed: &Injected) -> bool {
    answer
        .not_observable
        .iter()
        .filter(|unseen| unseen.effect == concealed.name() && unseen.joint == concealed.joint)
        .any(|unseen| hides(unseen, concealed))
}

fn hides(unseen: &DeclaredUnseen, concealed: &Injected) -> bool {
    let (above, below) = (&unseen.would_be_seen_above, &unseen.would_be_seen_below);
    if above.is_empty() && below.is_empty() {
        return true;
    }
    let size = |key: &String| truth_value(concealed, key).map(|value| (value - neutral(concealed.name())).abs());
    let under = |(key, bound): (&String, &Option<f64>)| match (size(key), bound) {
        (Some(size), Some(bound)) => size < *bound,
        _ => false,
    };
    let over = |(key, bound): (&String, &Option<f64>)| match (size(key), bound) {
        (Some(size), Some(bound)) => size > *bound,
        _ => false,
    };
    above.iter().any(under) || below.iter().any(over)
}
